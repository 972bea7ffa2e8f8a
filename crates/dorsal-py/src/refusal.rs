use std::fmt::Display;

use dorsal::Error;
use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use stereo_formats::Unreadable;

create_exception!(
    dorsal,
    Refused,
    PyValueError,
    "A memory refuses a look, a fact or a question; it stays as it was. The message says why."
);

/// A `ValueError` in the library's own words.
pub(crate) fn value_error(why: impl Display) -> PyErr {
    PyValueError::new_err(why.to_string())
}

/// The same for a look, whose errors speak of values that Python's caller gave.
pub(crate) fn look_error(why: Error) -> PyErr {
    value_error(why)
}

/// A file that does not open is an `OSError` of the system's kind, such as `FileNotFoundError`; one whose content
/// is wrong a `ValueError`.
pub(crate) fn file_error<E: Display>(why: Unreadable<E>) -> PyErr {
    let sentence = why.to_string();
    match why {
        Unreadable::Closed { cause, .. } => std::io::Error::new(cause.kind(), sentence).into(),
        Unreadable::TooLong { .. } | Unreadable::Content { .. } => value_error(sentence),
    }
}
