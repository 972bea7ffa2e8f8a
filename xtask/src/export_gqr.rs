use std::fs;
use std::path::PathBuf;

use allocentric_qsr::{
    BaseRelation as _, Closure, ConstraintNetwork, DepthReference, DepthSet, DistanceFact,
    FactSource, GqrCalculus, ObjectId,
};
use anyhow::Context as _;
use clap::Args;

use crate::lot::Lot;

/// Writes a distance calculus and random networks in the text form of the solver GQR.
///
/// The folder gets SYSTEM.spec, SYSTEM.comp and SYSTEM.conv, networks 000.csp, 001.csp, .., and
/// expected.txt with what our closure says of each: `refuted`, or `closed` and how many pairs it
/// narrowed.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask export-gqr --out out/gqr
  gqr c -C out/gqr/robot-120 out/gqr/*.csp
      GQR by its own command line: compare with out/gqr/expected.txt.

A network is told degree * objects / 2 facts about pairs drawn by lot, each of classes drawn by lot.")]
pub(crate) struct Options {
    /// Folder for the files; it is made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The reference system: drs1, drs2, robot-150 or robot-120
    #[arg(long, value_name = "SYSTEM", default_value = "robot-120")]
    system: String,
    /// How many networks
    #[arg(long, value_name = "N", default_value_t = 200)]
    networks: u64,
    /// How many objects each has
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(2..=2000))]
    objects: u64,
    /// How many facts speak of each object on average
    #[arg(long, value_name = "N", default_value_t = 3)]
    degree: u64,
    /// Which networks: other seeds give others
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let reference = DepthReference::preset(&options.system).with_context(|| {
        let presets = DepthReference::PRESETS.join(", ");
        format!("--system {} is none of {presets}", options.system)
    })?;
    fs::create_dir_all(&options.out)
        .with_context(|| format!("the folder {} cannot be made", options.out.display()))?;
    let write = |name: &str, text: &str| {
        let path = options.out.join(name);
        stereo_formats::replace(&path, text.as_bytes())
            .with_context(|| format!("{} cannot be written", path.display()))
    };
    let GqrCalculus {
        spec,
        composition,
        converse,
    } = GqrCalculus::of(&reference);
    let system = reference.name();
    write(&format!("{system}.spec"), &spec)?;
    write(&format!("{system}.comp"), &composition)?;
    write(&format!("{system}.conv"), &converse)?;
    let (mut expected, mut refuted) = (String::new(), 0);
    for network in 0..options.networks {
        let name = format!("{network:03}.csp");
        let mut lot = Lot::new(options.seed.wrapping_mul(1_000_003).wrapping_add(network));
        let facts = facts(&reference, options, &mut lot);
        write(&name, &GqrCalculus::network(&reference, &facts))?;
        let ends = facts.iter().flat_map(|fact| fact.between.iter().cloned());
        let mut closed = ConstraintNetwork::new(&reference, ends);
        expected += &match closed.constrain(facts)? {
            Closure::NotRefuted { narrowed } => format!("{name} closed {narrowed}\n"),
            Closure::Inconsistent(_) => {
                refuted += 1;
                format!("{name} refuted\n")
            }
        };
    }
    write("expected.txt", &expected)?;
    println!(
        "{system}: the calculus and {} networks of up to {} objects, of which our closure refutes \
         {refuted}, in {}",
        options.networks,
        options.objects,
        options.out.display()
    );
    Ok(())
}

fn facts(reference: &DepthReference, options: &Options, lot: &mut Lot) -> Vec<DistanceFact> {
    let name = |k: u64| ObjectId::new(format!("o{k:04}"));
    let classes = reference.classes().len();
    let mut facts = Vec::new();
    while (facts.len() as u64) < options.degree * options.objects / 2 {
        let [from, to] = [0, 1].map(|_| lot.below(options.objects));
        let drawn = lot.below((1 << classes) - 1) + 1;
        let depth: DepthSet = reference
            .all()
            .iter()
            .filter(|class| drawn >> class.index() & 1 == 1)
            .collect();
        if from != to {
            facts.push(DistanceFact {
                between: [name(from), name(to)],
                depth,
                source: FactSource::Told(String::new()),
            });
        }
    }
    facts
}
