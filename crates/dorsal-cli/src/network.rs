use std::fs;
use std::io::Write;

use anyhow::{Context as _, bail};
use dorsal::allocentric_qsr::{
    Closure, ConstraintNetwork, DepthReference, DirectionFact, Explanation, FactSource,
    GqrCalculus, NotAFact, ObjectId, OrientationSet, PlaceNetwork,
};
use serde::Serialize;

use crate::facts::Facts;
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
        directions: Vec<DirectionRecord>,
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

/// What may hold of one direction of which something is known.
#[derive(Serialize)]
struct DirectionRecord {
    observer: ObjectId,
    reference: ObjectId,
    object: ObjectId,
    orientation: OrientationSet,
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
    let facts = Facts::read(&arguments.file, &reference)?;
    let name = arguments.file.display();
    let form = arguments.form.format;
    let count = facts.distances.len() + facts.directions.len();
    let closed = Closed::of(&reference, facts).with_context(|| format!("{name} is no network"))?;
    let (network, narrowed) = match closed {
        Ok(closed) => closed,
        Err(proof) => {
            match form {
                Format::Text => write!(out, "{proof}")?,
                Format::Json => {
                    let record = CheckRecord::Inconsistent { proof };
                    writeln!(out, "{}", serde_json::to_string(&record)?)?;
                }
            }
            out.flush()?;
            bail!("{name} is inconsistent: no points of the plane are so");
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
    let distances = network.distances(&reference);
    let directions = network.directions();
    if form == Format::Json {
        let record = CheckRecord::NotRefuted {
            narrowed,
            distances,
            directions,
            explanation,
        };
        writeln!(out, "{}", serde_json::to_string(&record)?)?;
        return Ok(());
    }
    if let Some(explanation) = explanation {
        write!(out, "{explanation}")?;
        return Ok(());
    }
    let objects = network.objects().len();
    writeln!(
        out,
        "not refuted: {count} facts about {objects} objects leave these places"
    )?;
    for DistanceRecord {
        between: [a, b],
        depth,
    } in distances
    {
        writeln!(out, "  {a} - {b}: {{{}}}", depth.join(", "))?;
    }
    for DirectionRecord {
        observer,
        reference,
        object,
        orientation,
    } in directions
    {
        let labels = orientation.labels().join(", ");
        writeln!(
            out,
            "  {object} at {reference} seen from {observer}: {{{labels}}}"
        )?;
    }
    Ok(())
}

fn export(arguments: &ExportArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    ensure_folder(&arguments.out)?;
    let reference = reference_system(&arguments.system)?;
    let Facts {
        distances,
        directions,
    } = Facts::read(&arguments.file, &reference)?;
    if let Some(DirectionFact {
        source: FactSource::Told(line),
        ..
    }) = directions.first()
    {
        bail!(
            "{}, {line}: the form of GQR holds distances only; leave the directions out",
            arguments.file.display()
        );
    }
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
            GqrCalculus::network(&reference, &distances),
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

/// A network that is not refuted: of distances alone, which may be thousands, or with directions.
enum Closed {
    Distances(ConstraintNetwork),
    Places(PlaceNetwork),
}

impl Closed {
    /// Closes the facts: the network and how many distances it narrowed, or the proof that there is
    /// none.
    fn of(
        reference: &DepthReference,
        facts: Facts,
    ) -> Result<Result<(Self, usize), Explanation>, NotAFact> {
        let objects = facts.objects();
        let Facts {
            distances,
            directions,
        } = facts;
        let (network, closure) = if directions.is_empty() {
            let mut network = ConstraintNetwork::new(reference, objects);
            let closure = network.constrain(distances)?;
            (Self::Distances(network), closure)
        } else {
            let mut network = PlaceNetwork::new(reference, objects);
            let closure = network.constrain(distances, directions)?;
            (Self::Places(network), closure)
        };
        Ok(match closure {
            Closure::NotRefuted { narrowed } => Ok((network, narrowed)),
            Closure::Inconsistent(proof) => Err(proof),
        })
    }

    fn objects(&self) -> &[ObjectId] {
        match self {
            Self::Distances(network) => network.objects(),
            Self::Places(network) => network.objects(),
        }
    }

    fn explain(&self, a: &ObjectId, b: &ObjectId) -> Option<Explanation> {
        match self {
            Self::Distances(network) => network.explain(a, b),
            Self::Places(network) => network.explain(a, b),
        }
    }

    /// The distances of which something is known, by name.
    fn distances(&self, reference: &DepthReference) -> Vec<DistanceRecord> {
        let depth = |a, b| match self {
            Self::Distances(network) => network.depth(a, b),
            Self::Places(network) => network.depth(a, b),
        };
        let mut known = Vec::new();
        for (at, a) in self.objects().iter().enumerate() {
            for b in &self.objects()[at + 1..] {
                let depth = depth(a, b).filter(|&depth| depth != reference.all());
                known.extend(depth.map(|depth| {
                    let labels = reference.labels(depth).into_iter();
                    DistanceRecord {
                        between: [a.clone(), b.clone()],
                        depth: labels.map(str::to_owned).collect(),
                    }
                }));
            }
        }
        known
    }

    /// The directions of which something is known, by name.
    fn directions(&self) -> Vec<DirectionRecord> {
        let Self::Places(network) = self else {
            return Vec::new();
        };
        let directions = network.directions();
        let records =
            directions.map(
                |([observer, reference, object], orientation)| DirectionRecord {
                    observer: observer.clone(),
                    reference: reference.clone(),
                    object: object.clone(),
                    orientation,
                },
            );
        records.collect()
    }
}
