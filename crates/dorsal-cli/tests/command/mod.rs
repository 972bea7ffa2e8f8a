//! The built command, run as a user runs it.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use dorsal::v1_gabor::LumaImage;
use ndarray::Array2;
use stereo_formats::picture;
use tempfile::TempDir;

/// What the command said and how it ended.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// Runs `dorsal` with these arguments.
pub(crate) fn dorsal<A: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = A>) -> Said {
    let Output {
        status,
        stdout,
        stderr,
    } = Command::new(env!("CARGO_BIN_EXE_dorsal"))
        .args(arguments)
        .output()
        .expect("the command runs");
    Said {
        code: status.code(),
        out: String::from_utf8(stdout).expect("it speaks UTF-8"),
        err: String::from_utf8(stderr).expect("it speaks UTF-8"),
    }
}

/// Width and height of the synthetic pictures, in pixels.
pub(crate) const WIDTH: usize = 160;
pub(crate) const HEIGHT: usize = 120;
/// Their disparity in the sign of files, in pixels.
pub(crate) const D: f32 = 6.0;

/// A folder with `left.png` and `right.png`, a textured wall of disparity [`D`], and `rig.toml`,
/// for which that is a depth of 0.1 * 120 / 6 = 2 m.
pub(crate) struct Pair {
    folder: TempDir,
}

impl Pair {
    pub(crate) fn new() -> Self {
        Self::drawn(texture, D)
    }

    /// A wall of a disparity beyond what scales from zero reach, with a texture that looks nowhere as it
    /// does elsewhere.
    pub(crate) fn far(d: f32) -> Self {
        Self::drawn(many_waves, d)
    }

    fn drawn(texture: impl Fn(f32, f32) -> f32, d: f32) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, shift) in [("left.png", 0.0), ("right.png", d)] {
            let plane = Array2::from_shape_fn((HEIGHT, WIDTH), |(y, x)| {
                0.5 + 0.1 * texture(x as f32 + shift, y as f32)
            });
            let image = LumaImage::new(plane).expect("finite samples");
            picture::write_luma(folder.path().join(name), &image).expect("a PNG");
        }
        std::fs::write(
            folder.path().join("rig.toml"),
            "baseline_m = 0.1\n[left]\nfocal_px = 120.0\nprincipal_point_px = [79.5, 59.5]\n",
        )
        .expect("a rig");
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs `dorsal look` on the pair into the folder `out`, with further arguments; a name that
    /// begins with `@` is one of a file of the folder.
    pub(crate) fn look(&self, further: &[&str]) -> Said {
        let named = |argument: &&str| {
            let name = argument.strip_prefix('@');
            name.map_or_else(|| PathBuf::from(argument), |name| self.path(name))
        };
        let fixed = ["look", "@left.png", "@right.png", "--out", "@out"];
        dorsal(fixed.iter().chain(further).map(named))
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }
}

/// Waves of several lengths in several directions: every orientation hears something.
fn texture(x: f32, y: f32) -> f32 {
    (0.9 * x + 0.4 * y).sin()
        + (0.21 * x).sin()
        + (0.13 * y).cos()
        + (0.5 * x - 0.7 * y).cos()
        + (0.07 * x + 0.05 * y).sin()
}

/// Forty waves, no two of one length or one direction.
fn many_waves(x: f32, y: f32) -> f32 {
    let wave = |i: u8| {
        let i = f32::from(i);
        let (frequency, direction) = (0.08 + 0.035 * i, 2.4 * i);
        (frequency * (x * direction.cos() + y * direction.sin()) + 1.7 * i * i).sin()
    };
    0.3 * (1..=40).map(wave).sum::<f32>()
}
