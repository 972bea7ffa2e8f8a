use serde::{Deserialize, Serialize};

use crate::{BaseRelation, Depth, DepthSet};

/// The most classes a reference system may have: one bit of a [`DepthSet`] each.
const MOST_CLASSES: usize = 32;

/// A depth reference system: how the distances from a point are divided into named classes.
///
/// The classes are the half-open intervals `[b_k, b_{k+1})` between ascending bounds in whole
/// millimetres. The first bound is 0 and the last class is open to infinity, so every distance
/// belongs to exactly one class. Names and short labels are unique.
///
/// As data (TOML, JSON) each class says where it begins; it ends where the next one begins:
///
/// ```
/// # use allocentric_qsr::DepthReference;
/// let arm = DepthReference::from_toml(r#"
///     name = "arm"
///     class = [
///         { short = "in", name = "within_reach", from_mm = 0 },
///         { short = "out", name = "out_of_reach", from_mm = 850 },
///     ]
/// "#)?;
/// assert_eq!(arm.short(arm.qualify(0.849)?), "in");
/// assert_eq!(arm.short(arm.qualify(0.850)?), "out");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct DepthReference {
    name: String,
    #[serde(rename = "class")]
    classes: Vec<DepthClass>,
}

/// One named interval of a reference system, from its lower bound to the bound of the next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DepthClass {
    /// The label of tables and files, such as `vc`.
    pub short: String,
    /// The name a person reads, such as `very_close`.
    pub name: String,
    /// The lower bound, in millimetres; it belongs to the class.
    pub from_mm: u32,
}

/// What a file may say before anyone has looked at it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    name: String,
    class: Vec<DepthClass>,
}

/// Why these classes do not divide the distances.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadReference {
    /// There is no class.
    #[error("a reference system needs at least one class")]
    Empty,
    /// There are more classes than a relation set can hold.
    #[error("{0} classes are too many; a reference system has at most 32")]
    TooMany(usize),
    /// Some distances next to the reference point belong to no class.
    #[error("the first class begins at {0} mm; it must begin at 0")]
    First(u32),
    /// A class begins where the one before it does, or earlier.
    #[error("class `{short}` begins at {from_mm} mm, but the class before it at {before_mm} mm")]
    Order {
        /// The label of the class out of order.
        short: String,
        /// Its lower bound.
        from_mm: u32,
        /// The lower bound of the class before.
        before_mm: u32,
    },
    /// Two classes share a label or a name, or a label is blank or holds white space.
    #[error("label `{0}` is blank, holds white space, or names two classes")]
    Label(String),
    /// The text is not TOML of the expected form.
    #[error("not a reference system: {0}")]
    Toml(String),
}

/// A number that is no distance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{0} m is no distance; it must be zero or positive")]
pub struct NotADistance(pub f64);

impl DepthReference {
    /// A reference system from its classes in ascending order.
    ///
    /// # Errors
    /// [`BadReference`] says why the classes do not divide the distances.
    pub fn new(name: impl Into<String>, classes: Vec<DepthClass>) -> Result<Self, BadReference> {
        let Some(first) = classes.first() else {
            return Err(BadReference::Empty);
        };
        if classes.len() > MOST_CLASSES {
            return Err(BadReference::TooMany(classes.len()));
        }
        if first.from_mm != 0 {
            return Err(BadReference::First(first.from_mm));
        }
        if let Some(pair) = classes.windows(2).find(|c| c[1].from_mm <= c[0].from_mm) {
            return Err(BadReference::Order {
                short: pair[1].short.clone(),
                from_mm: pair[1].from_mm,
                before_mm: pair[0].from_mm,
            });
        }
        for (at, class) in classes.iter().enumerate() {
            let earlier = &classes[..at];
            if unusable(&class.short) || earlier.iter().any(|c| c.short == class.short) {
                return Err(BadReference::Label(class.short.clone()));
            }
            if unusable(&class.name) || earlier.iter().any(|c| c.name == class.name) {
                return Err(BadReference::Label(class.name.clone()));
            }
        }
        Ok(Self {
            name: name.into(),
            classes,
        })
    }

    /// Reads a reference system from TOML text: a `name` and an array `class`.
    ///
    /// # Errors
    /// [`BadReference::Toml`] if the text has another form, or what is wrong with the classes.
    pub fn from_toml(text: &str) -> Result<Self, BadReference> {
        let read: Unchecked =
            toml::from_str(text).map_err(|error| BadReference::Toml(error.to_string()))?;
        read.try_into()
    }

    /// The name of the system, such as `drs1`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The classes, nearest first.
    #[must_use]
    pub fn classes(&self) -> &[DepthClass] {
        &self.classes
    }

    /// Every class of the system: nothing is known of the distance.
    #[must_use]
    pub fn all(&self) -> DepthSet {
        DepthSet::first(self.classes.len())
    }

    /// The class that is open to infinity.
    #[must_use]
    pub fn last(&self) -> Depth {
        Depth::of_index(self.classes.len() - 1)
    }

    /// The class a distance belongs to; infinity belongs to the last.
    ///
    /// The bounds are compared in metres, as the number nearest to the decimal fraction, so
    /// that the literal 0.6 lies on the bound of 600 mm.
    ///
    /// # Errors
    /// [`NotADistance`] if the number is negative or not a number.
    pub fn qualify(&self, distance_m: f64) -> Result<Depth, NotADistance> {
        if distance_m >= 0.0 {
            Ok(self.class_of(distance_m))
        } else {
            Err(NotADistance(distance_m))
        }
    }

    /// The class of a whole number of millimetres.
    #[must_use]
    pub fn qualify_mm(&self, distance_mm: u64) -> Depth {
        self.last_where(|from_mm| u64::from(from_mm) <= distance_mm)
    }

    /// The short label of a class, such as `vc`.
    ///
    /// # Panics
    /// If the class is of a larger system.
    #[must_use]
    pub fn short(&self, depth: Depth) -> &str {
        &self.classes[depth.index()].short
    }

    /// The name of a class, such as `very_close`.
    ///
    /// # Panics
    /// If the class is of a larger system.
    #[must_use]
    pub fn name_of(&self, depth: Depth) -> &str {
        &self.classes[depth.index()].name
    }

    /// The class with this short label or name.
    #[must_use]
    pub fn class_named(&self, label: &str) -> Option<Depth> {
        self.classes
            .iter()
            .position(|class| class.short == label || class.name == label)
            .map(Depth::of_index)
    }

    /// The short labels of a set, nearest first: the form of every file and table.
    ///
    /// # Panics
    /// If the set is of a larger system.
    #[must_use]
    pub fn labels(&self, depths: DepthSet) -> Vec<&str> {
        depths.iter().map(|depth| self.short(depth)).collect()
    }

    /// For each class of this system the class of `coarse` that contains it, or `None` if some
    /// class of this system lies across a bound of the other.
    #[must_use]
    pub fn coarsening(&self, coarse: &Self) -> Option<Vec<Depth>> {
        let refines = coarse
            .classes
            .iter()
            .all(|wide| self.classes.iter().any(|c| c.from_mm == wide.from_mm));
        refines.then(|| {
            self.classes
                .iter()
                .map(|class| coarse.qualify_mm(class.from_mm.into()))
                .collect()
        })
    }

    /// The lower bound of a class, which belongs to it, in millimetres.
    pub(crate) fn low_mm(&self, depth: Depth) -> u64 {
        self.classes[depth.index()].from_mm.into()
    }

    /// The upper bound of a class, which does not belong to it, or `None` for the last.
    pub(crate) fn high_mm(&self, depth: Depth) -> Option<u64> {
        self.classes
            .get(depth.index() + 1)
            .map(|next| next.from_mm.into())
    }

    /// The class of a number that is known to be a distance.
    pub(crate) fn class_of(&self, distance_m: f64) -> Depth {
        self.last_where(|from_mm| f64::from(from_mm) / 1000.0 <= distance_m)
    }

    /// The last class whose lower bound passes; the first passes always.
    pub(crate) fn last_where(&self, passes: impl Fn(u32) -> bool) -> Depth {
        let index = self.classes.iter().rposition(|c| passes(c.from_mm));
        Depth::of_index(index.unwrap_or(0))
    }
}

/// A label that could not be written into a table or an array of labels.
fn unusable(label: &str) -> bool {
    label.is_empty() || label.contains(char::is_whitespace)
}

impl TryFrom<Unchecked> for DepthReference {
    type Error = BadReference;
    fn try_from(read: Unchecked) -> Result<Self, BadReference> {
        Self::new(read.name, read.class)
    }
}
