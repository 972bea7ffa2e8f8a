//! Objects outlined by hand: a TOML list of named polygons over a picture of known size.
//!
//! ```toml
//! width = 741
//! height = 500
//!
//! [[object]]
//! name = "wheel"
//! polygon = [[10, 20], [60, 20.5], [40, 80]]
//! ```
//!
//! Objects get the labels 1, 2, 3 ... in the order of the file.

use std::collections::BTreeSet;
use std::num::NonZeroU16;
use std::path::Path;

use egocentric_depth::{Label, LabelImage};
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use v1_gabor::Size;

use crate::file::{self, Unreadable, Unwritable};
use crate::names::{self, Names, NotNames};
use crate::raster::MOST_PIXELS;
use crate::toml_text::{self, NotToml};

/// Named outlines over a picture.
///
/// The picture has at least one pixel and at most [`MOST_PIXELS`]; every outline has at least
/// three corners, all inside the picture; names are distinct.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelPolygons {
    size: Size,
    objects: Vec<Outline>,
}

/// The outline of one object.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    /// What the object is called.
    pub name: String,
    /// Corners `[x, y]` in pixels, in order; the last is joined to the first.
    pub polygon: Vec<[f64; 2]>,
}

/// Why outlines are not the objects of a picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadPolygons {
    /// The text is not the TOML that is read here.
    #[error("{0}\nA polygons file has width, height and [[object]] tables of name and polygon.")]
    Toml(#[from] NotToml),
    /// The picture has no pixel, or too many.
    #[error("a picture of {0} pixels cannot be; it has at least one and at most {MOST_PIXELS}")]
    Size(Size),
    /// More objects than labels.
    #[error("{0} objects are more than there are labels (65535)")]
    TooMany(usize),
    /// A name is empty or shared.
    #[error(transparent)]
    Names(#[from] NotNames),
    /// Too few corners.
    #[error("'{name}' has {corners} corners, and a polygon has at least three")]
    Corners {
        /// The object.
        name: String,
        /// How many corners it has.
        corners: usize,
    },
    /// A corner lies outside the picture.
    #[error(
        "'{name}' has a corner at ({x}, {y}), outside the picture of {size} pixels; \
         pixel centres run from 0 to width - 1 and height - 1"
    )]
    Outside {
        /// The object.
        name: String,
        /// Column of the corner, in pixels.
        x: f64,
        /// Row of the corner, in pixels.
        y: f64,
        /// Size of the picture.
        size: Size,
    },
    /// No pixel is left to an object.
    #[error("'{0}' has no pixel: its polygon holds no pixel centre, or later objects cover it")]
    Unseen(String),
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Text {
    width: usize,
    height: usize,
    #[serde(default)]
    object: Vec<Outline>,
}

impl LabelPolygons {
    /// Takes outlines over a picture of this size.
    ///
    /// # Errors
    /// [`BadPolygons`] says which object cannot be, and why.
    pub fn new(size: Size, objects: Vec<Outline>) -> Result<Self, BadPolygons> {
        let pixels = size.width.checked_mul(size.height);
        if !pixels.is_some_and(|pixels| (1..=MOST_PIXELS).contains(&pixels)) {
            return Err(BadPolygons::Size(size));
        }
        if objects.len() > usize::from(u16::MAX) {
            return Err(BadPolygons::TooMany(objects.len()));
        }
        names::distinct(&names_of(&objects))?;
        for Outline { name, polygon } in &objects {
            if polygon.len() < 3 {
                return Err(BadPolygons::Corners {
                    name: name.clone(),
                    corners: polygon.len(),
                });
            }
            // A pixel reaches half a pixel about its centre.
            let inside = |at: f64, extent: usize| (-0.5..=extent as f64 - 0.5).contains(&at);
            for &[x, y] in polygon {
                if !(inside(x, size.width) && inside(y, size.height)) {
                    return Err(BadPolygons::Outside {
                        name: name.clone(),
                        x,
                        y,
                        size,
                    });
                }
            }
        }
        Ok(Self { size, objects })
    }

    /// Size of the picture that the outlines belong to.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The outlines; the first has label 1.
    #[must_use]
    pub fn objects(&self) -> &[Outline] {
        &self.objects
    }

    /// What each label is called.
    #[must_use]
    pub fn names(&self) -> Names {
        names_of(&self.objects)
    }

    /// The label image: every polygon filled by the even-odd rule, later ones over earlier ones.
    ///
    /// # Errors
    /// [`BadPolygons::Unseen`] names an object that is left without a pixel.
    pub fn fill(&self) -> Result<LabelImage, BadPolygons> {
        let mut labels = Array2::zeros(self.size.dim());
        for (label, object) in (1u16..).zip(&self.objects) {
            fill(&mut labels, &object.polygon, label);
        }
        let labels = LabelImage::new(labels);
        let seen: BTreeSet<Label> = labels.labels().into_iter().collect();
        match self
            .names()
            .into_iter()
            .find(|(label, _)| !seen.contains(label))
        {
            Some((_, name)) => Err(BadPolygons::Unseen(name)),
            None => Ok(labels),
        }
    }
}

fn names_of(objects: &[Outline]) -> Names {
    (1u16..)
        .zip(objects)
        .filter_map(|(number, object)| Some((Label(NonZeroU16::new(number)?), object.name.clone())))
        .collect()
}

/// Gives a label to every pixel whose centre lies inside the polygon: an odd number of edges to
/// its left on its row. A pixel on a left or upper edge is inside, on a right or lower one outside,
/// so that polygons that share an edge share no pixel.
fn fill(labels: &mut Array2<u16>, polygon: &[[f64; 2]], label: u16) {
    let edges = || polygon.iter().zip(polygon.iter().cycle().skip(1));
    let top = polygon
        .iter()
        .map(|corner| corner[1])
        .fold(f64::MAX, f64::min);
    let bottom = polygon
        .iter()
        .map(|corner| corner[1])
        .fold(f64::MIN, f64::max);
    // A cast to an index stops at zero.
    let rows = top.ceil() as usize..(bottom.floor() + 1.0) as usize;
    let mut crossings = Vec::new();
    for y in rows.start..rows.end.min(labels.nrows()) {
        let at = y as f64;
        crossings.clear();
        for (&[x0, y0], &[x1, y1]) in edges() {
            if (y0 <= at) != (y1 <= at) {
                crossings.push(x0 + (x1 - x0) * ((at - y0) / (y1 - y0)));
            }
        }
        crossings.sort_unstable_by(f64::total_cmp);
        let width = labels.ncols();
        let (spans, _) = crossings.as_chunks::<2>();
        for [from, to] in spans {
            let span = (from.ceil() as usize).min(width)..(to.ceil() as usize).min(width);
            for x in span {
                labels[[y, x]] = label;
            }
        }
    }
}

/// Decodes outlines; the label image is not made before [`LabelPolygons::fill`].
///
/// # Errors
/// [`BadPolygons`] says what is wrong and where.
pub fn decode(bytes: &[u8]) -> Result<LabelPolygons, BadPolygons> {
    let text: Text = toml_text::decode(bytes)?;
    let size = Size {
        width: text.width,
        height: text.height,
    };
    LabelPolygons::new(size, text.object)
}

/// Reads outlines; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<LabelPolygons, Unreadable<BadPolygons>> {
    file::read(path.as_ref(), decode)
}

/// The TOML text of outlines.
///
/// # Errors
/// [`BadPolygons::Toml`] if a name cannot be written, which no text is known to cause.
pub fn encode(polygons: &LabelPolygons) -> Result<Vec<u8>, BadPolygons> {
    Ok(toml_text::encode(&Text {
        width: polygons.size.width,
        height: polygons.size.height,
        object: polygons.objects.clone(),
    })?)
}

/// Writes outlines, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    polygons: &LabelPolygons,
) -> Result<(), Unwritable<BadPolygons>> {
    file::write(path.as_ref(), encode(polygons))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn outline(name: &str, polygon: &[[f64; 2]]) -> Outline {
        Outline {
            name: name.to_owned(),
            polygon: polygon.to_vec(),
        }
    }

    const SQUARE: [[f64; 2]; 4] = [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]];
    const SIZE: Size = Size {
        width: 5,
        height: 4,
    };

    #[test]
    fn later_objects_lie_over_earlier_ones() {
        let over = [[1.5, 0.0], [4.5, 0.0], [4.5, 2.0], [1.5, 2.0]];
        let objects = vec![outline("under", &SQUARE), outline("over", &over)];
        let labels = LabelPolygons::new(SIZE, objects).unwrap().fill().unwrap();
        let want = ndarray::array![
            [0, 0, 2, 2, 2],
            [0, 1, 2, 2, 2],
            [0, 1, 1, 0, 0],
            [0, 0, 0, 0, 0]
        ];
        assert_eq!(labels.plane(), want);
    }

    #[test]
    fn refusals_name_the_object() {
        let refused = |objects| LabelPolygons::new(SIZE, objects).unwrap_err().to_string();
        assert!(refused(vec![outline("line", &SQUARE[..2])]).contains("'line' has 2 corners"));
        let outside = outline("far", &[[0.0, 0.0], [5.0, 0.0], [0.0, 1.0]]);
        assert!(refused(vec![outside]).contains("(5, 0), outside the picture of 5 x 4"));
        let nan = outline("nan", &[[0.0, f64::NAN], [1.0, 0.0], [0.0, 1.0]]);
        assert!(refused(vec![nan]).contains("'nan'"));
        assert!(refused(vec![outline("a", &SQUARE), outline("a", &SQUARE)]).contains("both"));
        let hidden = vec![outline("hidden", &SQUARE), outline("cover", &SQUARE)];
        let hidden = LabelPolygons::new(SIZE, hidden).unwrap().fill();
        assert_eq!(hidden, Err(BadPolygons::Unseen("hidden".to_owned())));
        let huge = decode(b"width = 1000000000\nheight = 1000000000\n");
        assert!(matches!(huge, Err(BadPolygons::Size(_))));
    }

    /// The slow twin of the fill: how often a ray to the left meets an edge.
    fn inside(polygon: &[[f64; 2]], x: f64, y: f64) -> bool {
        let mut odd = false;
        let mut previous = polygon[polygon.len() - 1];
        for &corner in polygon {
            let ([x0, y0], [x1, y1]) = (previous, corner);
            if (y0 <= y) != (y1 <= y) && x0 + (x1 - x0) * ((y - y0) / (y1 - y0)) <= x {
                odd = !odd;
            }
            previous = corner;
        }
        odd
    }

    proptest! {
        /// The fill agrees with asking every pixel by itself.
        #[test]
        fn the_fill_is_even_odd(
            corners in prop::collection::vec((-0.5f64..19.5, -0.5f64..14.5), 3..9),
        ) {
            let polygon: Vec<[f64; 2]> = corners.into_iter().map(|(x, y)| [x, y]).collect();
            let mut labels = Array2::zeros((15, 20));
            fill(&mut labels, &polygon, 7);
            for ((y, x), &label) in labels.indexed_iter() {
                prop_assert_eq!(label == 7, inside(&polygon, x as f64, y as f64));
            }
        }
    }
}
