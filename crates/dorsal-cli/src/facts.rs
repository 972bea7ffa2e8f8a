use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, bail};
use dorsal::allocentric_qsr::{
    DepthReference, DirectionFact, DistanceFact, FactSource, ObjectId, ToldFact,
};

/// The facts of a file, one a line; the source of each is its line.
#[derive(Debug, Default)]
pub(crate) struct Facts {
    pub(crate) distances: Vec<DistanceFact>,
    pub(crate) directions: Vec<DirectionFact>,
}

impl Facts {
    /// Reads the facts of a file.
    pub(crate) fn read(path: &Path, reference: &DepthReference) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path)
            .with_context(|| format!("{} cannot be read as facts", path.display()))?;
        let mut facts = Self::default();
        for (at, line) in text.lines().enumerate() {
            let words = line.split('#').next().unwrap_or_default().trim();
            if words.is_empty() {
                continue;
            }
            let source = FactSource::Told(format!("line {}: {words}", at + 1));
            match (ToldFact::read(words, reference), DirectionFact::read(words)) {
                (Ok(ToldFact { between, depth }), _) => facts.distances.push(DistanceFact {
                    between,
                    depth,
                    source,
                }),
                (_, Ok(fact)) => facts.directions.push(DirectionFact { source, ..fact }),
                (Err(distance), Err(direction)) => {
                    // Whichever of the two it was to be, the second word tells.
                    let of_distance = words.split_whitespace().nth(1) == Some("within");
                    let error = if of_distance { distance } else { direction };
                    bail!(
                        "{}, line {}: \"{words}\" is no fact of {}: {error}; one reads \
                         `A within CLASSES of B` or `A LABELS of B seen from C`",
                        path.display(),
                        at + 1,
                        reference.name()
                    );
                }
            }
        }
        Ok(facts)
    }

    /// The objects they speak of.
    pub(crate) fn objects(&self) -> BTreeSet<ObjectId> {
        let ends = self.distances.iter().flat_map(|fact| &fact.between);
        let others = self
            .directions
            .iter()
            .flat_map(|fact| [&fact.observer, &fact.reference, &fact.object]);
        ends.chain(others).cloned().collect()
    }
}
