use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, SearchRange,
};
use ndarray::{Array2, s};
use v1_gabor::{Binocular, LumaImage, Size};

use crate::Error;

/// How many pixels of the images, along either side, make one of the coarse look.
const SHRINK: usize = 4;

/// A dense look at a quarter of the size, planned and kept from pair to pair: the shifts that it finds among
/// all that the images allow.
///
/// A table that slants away below the eyes has hardly an answer from the vector pyramid, whose filters have
/// one shape for both eyes, so a range that covers that field's answers ends before the table does. Pixels
/// are compared one by one here, over shifts up to half of the width either way.
#[derive(Clone, Debug)]
pub(crate) struct CoarseLook {
    size: Size,
    search: SearchRange,
    small: Binocular<LumaImage>,
    matcher: DenseMatcher,
    workspace: DenseWorkspace,
    field: DisparityField,
    valid: Vec<f32>,
}

impl CoarseLook {
    /// Plans it for images of a size; `None` if they are too small to tell anything.
    pub(crate) fn plan(size: Size) -> Result<Option<Self>, Error> {
        if size.width.min(size.height) < 32 * SHRINK {
            return Ok(None);
        }
        let small = Size {
            width: size.width / SHRINK,
            height: size.height / SHRINK,
        };
        let params = DenseParams {
            narrow_px: None,
            ..DenseParams::fast()
        };
        let reach = i32::try_from(size.width / SHRINK / 2).unwrap_or(i32::MAX);
        let black = LumaImage::new(Array2::zeros(small.dim()))?;
        Ok(Some(Self {
            size,
            search: SearchRange::new(-reach, reach)?,
            small: Binocular {
                left: black.clone(),
                right: black,
            },
            matcher: DenseMatcher::plan(params, small)?,
            workspace: DenseWorkspace::new(),
            field: DisparityField::default(),
            valid: Vec::new(),
        }))
    }

    /// The size of the images.
    pub(crate) const fn size(&self) -> Size {
        self.size
    }

    /// The shifts of a pair; `None` if nothing is seen.
    pub(crate) fn range(
        &mut self,
        eyes: &Binocular<EyeView<'_>>,
    ) -> Result<Option<SearchRange>, Error> {
        shrink(eyes.left.luma, &mut self.small.left)?;
        shrink(eyes.right.luma, &mut self.small.right)?;
        self.matcher.estimate_into(
            &self.small.as_ref().map(EyeView::grey),
            self.search,
            &mut self.workspace,
            &mut self.field,
        )?;
        let shrink = SHRINK as i32;
        let Some(found) = SearchRange::covering_in(&self.field, &mut self.valid) else {
            return Ok(None);
        };
        let whole = SearchRange::new(shrink * found.least_dx(), shrink * found.most_dx())?;
        Ok(Some(whole))
    }
}

/// The mean of every block of pixels.
fn shrink(luma: &LumaImage, small: &mut LumaImage) -> Result<(), Error> {
    let plane = luma.plane();
    let part = 1.0 / (SHRINK * SHRINK) as f32;
    small.write_over(small.size(), |small| {
        for ((y, x), mean) in small.indexed_iter_mut() {
            let rows = SHRINK * y..SHRINK * (y + 1);
            let columns = SHRINK * x..SHRINK * (x + 1);
            *mean = part * plane.slice(s![rows, columns]).sum();
        }
    })?;
    Ok(())
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
        let mut look = CoarseLook::plan(left.size()).unwrap().unwrap();
        let found = look.range(&eyes).unwrap().unwrap();
        assert!(
            found.least_dx() <= -80 && found.most_dx() >= 60,
            "{found:?}"
        );
    }
}
