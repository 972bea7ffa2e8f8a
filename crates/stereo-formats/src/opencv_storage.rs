//! OpenCV's FileStorage, YAML or XML, as its stereo calibration sample writes it: `M1 D1 M2 D2` and
//! `R T`, in one file or in two.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egocentric_depth::{BadRig, Lens, NoRotation, RelativePose, Rotation, StereoRig};
use serde::Deserialize;
use serde::de::IgnoredAny;
use v1_gabor::{Binocular, Size};

use crate::camera_matrix;
use crate::file::{self, Unreadable, Unwritable};
use crate::rig_toml::{SizedRig, brown_conrady, brown_conrady_terms};
use crate::toml_text::{self, NotToml};
use crate::yaml_text::{self, NotYaml, Number, spell};

/// Why a text is no calibration of two cameras, or a rig goes into none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotAStorage {
    /// The bytes are no text.
    #[error(transparent)]
    Text(#[from] NotToml),
    /// The text is not the YAML that is read here.
    #[error(transparent)]
    Yaml(#[from] NotYaml),
    /// The text is no XML.
    #[error("line {line}: {what}")]
    Xml {
        /// The line, counted from 1.
        line: u32,
        /// What is wrong.
        what: String,
    },
    /// A matrix that must be there and is not.
    #[error("it has no {0}; a calibration has M1, D1, M2, D2, R and T, in one file or in two")]
    Missing(&'static str),
    /// A matrix that is not what its name needs.
    #[error("line {line}: {key} {what}")]
    Matrix {
        /// The line, counted from 1.
        line: usize,
        /// The name.
        key: String,
        /// What is wrong with it.
        what: String,
    },
    /// A length that is no unit.
    #[error("a unit of {0} m measures nothing; it must be positive and finite")]
    Unit(f64),
    /// The two lenses are of different models.
    #[error(
        "one lens is a fisheye and the other is not, and OpenCV's storage has one model for both; write a \
         rig.toml, ROS or Kalibr file"
    )]
    TwoModels,
    /// The numbers describe no rig.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

/// How the two kinds of storage are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `%YAML:1.0`.
    Yaml,
    /// `<opencv_storage>`.
    Xml,
}

/// What the field calls each matrix: the first name is OpenCV's own sample's.
const NAMES: [(&str, &[&str]); 6] = [
    (
        "M1",
        &["M1", "K1", "cameraMatrix1", "camera_matrix_1", "CM1"],
    ),
    ("D1", &["D1", "distCoeffs1", "dist_coeffs_1", "distortion1"]),
    (
        "M2",
        &["M2", "K2", "cameraMatrix2", "camera_matrix_2", "CM2"],
    ),
    ("D2", &["D2", "distCoeffs2", "dist_coeffs_2", "distortion2"]),
    ("R", &["R", "rotation"]),
    ("T", &["T", "translation"]),
];

/// The key that says that four coefficients are a fisheye's, where they may be.
const FISHEYE: &str = "fisheye";

/// A file of several named values.
#[derive(Default)]
struct Storage {
    matrices: BTreeMap<String, Matrix>,
    numbers: BTreeMap<String, f64>,
}

struct Matrix {
    rows: usize,
    cols: usize,
    numbers: Vec<f64>,
    line: usize,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Node {
    Matrix {
        rows: usize,
        cols: usize,
        data: Vec<Entry>,
    },
    Number(Number),
    Other(IgnoredAny),
}

/// An entry of a matrix, or what stands in its place.
#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(Number),
    Word(String),
}

/// Decodes a calibration from one file or several; a later one adds to those before. A unit of its
/// translation is `unit_m` long: OpenCV leaves it to the chessboard.
///
/// Four distortion coefficients are Brown's and Conrady's `k1 k2 p1 p2`, unless the storage has
/// `fisheye: 1`.
///
/// # Errors
/// [`NotAStorage`] says what is missing or wrong, and in which line.
pub fn decode(files: &[&[u8]], unit_m: f64) -> Result<SizedRig, NotAStorage> {
    let mut storage = Storage::default();
    for bytes in files {
        storage.add(Storage::of(bytes)?);
    }
    storage.rig(unit_m)
}

impl Storage {
    /// What one file holds.
    fn of(bytes: &[u8]) -> Result<Self, NotAStorage> {
        let mut storage = Self::default();
        let marked = toml_text::text(bytes)?.trim_start_matches('\u{feff}');
        if marked.trim_start().starts_with('<') {
            storage.add_xml(marked)?;
        } else {
            storage.add_yaml(bytes)?;
        }
        Ok(storage)
    }

    /// What a later file holds takes the place of what is there under the same name.
    fn add(&mut self, later: Self) {
        self.matrices.extend(later.matrices);
        self.numbers.extend(later.numbers);
    }

    fn add_yaml(&mut self, bytes: &[u8]) -> Result<(), NotAStorage> {
        let nodes: BTreeMap<String, Node> = yaml_text::decode(bytes)?;
        for (key, node) in nodes {
            match node {
                Node::Matrix { rows, cols, data } => {
                    let line = yaml_text::line_of(bytes, &[&key]);
                    let numbers = data.into_iter().map(|entry| match entry {
                        Entry::Number(number) => Ok(number.0),
                        Entry::Word(word) => Err(NotAStorage::Matrix {
                            line,
                            key: key.clone(),
                            what: format!("has '{word}', which is no number"),
                        }),
                    });
                    let numbers = numbers.collect::<Result<_, _>>()?;
                    let matrix = Matrix {
                        rows,
                        cols,
                        numbers,
                        line,
                    };
                    self.matrices.insert(key, matrix);
                }
                Node::Number(number) => {
                    self.numbers.insert(key, number.0);
                }
                Node::Other(_) => {}
            }
        }
        Ok(())
    }

    fn add_xml(&mut self, text: &str) -> Result<(), NotAStorage> {
        let document = roxmltree::Document::parse(text).map_err(|error| NotAStorage::Xml {
            line: error.pos().row,
            what: error.to_string(),
        })?;
        let root = document.root_element();
        for node in root.children().filter(roxmltree::Node::is_element) {
            let line = document.text_pos_at(node.range().start).row;
            let key = node.tag_name().name().to_owned();
            let child = |name: &str| {
                let found = node.children().find(|child| child.has_tag_name(name));
                found.and_then(|child| child.text()).map(str::trim)
            };
            if let (Some(rows), Some(cols), Some(data)) =
                (child("rows"), child("cols"), child("data"))
            {
                let wrong = |what: String| NotAStorage::Matrix {
                    line: line as usize,
                    key: key.clone(),
                    what,
                };
                let side = |word: &str| {
                    word.parse()
                        .map_err(|_| wrong(format!("has '{word}' rows or columns")))
                };
                let numbers: Result<Vec<f64>, NotAStorage> = data
                    .split_ascii_whitespace()
                    .map(|word| {
                        Number::spelt(word)
                            .ok_or_else(|| wrong(format!("has '{word}', which is no number")))
                    })
                    .collect();
                let matrix = Matrix {
                    rows: side(rows)?,
                    cols: side(cols)?,
                    numbers: numbers?,
                    line: line as usize,
                };
                self.matrices.insert(key, matrix);
            } else if let Some(number) = node.text().and_then(Number::spelt) {
                self.numbers.insert(key, number);
            }
        }
        Ok(())
    }

    fn matrix(&self, which: usize) -> Result<(&'static str, &Matrix), NotAStorage> {
        let (name, aliases) = NAMES[which];
        let found = aliases
            .iter()
            .find_map(|alias| Some((*alias, self.matrices.get(*alias)?)));
        let (alias, matrix) = found.ok_or(NotAStorage::Missing(name))?;
        let (rows, cols, found) = (matrix.rows, matrix.cols, matrix.numbers.len());
        if rows.checked_mul(cols) != Some(found) {
            let what = format!("has {found} numbers for {rows} x {cols}");
            return Err(matrix.wrong(alias, what));
        }
        match matrix.numbers.iter().find(|number| !number.is_finite()) {
            Some(number) => Err(matrix.wrong(alias, format!("has {number}, which is not finite"))),
            None => Ok((alias, matrix)),
        }
    }

    fn rig(&self, unit_m: f64) -> Result<SizedRig, NotAStorage> {
        if !(unit_m.is_finite() && unit_m > 0.0) {
            return Err(NotAStorage::Unit(unit_m));
        }
        let fisheye = self.numbers.get(FISHEYE).is_some_and(|&said| said != 0.0);
        let camera = |which: usize| {
            let (name, matrix) = self.matrix(which)?;
            camera_matrix::camera(&matrix.numbers).ok_or_else(|| {
                matrix.wrong(name, "is not [fx, 0, cx, 0, fy, cy, 0, 0, 1]".to_owned())
            })
        };
        let lens = |which: usize| {
            let (name, matrix) = self.matrix(which)?;
            let lens = match (fisheye, &matrix.numbers[..]) {
                (true, &[k1, k2, k3, k4]) => Some(Lens::Fisheye([k1, k2, k3, k4])),
                (true, _) => None,
                (false, terms) => brown_conrady(short(terms)),
            };
            lens.ok_or_else(|| {
                let terms = matrix.numbers.len();
                let read = if fisheye {
                    "4 of a fisheye"
                } else {
                    "4, 5 or 8"
                };
                matrix.wrong(name, format!("has {terms} coefficients; {read} are read"))
            })
        };
        let (r_name, r) = self.matrix(4)?;
        let rows = camera_matrix::rows(&r.numbers)
            .ok_or_else(|| r.wrong(r_name, "is not 3 x 3".to_owned()))?;
        let rotation = Rotation::from_matrix(rows)
            .map_err(|refused: NoRotation| r.wrong(r_name, format!("is none: {refused}")))?;
        let (t_name, t) = self.matrix(5)?;
        let &[x, y, z] = &t.numbers[..] else {
            return Err(t.wrong(t_name, "has not three numbers".to_owned()));
        };
        let pose = RelativePose {
            rotation,
            translation_m: [x, y, z].map(|units| units * unit_m),
        };
        let intrinsics = Binocular {
            left: camera(0)?,
            right: camera(2)?,
        };
        let lenses = Binocular {
            left: lens(1)?,
            right: lens(3)?,
        };
        let side = |key: &str| {
            let number = self.numbers.get(key).copied()?;
            (number >= 1.0 && number.fract() == 0.0).then_some(number as usize)
        };
        let size = side("image_width").zip(side("image_height"));
        Ok(SizedRig {
            rig: StereoRig::from_pose(intrinsics, &pose)?.with_lenses(lenses)?,
            size: size.map(|(width, height)| Size { width, height }),
        })
    }
}

/// The coefficients without the zeros that newer versions of OpenCV write for models that are not in
/// use: 12 or 14 numbers whose last are 0 are 8.
fn short(terms: &[f64]) -> &[f64] {
    match terms.len() {
        12 | 14 if terms[8..].iter().all(|term| *term == 0.0) => &terms[..8],
        _ => terms,
    }
}

impl Matrix {
    fn wrong(&self, key: &str, what: String) -> NotAStorage {
        NotAStorage::Matrix {
            line: self.line,
            key: key.to_owned(),
            what,
        }
    }
}

/// The storage of a rig, lengths in metres. The tilt of its head and what is uncertain of it have no
/// place in it.
///
/// # Errors
/// [`NotAStorage::TwoModels`] if one lens is a fisheye and the other is not.
pub fn encode(sized: &SizedRig, form: Form) -> Result<Vec<u8>, NotAStorage> {
    let (cameras, lenses) = (sized.rig.intrinsics(), sized.rig.lenses());
    let fisheye = lenses.map(|lens| matches!(lens, Lens::Fisheye(_)));
    if fisheye.left != fisheye.right {
        return Err(NotAStorage::TwoModels);
    }
    let pose = sized.rig.relative_pose();
    let terms = |lens: &Lens| match lens {
        Lens::Pinhole => vec![0.0; 5],
        Lens::BrownConrady(terms) => brown_conrady_terms(terms).to_vec(),
        Lens::Fisheye(terms) => terms.to_vec(),
    };
    let mut numbers = Vec::new();
    if let Some(size) = sized.size {
        numbers.push(("image_width", size.width));
        numbers.push(("image_height", size.height));
    }
    if fisheye.left {
        numbers.push((FISHEYE, 1));
    }
    let matrices = [
        ("M1", 3, camera_matrix::numbers(&cameras.left).to_vec()),
        ("D1", 1, terms(&lenses.left)),
        ("M2", 3, camera_matrix::numbers(&cameras.right).to_vec()),
        ("D2", 1, terms(&lenses.right)),
        ("R", 3, pose.rotation.matrix().as_flattened().to_vec()),
        ("T", 3, pose.translation_m.to_vec()),
    ];
    let mut text = String::new();
    match form {
        Form::Yaml => {
            text += "%YAML:1.0\n---\n";
            for (key, number) in numbers {
                text += &format!("{key}: {number}\n");
            }
            for (key, rows, data) in matrices {
                text += &format!(
                    "{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {}\n   dt: d\n   data: {}\n",
                    data.len() / rows,
                    yaml_text::spell_list(&data)
                );
            }
        }
        Form::Xml => {
            text += "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
            for (key, number) in numbers {
                text += &format!("<{key}>{number}</{key}>\n");
            }
            for (key, rows, data) in matrices {
                let words: Vec<String> = data.iter().map(|number| spell(*number)).collect();
                text += &format!(
                    "<{key} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  \
                     <cols>{}</cols>\n  <dt>d</dt>\n  <data>\n    {}</data></{key}>\n",
                    data.len() / rows,
                    words.join(" ")
                );
            }
            text += "</opencv_storage>\n";
        }
    }
    Ok(text.into_bytes())
}

/// Reads a calibration from one file, or from the two that OpenCV's sample writes; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it; what several lack together stands with the
/// first.
pub fn read(paths: &[PathBuf], unit_m: f64) -> Result<SizedRig, Unreadable<NotAStorage>> {
    let [first, ..] = paths else {
        return Err(Unreadable::Content {
            path: PathBuf::new(),
            cause: NotAStorage::Missing("M1"),
        });
    };
    let mut storage = Storage::default();
    let mut stands_in = BTreeMap::new();
    for path in paths {
        let part = file::read(path, Storage::of)?;
        stands_in.extend(part.matrices.keys().map(|key| (key.clone(), path)));
        storage.add(part);
    }
    storage.rig(unit_m).map_err(|cause| {
        let of_matrix = match &cause {
            NotAStorage::Matrix { key, .. } => stands_in.get(key).copied(),
            _ => None,
        };
        Unreadable::Content {
            path: of_matrix.unwrap_or(first).clone(),
            cause,
        }
    })
}

/// Writes a calibration, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    rig: &SizedRig,
    form: Form,
) -> Result<(), Unwritable<NotAStorage>> {
    file::write(path.as_ref(), encode(rig, form))
}
