//! What a workspace of the dense estimator has been used for does not show.
use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, SearchRange,
};
use ndarray::Array2;
use v1_gabor::{Binocular, LumaImage, Size};

/// Dots, moved by a shift that differs from one half of the image to the other.
fn pair(size: Size, near: usize) -> Binocular<LumaImage> {
    let see = |eye: usize| {
        let luma = |(y, x): (usize, usize)| {
            let shift = if 2 * x < size.width { 5 } else { near };
            let (x, y) = ((x + eye * shift + y / 9) as u64, y as u64);
            let hash = (x ^ y << 20).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (hash >> 40) as f32 / (1u64 << 24) as f32
        };
        LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).expect("finite samples")
    };
    Binocular {
        left: see(0),
        right: see(1),
    }
}

/// Pairs of several sizes and ranges, in turn, for both presets.
#[test]
fn a_dense_workspace_forgets() {
    let mut workspace = DenseWorkspace::new();
    let mut field = DisparityField::default();
    for (width, height, near, most, best) in [
        (90, 40, 12, 30, false),
        (61, 70, 9, 17, true),
        (90, 40, 16, 40, true),
        (90, 40, 16, 40, false),
        (12, 9, 5, 8, false),
        (90, 40, 12, 30, false),
    ] {
        let size = Size { width, height };
        let eyes = pair(size, near);
        let views = eyes.as_ref().map(EyeView::grey);
        let params = if best {
            DenseParams::best()
        } else {
            DenseParams::fast()
        };
        let matcher = DenseMatcher::plan(params, size).expect("a plan");
        let search = SearchRange::new(-most, 3).expect("a range");
        matcher
            .estimate_into(&views, search, &mut workspace, &mut field)
            .expect("a field");
        let alone = matcher.estimate(&views, search).expect("a field");
        assert!(alone == field, "{size} up to {most} px");
    }
}
