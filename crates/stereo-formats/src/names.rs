//! The names of labels: a TOML table `[names]` of label number to name.

use std::collections::BTreeMap;
use std::num::NonZeroU16;
use std::path::Path;

use egocentric_depth::{Label, LabelImage};
use serde::{Deserialize, Serialize};

use crate::file::{self, Unreadable, Unwritable};
use crate::toml_text::{self, NotToml};

/// What each labelled object is called.
pub type Names = BTreeMap<Label, String>;

/// Why a text gives no names.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotNames {
    /// The text is not the TOML that is read here.
    #[error("{0}\nA names file reads: [names], then lines such as 1 = \"cup\".")]
    Toml(#[from] NotToml),
    /// A key is not a label.
    #[error("'{0}' is no label; labels are whole numbers from 1 to 65535")]
    Label(String),
    /// Two spellings of one label.
    #[error("label {} is named twice", .0.0)]
    Twice(Label),
    /// One name for two labels.
    #[error("labels {} and {} are both named '{name}'; relations need names of their own", first.0, second.0)]
    Shared {
        /// The lower label.
        first: Label,
        /// The higher label.
        second: Label,
        /// Their common name.
        name: String,
    },
    /// An empty name.
    #[error("label {} has an empty name", .0.0)]
    Empty(Label),
}

/// Names and a label image that do not belong together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct NamesDiffer {
    /// Named labels that no pixel has.
    pub unseen: Vec<(Label, String)>,
    /// Labels of pixels that have no name.
    pub nameless: Vec<Label>,
}

impl NamesDiffer {
    fn sentence(&self) -> String {
        let unseen = self
            .unseen
            .iter()
            .map(|(label, name)| format!("label {} ('{name}') has a name and no pixel", label.0));
        let nameless = self
            .nameless
            .iter()
            .map(|label| format!("label {} has pixels and no name", label.0));
        unseen.chain(nameless).collect::<Vec<_>>().join("; ")
    }
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Text {
    names: BTreeMap<String, String>,
}

/// Decodes the names of labels.
///
/// # Errors
/// [`NotNames`] says what is wrong and where.
pub fn decode(bytes: &[u8]) -> Result<Names, NotNames> {
    let text: Text = toml_text::decode(bytes)?;
    let mut names = Names::new();
    for (key, name) in text.names {
        let label = Label(
            key.parse::<NonZeroU16>()
                .map_err(|_| NotNames::Label(key))?,
        );
        if names.insert(label, name).is_some() {
            return Err(NotNames::Twice(label));
        }
    }
    distinct(&names)?;
    Ok(names)
}

/// Whether every name is one, and no two labels share it.
pub(crate) fn distinct(names: &Names) -> Result<(), NotNames> {
    let mut bearers = BTreeMap::new();
    for (&label, name) in names {
        if name.trim().is_empty() {
            return Err(NotNames::Empty(label));
        }
        if let Some(first) = bearers.insert(name, label) {
            return Err(NotNames::Shared {
                first,
                second: label,
                name: name.clone(),
            });
        }
    }
    Ok(())
}

/// Reads the names of labels; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Names, Unreadable<NotNames>> {
    file::read(path.as_ref(), decode)
}

/// The names file of these names.
///
/// # Errors
/// [`NotNames`] if a name is empty or shared: such a file would not be read back.
pub fn encode(names: &Names) -> Result<Vec<u8>, NotNames> {
    distinct(names)?;
    let names = names
        .iter()
        .map(|(label, name)| (label.0.to_string(), name.clone()));
    Ok(toml_text::encode(&Text {
        names: names.collect(),
    })?)
}

/// Writes the names of labels, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(path: impl AsRef<Path>, names: &Names) -> Result<(), Unwritable<NotNames>> {
    file::write(path.as_ref(), encode(names))
}

/// Whether these names name exactly the objects of a label image.
///
/// # Errors
/// [`NamesDiffer`] lists every name without a pixel and every label without a name.
pub fn agree(names: &Names, labels: &LabelImage) -> Result<(), NamesDiffer> {
    let seen = labels.labels();
    let unseen: Vec<_> = names
        .iter()
        .filter(|(label, _)| seen.binary_search(label).is_err())
        .map(|(&label, name)| (label, name.clone()))
        .collect();
    let nameless: Vec<_> = seen
        .into_iter()
        .filter(|label| !names.contains_key(label))
        .collect();
    if unseen.is_empty() && nameless.is_empty() {
        Ok(())
    } else {
        Err(NamesDiffer { unseen, nameless })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(number: u16) -> Label {
        Label(NonZeroU16::new(number).unwrap())
    }

    #[test]
    fn refusals_say_what() {
        let refused = |text: &str| decode(text.as_bytes()).unwrap_err();
        assert_eq!(refused("[names]\n0 = \"cup\""), NotNames::Label("0".into()));
        assert_eq!(
            refused("[names]\ncup = \"cup\""),
            NotNames::Label("cup".into())
        );
        assert_eq!(
            refused("[names]\n1 = \"a\"\n01 = \"b\""),
            NotNames::Twice(label(1))
        );
        assert_eq!(refused("[names]\n3 = \" \""), NotNames::Empty(label(3)));
        assert!(matches!(
            refused("[names]\n3 = \"a\"\n7 = \"a\""),
            NotNames::Shared { .. }
        ));
        assert!(refused("[name]\n3 = \"a\"").to_string().contains("line 1"));
    }

    #[test]
    fn what_does_not_agree_is_listed() {
        let labels = LabelImage::new(ndarray::array![[0, 1, 5]]);
        let names: Names = [(label(1), "cup".to_owned()), (label(2), "pen".to_owned())].into();
        let differ = agree(&names, &labels).unwrap_err();
        assert_eq!(
            differ.to_string(),
            "label 2 ('pen') has a name and no pixel; label 5 has pixels and no name"
        );
        let names: Names = [(label(1), "cup".to_owned()), (label(5), "pen".to_owned())].into();
        assert_eq!(agree(&names, &labels), Ok(()));
    }
}
