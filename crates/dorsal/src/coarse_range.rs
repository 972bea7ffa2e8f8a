use disparity_pyramid::{DenseMatcher, DenseParams, EyeView, SearchRange};
use ndarray::{Array2, s};
use v1_gabor::{Binocular, LumaImage};

use crate::Error;

/// How many pixels of the images, along either side, make one of the coarse look.
const SHRINK: usize = 4;

/// The shifts that a dense look at a quarter of the size finds among all that the images allow.
///
/// A table that slants away below the eyes has hardly an answer from the vector pyramid, whose filters have
/// one shape for both eyes, so a range that covers that field's answers ends before the table does. Pixels
/// are compared one by one here, over shifts up to half of the width either way. `None` if nothing is seen,
/// or the images are too small to tell.
pub(crate) fn coarse_range(eyes: &Binocular<EyeView<'_>>) -> Result<Option<SearchRange>, Error> {
    let size = eyes.left.luma.size();
    if size.width.min(size.height) < 32 * SHRINK {
        return Ok(None);
    }
    let small = eyes.try_map(|eye| shrunk(eye.luma))?;
    let views = small.as_ref().map(EyeView::grey);
    let params = DenseParams {
        narrow_px: None,
        ..DenseParams::fast()
    };
    let reach = i32::try_from(size.width / SHRINK / 2).unwrap_or(i32::MAX);
    let search = SearchRange::new(-reach, reach)?;
    let field = DenseMatcher::plan(params, small.left.size())?.estimate(&views, search)?;
    let shrink = SHRINK as i32;
    let Some(found) = SearchRange::covering(&field) else {
        return Ok(None);
    };
    let whole = SearchRange::new(shrink * found.least_dx(), shrink * found.most_dx())?;
    Ok(Some(whole))
}

/// The mean of every block of pixels.
fn shrunk(luma: &LumaImage) -> Result<LumaImage, Error> {
    let plane = luma.plane();
    let (height, width) = (plane.nrows() / SHRINK, plane.ncols() / SHRINK);
    let part = 1.0 / (SHRINK * SHRINK) as f32;
    let small = Array2::from_shape_fn((height, width), |(y, x)| {
        let rows = SHRINK * y..SHRINK * (y + 1);
        let columns = SHRINK * x..SHRINK * (x + 1);
        part * plane.slice(s![rows, columns]).sum()
    });
    Ok(LumaImage::new(small)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of any grey, as large as what the coarse look can see, moved by `shift` along their row.
    fn dots(shift: impl Fn(usize) -> i32) -> LumaImage {
        let plane = Array2::from_shape_fn((256, 512), |(y, x)| {
            let x = (x as i32 - shift(y)).rem_euclid(512) as u32;
            let cell = (y as u32 / 8) * 64 + x / 8;
            let mixed = cell.wrapping_mul(0x9E37_79B9) ^ (cell.wrapping_mul(0x85EB_CA6B) >> 13);
            (mixed >> 16 & 0xFF) as f32 / 255.0
        });
        LumaImage::new(plane).unwrap()
    }

    /// Shifts far to either side of zero are within the range.
    #[test]
    fn what_is_far_on_either_side_is_covered() {
        let left = dots(|_| 0);
        let right = dots(|y| if y < 128 { -80 } else { 60 });
        let eyes = Binocular {
            left: EyeView::grey(&left),
            right: EyeView::grey(&right),
        };
        let found = coarse_range(&eyes).unwrap().unwrap();
        assert!(
            found.least_dx() <= -80 && found.most_dx() >= 60,
            "{found:?}"
        );
    }
}
