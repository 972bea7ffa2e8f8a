//! The one door to YAML: bytes to a value, with errors that say where.

use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error, Visitor};

use crate::toml_text::{self, NotToml};

/// Why bytes are not the YAML that a reader reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotYaml {
    /// The bytes are no text.
    #[error(transparent)]
    Text(#[from] NotToml),
    /// The text is no YAML, or has a key that is missing or of the wrong kind; the message says the
    /// line.
    #[error("{0}")]
    Grammar(String),
}

/// Decodes a document. What OpenCV writes beside YAML is left out: the head `%YAML:1.0`, whose colon
/// no YAML allows, and the tags of its matrices.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, NotYaml> {
    let text = toml_text::text(bytes)?;
    // As long as it was, so that lines and columns stay.
    let text = text
        .replace("!!opencv-matrix", "               ")
        .replace("%YAML:1.0", "#YAML:1.0");
    let options = serde_saphyr::options! {
        non_finite_float_policy: serde_saphyr::NonFiniteFloatPolicy::PassThrough,
    };
    serde_saphyr::from_str_with_options(&text, options).map_err(|error| {
        let message = error.to_string();
        // The first line says what is wrong and where; the rest draws the place.
        let first = message.lines().next().unwrap_or_default().trim();
        NotYaml::Grammar(first.strip_prefix("error: ").unwrap_or(first).to_owned())
    })
}

/// The line, counted from 1, on which a key of the document stands below another; 0 if it does not.
pub(crate) fn line_of(bytes: &[u8], keys: &[&str]) -> usize {
    let text = String::from_utf8_lossy(bytes);
    let mut wanted = keys.iter();
    let mut key = wanted.next();
    for (number, line) in (1..).zip(text.lines()) {
        let Some(now) = key else { return 0 };
        let found = line
            .trim_start()
            .strip_prefix(*now)
            .is_some_and(|rest| rest.trim_start().starts_with(':'));
        if found {
            key = wanted.next();
            if key.is_none() {
                return number;
            }
        }
    }
    0
}

/// A number in any spelling of the field's files: `1`, `1.`, `.nan`, `.Nan`, `NaN`, `-.Inf`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number(pub(crate) f64);

impl Number {
    /// The number that a word spells.
    pub(crate) fn spelt(word: &str) -> Option<f64> {
        let word = word.trim();
        let (sign, size) = match word.strip_prefix('-') {
            Some(size) => (-1.0, size),
            None => (1.0, word.strip_prefix('+').unwrap_or(word)),
        };
        let bare = size.strip_prefix('.').unwrap_or(size);
        if bare.eq_ignore_ascii_case("nan") {
            return Some(f64::NAN);
        }
        if bare.eq_ignore_ascii_case("inf") {
            return Some(sign * f64::INFINITY);
        }
        word.parse().ok()
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Spelling;
        impl Visitor<'_> for Spelling {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<Number, E> {
                Ok(Number(number))
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Number, E> {
                Ok(Number(number as f64))
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<Number, E> {
                Ok(Number(number as f64))
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<Number, E> {
                Number::spelt(word)
                    .map(Number)
                    .ok_or_else(|| E::custom(format!("'{word}' is no number")))
            }
        }
        deserializer.deserialize_any(Spelling)
    }
}

/// The numbers behind their spellings.
pub(crate) fn plain(numbers: &[Number]) -> Vec<f64> {
    numbers.iter().map(|number| number.0).collect()
}

/// A number as every reader of YAML takes it for one: with a point, and its exponent signed.
pub(crate) fn spell(number: f64) -> String {
    if number.is_nan() {
        return ".nan".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { ".inf" } else { "-.inf" }.to_owned();
    }
    let text = format!("{number:?}");
    match text.split_once('e') {
        None => text,
        Some((mantissa, exponent)) => {
            let point = if mantissa.contains('.') { "" } else { ".0" };
            let plus = if exponent.starts_with('-') { "" } else { "+" };
            format!("{mantissa}{point}e{plus}{exponent}")
        }
    }
}

/// Numbers in brackets.
pub(crate) fn spell_list(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(|number| spell(*number)).collect();
    format!("[{}]", words.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_is_a_number() {
        let list: Vec<Number> =
            decode(b"%YAML:1.0\n---\n[1, 2., -3.5e+02, .5, .Nan, .nan, NaN, .Inf, -.inf]").unwrap();
        let numbers = plain(&list);
        assert_eq!(numbers[..4], [1.0, 2.0, -350.0, 0.5]);
        assert!(numbers[4..7].iter().all(|number| number.is_nan()));
        assert_eq!(numbers[7..], [f64::INFINITY, f64::NEG_INFINITY]);
        let words: Result<Vec<Number>, NotYaml> = decode(b"- 1\n- two\n");
        let words = words.unwrap_err().to_string();
        assert!(words.contains("line 2") && words.contains("two"), "{words}");
    }

    #[test]
    fn numbers_are_spelt_for_all() {
        assert_eq!(spell(1e-7), "1.0e-7");
        assert_eq!(spell(2.5e20), "2.5e+20");
        assert_eq!(spell(3.0), "3.0");
        assert_eq!(line_of(b"a: 1\nb:\n  c : 2\n", &["b", "c"]), 3);
        assert_eq!(line_of(b"a: 1\n", &["c"]), 0);
    }
}
