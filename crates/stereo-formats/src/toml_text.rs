//! The one door to TOML: bytes to a value and back, with errors that say where.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why bytes are not the TOML that a reader reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotToml {
    /// The bytes are no text.
    #[error("it is no UTF-8 text: byte {0} fits nothing")]
    Text(usize),
    /// The text is no TOML, or has a key that is missing, unknown or of the wrong kind; the
    /// message shows the line.
    #[error("{0}")]
    Grammar(String),
}

pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, NotToml> {
    let text = text(bytes)?;
    toml::from_str(text).map_err(|error| NotToml::Grammar(error.to_string().trim_end().to_owned()))
}

/// The bytes as text.
pub(crate) fn text(bytes: &[u8]) -> Result<&str, NotToml> {
    std::str::from_utf8(bytes).map_err(|error| NotToml::Text(error.valid_up_to()))
}

pub(crate) fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, NotToml> {
    toml::to_string(value)
        .map(String::into_bytes)
        .map_err(|error| NotToml::Grammar(error.to_string()))
}
