use crate::constraint_network::FactSource;
use crate::query::BadQuery;
use crate::words::Words;
use crate::{ObjectId, OrientationSet};

/// What is known of a direction, and from whom: where an object is at a reference, against the way
/// that leads there from an observer. The observer and the reference are in two places.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct DirectionFact {
    /// Where the direction comes from.
    pub observer: ObjectId,
    /// What it leads to.
    pub reference: ObjectId,
    /// What is placed.
    pub object: ObjectId,
    /// The labels of the object at the reference.
    pub at_reference: OrientationSet,
    /// The labels of the object at the observer, against the same way: the turn from the reference
    /// to the object.
    pub at_observer: OrientationSet,
    /// Where it comes from.
    pub source: FactSource,
}

impl DirectionFact {
    /// Reads a fact in words: `A LABELS of B seen from C`, the labels as a
    /// [`Query`](crate::Query) has them, the name of the observer that of an object. The source is
    /// the words themselves.
    ///
    /// # Errors
    /// [`BadQuery`] for words of another form.
    pub fn read(text: &str) -> Result<Self, BadQuery> {
        let mut words = Words::of(text);
        let object = words.name()?;
        let at_reference = words.labels("an orientation")?;
        words.expect("of", "`of`")?;
        let reference = words.name()?;
        words.expect("seen", "`seen`")?;
        words.expect("from", "`from`")?;
        let observer = words.name()?;
        words.end()?;
        Ok(Self {
            observer,
            reference,
            object,
            at_reference,
            at_observer: OrientationSet::ALL,
            source: FactSource::Told(text.to_owned()),
        })
    }
}
