use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;

use anyhow::{Context as _, bail};
use dorsal::allocentric_qsr::{
    Closure, ConstraintNetwork, DepthReference, DepthSet, DistanceFact, Explanation, FactSource,
    GqrCalculus, ObjectId, ToldFact,
};
use serde::Serialize;

use crate::memory_arguments::Format;
use crate::network_arguments::{CheckArguments, ExportArguments, NetworkArguments, NetworkCommand};
use crate::outputs::ensure_folder;
use crate::reference_system::reference_system;

/// What `dorsal network check` says as data.
#[derive(Serialize)]
#[serde(tag = "closure", rename_all = "snake_case")]
enum CheckRecord {
    NotRefuted {
        narrowed: usize,
        distances: Vec<DistanceRecord>,
        #[serde(skip_serializing_if = "Option::is_none")]
        explanation: Option<Explanation>,
    },
    Inconsistent {
        proof: Explanation,
    },
}

/// What may hold of one distance of which something is known.
#[derive(Serialize)]
struct DistanceRecord {
    between: [ObjectId; 2],
    depth: Vec<String>,
}

/// `dorsal network`: facts closed by the calculus.
pub(crate) fn network(arguments: &NetworkArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    match &arguments.command {
        NetworkCommand::Check(check) => self::check(check, out),
        NetworkCommand::Export(export) => self::export(export, out),
    }
}

fn check(arguments: &CheckArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let reference = reference_system(&arguments.system)?;
    let facts = facts(&arguments.file, &reference)?;
    let mut network = ConstraintNetwork::new(&reference, objects(&facts));
    let name = arguments.file.display();
    let form = arguments.form.format;
    let narrowed = match network
        .constrain(facts)
        .with_context(|| format!("{name} is no network"))?
    {
        Closure::NotRefuted { narrowed } => narrowed,
        Closure::Inconsistent(proof) => {
            match form {
                Format::Text => write!(out, "{proof}")?,
                Format::Json => {
                    let record = CheckRecord::Inconsistent { proof };
                    writeln!(out, "{}", serde_json::to_string(&record)?)?;
                }
            }
            out.flush()?;
            bail!("{name} is inconsistent: no points of the plane have these distances");
        }
    };
    let explanation = match arguments.explain.as_deref() {
        Some([a, b]) => {
            let explained = network.explain(&a.as_str().into(), &b.as_str().into());
            let explained = explained.filter(|_| a != b);
            Some(explained.with_context(|| format!("{name} does not relate {a} and {b}"))?)
        }
        _ => None,
    };
    let distances = distances(&network);
    if form == Format::Json {
        let record = CheckRecord::NotRefuted {
            narrowed,
            distances,
            explanation,
        };
        writeln!(out, "{}", serde_json::to_string(&record)?)?;
        return Ok(());
    }
    if let Some(explanation) = explanation {
        write!(out, "{explanation}")?;
        return Ok(());
    }
    writeln!(
        out,
        "not refuted: {} facts about {} objects leave these distances",
        network.facts().len(),
        network.objects().len()
    )?;
    for DistanceRecord {
        between: [a, b],
        depth,
    } in distances
    {
        writeln!(out, "  {a} - {b}: {{{}}}", depth.join(", "))?;
    }
    Ok(())
}

fn export(arguments: &ExportArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    ensure_folder(&arguments.out)?;
    let reference = reference_system(&arguments.system)?;
    let facts = facts(&arguments.file, &reference)?;
    let GqrCalculus {
        spec,
        composition,
        converse,
    } = GqrCalculus::of(&reference);
    let name = reference.name();
    let files = [
        (format!("{name}.spec"), spec),
        (format!("{name}.comp"), composition),
        (format!("{name}.conv"), converse),
        (
            "network.csp".to_owned(),
            GqrCalculus::network(&reference, &facts),
        ),
    ];
    fs::create_dir_all(&arguments.out)
        .with_context(|| format!("the folder {} cannot be made", arguments.out.display()))?;
    for (name, text) in &files {
        let path = arguments.out.join(name);
        stereo_formats::replace(&path, text.as_bytes())
            .with_context(|| format!("{} cannot be written", path.display()))?;
    }
    let names = files.map(|(name, _)| name).join(", ");
    writeln!(out, "written   {names} in {}", arguments.out.display())?;
    Ok(())
}

/// Reads the facts of a file.
fn facts(path: &Path, reference: &DepthReference) -> anyhow::Result<Vec<DistanceFact>> {
    let text = fs::read_to_string(path)
        .with_context(|| format!("{} cannot be read as facts", path.display()))?;
    let mut facts = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let words = line.split('#').next().unwrap_or_default().trim();
        if words.is_empty() {
            continue;
        }
        let ToldFact { between, depth } = ToldFact::read(words, reference).with_context(|| {
            format!(
                "{}, line {}: \"{words}\" is no fact of {}; one reads `A within CLASSES of B`",
                path.display(),
                at + 1,
                reference.name()
            )
        })?;
        facts.push(DistanceFact {
            between,
            depth,
            source: FactSource::Told(format!("line {}: {words}", at + 1)),
        });
    }
    Ok(facts)
}

fn objects(facts: &[DistanceFact]) -> BTreeSet<ObjectId> {
    let ends = facts.iter().flat_map(|fact| fact.between.iter().cloned());
    ends.collect()
}

/// The distances of which something is known, by name.
fn distances(network: &ConstraintNetwork) -> Vec<DistanceRecord> {
    let reference = network.reference();
    let objects = network.objects();
    let mut known = Vec::new();
    for (at, a) in objects.iter().enumerate() {
        for b in &objects[at + 1..] {
            let depth: DepthSet = network.depth(a, b).unwrap_or(reference.all());
            if depth != reference.all() {
                let labels = reference.labels(depth).into_iter();
                known.push(DistanceRecord {
                    between: [a.clone(), b.clone()],
                    depth: labels.map(str::to_owned).collect(),
                });
            }
        }
    }
    known
}
