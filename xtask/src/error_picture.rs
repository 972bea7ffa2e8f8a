use std::path::{Path, PathBuf};

use anyhow::Context;
use disparity_pyramid::DisparityField;
use ndarray::{Array2, ArrayView2, Zip};
use stereo_formats::colour::{self, ColourRange};
use stereo_formats::{file_sign, picture, scale_bar};

/// The absolute error that gets the last colour, in pixels: the largest of the bad-k thresholds.
const HIGHEST_ERROR_PX: f32 = 4.0;

/// Writes what a scene looks like, its true and its estimated disparity, and the errors as
/// pictures into a folder of its own: `FOLDER/SCENE/left.png`, `truth.png`, `estimate.png`,
/// `estimate_dense.png`, `error.png`, `error_dense.png`. Unknown is grey.
pub(crate) fn write(
    folder: &Path,
    scene: &str,
    left: ArrayView2<'_, [u8; 3]>,
    truth: ArrayView2<'_, f32>,
    field: &DisparityField,
) -> anyhow::Result<()> {
    let folder: PathBuf = folder.join(scene);
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    picture::write_rgb(folder.join("left.png"), left)?;

    // Truth and estimates share one range, so that one colour is one disparity in all of them.
    let range = ColourRange::covering(truth);
    let errors_range = ColourRange::new(0.0, HIGHEST_ERROR_PX)?;
    let write = |name: &str, plane: ArrayView2<'_, f32>, range| {
        let painted = colour::paint(plane, range);
        let with_bar = scale_bar::beneath(painted.view(), range, "px");
        picture::write_rgb(folder.join(name), with_bar.view())
    };
    write("truth.png", truth, range)?;
    for (dense, suffix) in [(false, ""), (true, "_dense")] {
        let d = file_sign::d_of_field(field, dense);
        write(&format!("estimate{suffix}.png"), d.view(), range)?;
        let errors = absolute_errors(d.view(), truth);
        write(&format!("error{suffix}.png"), errors.view(), errors_range)?;
    }
    Ok(())
}

/// The absolute error of every pixel; NaN where estimate or truth is unknown.
fn absolute_errors(estimate: ArrayView2<'_, f32>, truth: ArrayView2<'_, f32>) -> Array2<f32> {
    Zip::from(estimate)
        .and(truth)
        .map_collect(|&estimate, &truth| (estimate - truth).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use disparity_pyramid::Validity;
    use ndarray::array;

    #[test]
    fn unknown_is_grey_and_a_larger_error_is_lighter() {
        let folder = tempfile::tempdir().unwrap();
        let shape = (1, 40);
        let truth = Array2::from_shape_fn(shape, |(_, x)| if x == 0 { f32::NAN } else { 5.0 });
        let dx = Array2::from_shape_fn(shape, |(_, x)| -5.0 - 0.1 * x as f32);
        let validity = Array2::from_shape_fn(shape, |(_, x)| {
            if x == 1 {
                Validity::Occluded
            } else {
                Validity::Valid
            }
        });
        let zeros = Array2::zeros(shape);
        let field = DisparityField::new(dx, zeros.clone(), zeros, validity).unwrap();
        let left = Array2::from_elem(shape, [9, 8, 7]);
        write(folder.path(), "plane", left.view(), truth.view(), &field).unwrap();

        let read = |name: &str| picture::read(folder.path().join("plane").join(name)).unwrap();
        assert_eq!(read("left.png").rgb()[[0, 5]], [9, 8, 7]);
        let errors = read("error.png");
        assert_eq!(errors.rgb()[[0, 0]], colour::UNKNOWN);
        assert_eq!(errors.rgb()[[0, 1]], colour::UNKNOWN);
        let dense = read("error_dense.png");
        assert_ne!(dense.rgb()[[0, 1]], colour::UNKNOWN);
        let luma = dense.luma().plane().to_owned();
        assert!(luma[[0, 10]] < luma[[0, 30]]);
        for name in ["truth.png", "estimate.png", "estimate_dense.png"] {
            assert_eq!(read(name).size().width, 40);
        }
    }

    #[test]
    fn an_error_needs_both() {
        let errors = absolute_errors(
            array![[1.0, f32::NAN, 2.0]].view(),
            array![[3.0, 1.0, f32::NAN]].view(),
        );
        assert_eq!(errors[[0, 0]], 2.0);
        assert!(errors[[0, 1]].is_nan() && errors[[0, 2]].is_nan());
    }
}
