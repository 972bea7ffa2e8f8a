//! Facts that are told, and taken back.

use std::collections::BTreeSet;

use crate::memory_change::Change;
use crate::memory_params::Policy;
use crate::query::BadQuery;
use crate::refused::Refused;
use crate::scene_memory::SceneMemory;
use crate::told_fact::ToldFact;

impl SceneMemory {
    /// Takes in a told fact.
    ///
    /// # Errors
    /// [`Refused::Contradiction`] if it cannot hold with what is known, whatever the policy, for
    /// what is told does not outweigh what is seen; [`Refused::Fact`] if it is none.
    pub fn tell(&mut self, fact: ToldFact) -> Result<Vec<Change>, Refused> {
        let mut next = self.clone();
        let change = Change::Told {
            fact: next.words(&fact),
        };
        if !next.facts.contains(&fact) {
            next.facts.push(fact);
        }
        next.network(&BTreeSet::new())?;
        next.note(std::slice::from_ref(&change));
        *self = next;
        Ok(vec![change])
    }

    /// Takes a told fact back.
    ///
    /// # Errors
    /// [`Refused::NeverTold`] if it was not told.
    pub fn retract(&mut self, fact: &ToldFact) -> Result<Vec<Change>, Refused> {
        let words = self.words(fact);
        let Some(place) = self.facts.iter().position(|told| told == fact) else {
            return Err(Refused::NeverTold(words));
        };
        self.facts.remove(place);
        let change = Change::Retracted { fact: words };
        self.note(std::slice::from_ref(&change));
        Ok(vec![change])
    }

    /// Reads a fact in words: see [`ToldFact::read`].
    ///
    /// # Errors
    /// [`BadQuery`] for words of another form, [`BadQuery::Word`] for a class that is none.
    pub fn read_fact(&self, words: &str) -> Result<ToldFact, BadQuery> {
        ToldFact::read(words, &self.reference)
    }

    /// A fact in the words of the query language.
    #[must_use]
    pub fn words(&self, fact: &ToldFact) -> String {
        fact.words(&self.reference)
    }

    /// Facts and places must hold together; by policy the newest fact yields to what is seen.
    pub(crate) fn agree_with_facts(&mut self, changes: &mut Vec<Change>) -> Result<(), Refused> {
        while let Err(refused) = self.network(&BTreeSet::new()) {
            let newest = match self.params.policy {
                Policy::Refuse => None,
                Policy::Follow => self.facts.pop(),
            };
            let Some(fact) = newest else {
                return Err(refused);
            };
            changes.push(Change::Retracted {
                fact: self.words(&fact),
            });
        }
        Ok(())
    }
}
