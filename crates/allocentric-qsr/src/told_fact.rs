use crate::depth_reference::DepthReference;
use crate::query::BadQuery;
use crate::words::{Words, word};
use crate::{DepthSet, ObjectId};

/// A told fact: which classes the distance between two objects may be in.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ToldFact {
    /// The two objects; a fact may speak of what has not been seen.
    pub between: [ObjectId; 2],
    /// The classes.
    pub depth: DepthSet,
}

impl ToldFact {
    /// Reads a fact in words: `A within CLASSES of B`, the classes by label or name, joined by
    /// commas.
    ///
    /// # Errors
    /// [`BadQuery`] for words of another form, [`BadQuery::Word`] for a class that is none.
    pub fn read(words: &str, reference: &DepthReference) -> Result<Self, BadQuery> {
        let mut words = Words::of(words);
        let of = words.name()?;
        words.expect("within", "`within`")?;
        let classes = words.list("distance classes")?;
        words.expect("of", "`of`")?;
        let from = words.name()?;
        words.end()?;
        let classes = classes.iter().map(|label| {
            reference.class_named(label).ok_or_else(|| BadQuery::Word {
                found: label.clone(),
                expected: "a distance class",
            })
        });
        Ok(Self {
            between: [from, of],
            depth: classes.collect::<Result<DepthSet, BadQuery>>()?,
        })
    }

    /// The fact in the words it is read from.
    ///
    /// # Panics
    /// If a class is of a larger reference system.
    #[must_use]
    pub fn words(&self, reference: &DepthReference) -> String {
        let [a, b] = &self.between;
        format!(
            "{} within {} of {}",
            word(b),
            reference.labels(self.depth).join(","),
            word(a)
        )
    }
}
