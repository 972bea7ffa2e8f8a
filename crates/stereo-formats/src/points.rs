//! Sparse truth: a CSV of points seen by both eyes.
//!
//! The first line names the columns; `x_left`, `y_left`, `x_right`, `y_right` must be among them,
//! `depth_left_mm` may be, and others are left alone.

use std::path::Path;

use crate::file::{self, Unreadable};
use crate::toml_text::{self, NotToml};

/// One point of the world as both eyes see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointPair {
    /// Where the left eye sees it: `(x, y)` in pixels.
    pub left_px: (f64, f64),
    /// Where the right eye sees it: `(x, y)` in pixels.
    pub right_px: (f64, f64),
    /// Its depth along the left eye's optical axis in metres, if published.
    pub depth_m: Option<f64>,
}

impl PointPair {
    /// The disparity `(dx, dy)` in the library's sign, right minus left, in pixels.
    #[must_use]
    pub const fn disparity_px(&self) -> (f64, f64) {
        (
            self.right_px.0 - self.left_px.0,
            self.right_px.1 - self.left_px.1,
        )
    }
}

/// Why a text is not a list of points.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotPoints {
    /// The bytes are no text.
    #[error(transparent)]
    Text(#[from] NotToml),
    /// A column that must be there and is not.
    #[error("its first line names no column '{0}'; x_left, y_left, x_right and y_right are needed")]
    Column(&'static str),
    /// A field that is missing or no finite number.
    #[error("line {line} has no finite number in column '{column}'")]
    Number {
        /// The line, counted from 1.
        line: usize,
        /// The column.
        column: &'static str,
    },
    /// A depth that is not in front of the eye.
    #[error("line {0} has a depth that is not positive")]
    Depth(usize),
}

/// Decodes a list of points.
///
/// # Errors
/// [`NotPoints`] says what is missing or wrong, and in which line.
pub fn decode(bytes: &[u8]) -> Result<Vec<PointPair>, NotPoints> {
    let mut lines = (1..).zip(toml_text::text(bytes)?.lines());
    let header: Vec<&str> = lines.next().map_or_else(Vec::new, |(_, header)| {
        header.split(',').map(str::trim).collect()
    });
    let optional = |name: &'static str| {
        let index = header.iter().position(|column| *column == name);
        index.map(|index| Column { name, index })
    };
    let needed = |name| optional(name).ok_or(NotPoints::Column(name));
    let (x_left, y_left) = (needed("x_left")?, needed("y_left")?);
    let (x_right, y_right) = (needed("x_right")?, needed("y_right")?);
    let depth = optional("depth_left_mm");

    lines
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(number, line)| {
            let fields: Vec<&str> = line.split(',').take(header.len()).collect();
            let at = |column: Column| column.of(&fields, number);
            let depth_mm = depth.map(at).transpose()?;
            if depth_mm.is_some_and(|depth_mm| depth_mm <= 0.0) {
                return Err(NotPoints::Depth(number));
            }
            Ok(PointPair {
                left_px: (at(x_left)?, at(y_left)?),
                right_px: (at(x_right)?, at(y_right)?),
                depth_m: depth_mm.map(|depth_mm| depth_mm / 1000.0),
            })
        })
        .collect()
}

#[derive(Clone, Copy)]
struct Column {
    name: &'static str,
    index: usize,
}

impl Column {
    fn of(self, fields: &[&str], line: usize) -> Result<f64, NotPoints> {
        fields
            .get(self.index)
            .and_then(|field| field.trim().parse().ok())
            .filter(|number: &f64| number.is_finite())
            .ok_or(NotPoints::Number {
                line,
                column: self.name,
            })
    }
}

/// Reads a list of points; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<PointPair>, Unreadable<NotPoints>> {
    file::read(path.as_ref(), decode)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name() {
        let points =
            decode(b"y_left,x_left,x_right,y_right,views,depth_left_mm\n2,10,7,3,5,500\n").unwrap();
        let want = PointPair {
            left_px: (10.0, 2.0),
            right_px: (7.0, 3.0),
            depth_m: Some(0.5),
        };
        assert_eq!(points, [want]);
        assert_eq!(want.disparity_px(), (-3.0, 1.0));
    }

    #[test]
    fn refusals_say_what_and_where() {
        assert_eq!(decode(b""), Err(NotPoints::Column("x_left")));
        let head = "x_left,y_left,x_right,y_right,depth_left_mm\n";
        let refused = |line: &str| decode(format!("{head}\n{line}\n").as_bytes()).unwrap_err();
        assert_eq!(
            refused("1,2,3"),
            NotPoints::Number {
                line: 3,
                column: "depth_left_mm"
            }
        );
        assert_eq!(
            refused("1,nan,3,4,5"),
            NotPoints::Number {
                line: 3,
                column: "y_left"
            }
        );
        assert_eq!(refused("1,2,3,4,-5"), NotPoints::Depth(3));
    }
}
