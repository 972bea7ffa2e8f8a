//! Files of stereo vision to planes, and back.
//!
//! This crate is the only one of the house that opens images and calibration files. Each format
//! is a module: `decode` and `encode` work on bytes, `read` and `write` on paths. What a file
//! means is settled here once and for all:
//!
//! - **Sign.** Files hold `d = x_left - x_right`, positive; the library holds `dx = -d`. The sign
//!   turns in [`file_sign`].
//! - **Unknown.** NaN in a plane, and in a file whatever its format says: `+inf` in a PFM, 0 in a
//!   KITTI PNG, 1e10 in a `.flo`.
//! - **Trust.** No header is believed with memory that the file's length does not bear out, and
//!   no bytes make a reader panic.
//! - **Whole or not at all.** A writer fills a temporary file beside its target and renames it.
//!
//! ```
//! use ndarray::array;
//! use stereo_formats::pfm;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("disparity.pfm");
//!
//! // Disparities in the sign of files; the second pixel is unknown.
//! let d = array![[4.0, f32::NAN], [4.5, 5.0]];
//! pfm::write(&path, d.view())?;
//! let back = pfm::read(&path)?;
//! assert_eq!(back[[1, 0]], 4.5);
//! assert!(back[[0, 1]].is_nan());
//!
//! // An error names the file, what is wrong with it, and where.
//! std::fs::write(&path, "Pf\n2 2\n-1.0\n")?;
//! let error = pfm::read(&path).unwrap_err().to_string();
//! assert!(error.ends_with("2 x 2 pixels, 4 bytes each, and 0 bytes follow it; \
//!                          the file is cut short or damaged"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera_matrix;
mod file;
mod raster;
mod tiff_directory;
mod toml_text;
mod vector_planes;
mod yaml_text;

pub mod code_luma;
pub mod colour;
pub mod contact_sheet;
pub mod depth_png;
pub mod file_sign;
pub mod flo;
pub mod flow_picture;
pub mod hue;
pub mod kalibr;
pub mod kitti_png;
pub mod label_png;
pub mod label_polygons;
pub mod mask_png;
pub mod middlebury_calib;
pub mod middlebury_png;
pub mod names;
pub mod npy;
pub mod opencv_storage;
pub mod pfm;
pub mod picture;
pub mod ply;
pub mod points;
pub mod rig_toml;
pub mod ros_camera_info;
pub mod scale_bar;
pub mod scene_folder;
pub mod scene_toml;
pub mod v1_picture;
pub mod validity_png;

pub use file::{LONGEST_FILE, Unreadable, Unwritable, replace};
pub use raster::{MOST_PIXELS, NotAPicture, NotAPng};
pub use toml_text::NotToml;
pub use vector_planes::{NotVectors, VectorPlanes};
pub use yaml_text::NotYaml;
