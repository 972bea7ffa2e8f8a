//! What became different: the log of a memory, and the difference between two states of it.

use crate::memory_change::{Change, Dated};
use crate::scene_memory::SceneMemory;

impl SceneMemory {
    /// The changes from one time to another, both included; `None` if the memory no longer keeps
    /// the earlier of them.
    #[must_use]
    pub fn changes(&self, from_ms: u64, to_ms: u64) -> Option<Vec<&Dated>> {
        let full = self.changes.len() >= self.params.most_changes;
        if full
            && self
                .changes
                .front()
                .is_some_and(|oldest| oldest.time_ms >= from_ms)
        {
            return None;
        }
        let within = |dated: &&Dated| (from_ms..=to_ms).contains(&dated.time_ms);
        Some(self.changes.iter().filter(within).collect())
    }

    /// What is different in a later state of this memory: lives, moves and facts, by name.
    #[must_use]
    pub fn diff(&self, later: &Self) -> Vec<Change> {
        let mut changes = Vec::new();
        for (object, is) in &later.objects {
            match self.objects.get(object) {
                None => changes.push(Change::Appeared {
                    object: object.clone(),
                }),
                Some(was) => {
                    if was.epoch != is.epoch {
                        changes.push(Change::Moved {
                            object: object.clone(),
                            epoch: is.epoch,
                        });
                    }
                    if was.life != is.life {
                        changes.push(Change::Became {
                            object: object.clone(),
                            from: was.life,
                            to: is.life,
                        });
                    }
                }
            }
        }
        let only = |some: &Self, other: &Self| -> Vec<String> {
            let facts = some.facts.iter().filter(|fact| !other.facts.contains(fact));
            facts.map(|fact| some.words(fact)).collect()
        };
        let told = only(later, self)
            .into_iter()
            .map(|fact| Change::Told { fact });
        let gone = only(self, later)
            .into_iter()
            .map(|fact| Change::Retracted { fact });
        changes.extend(told);
        changes.extend(gone);
        changes
    }

    pub(crate) fn note(&mut self, changes: &[Change]) {
        let (time_ms, look) = (self.time_ms, self.looks);
        self.changes
            .extend(changes.iter().cloned().map(|change| Dated {
                time_ms,
                look,
                change,
            }));
        let spare = self.changes.len().saturating_sub(self.params.most_changes);
        self.changes.drain(..spare);
    }
}
