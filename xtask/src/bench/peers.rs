use std::path::Path;

use anyhow::Context;
use v1_gabor::{Binocular, LumaImage};

use super::SHIFTS;
use super::pair::write_pair;
use crate::opencv_clock::OpencvClock;

/// OpenCV's matchers that search along rows, as the dense estimator does.
pub(super) const ALONG_ROWS: [&str; 3] = ["SGBM", "3WAY", "BM"];

/// OpenCV's matchers, ready for these pictures.
pub(super) fn start_peers(
    python: &Path,
    images: &Binocular<LumaImage>,
    threads: usize,
) -> anyhow::Result<OpencvClock> {
    let folder = tempfile::tempdir().context("there is no room for the pictures")?;
    let paths = write_pair(images, folder.path(), "pair")?;
    // The script has read the pictures when it has started.
    OpencvClock::start(python, (&paths.left, &paths.right), SHIFTS, threads)
}
