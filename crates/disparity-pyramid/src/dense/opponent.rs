use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::{LumaImage, Size};

/// Writes how much redder than cyan a picture is, `1/2 + (R - (G + B) / 2) / 2`, in `[0, 1]` with the channels
/// in `[0, 1]`: one half where it is grey. It is the opponent colour that the retina tells first, and tells
/// apart what luma does not, such as an orange lamp before a blue wall of the same brightness.
pub(crate) fn write_opponent(rgb: ArrayView2<'_, [u8; 3]>, picture: &mut Option<LumaImage>) {
    let size = Size::of_dim(rgb.dim());
    let write = |plane: &mut Array2<f32>| {
        Zip::from(plane)
            .and(rgb)
            .for_each(|sample, [red, green, blue]| {
                let cyan = 0.5 * (f32::from(*green) + f32::from(*blue));
                *sample = 0.5 + (f32::from(*red) - cyan) * (0.5 / 255.0);
            });
    };
    let held = match picture.take() {
        Some(mut held) => held.write_over(size, write).map(|()| held),
        None => {
            let mut plane = Array2::zeros(rgb.dim());
            write(&mut plane);
            LumaImage::new(plane)
        }
    };
    // Bytes are finite, and a picture without a pixel has no opponent either.
    *picture = held.ok();
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    /// Greys have none, red and cyan lie at the ends.
    #[test]
    fn greys_are_half_way() {
        let rgb = array![
            [[0; 3], [255; 3], [77; 3]],
            [[255, 0, 0], [0, 255, 255], [0, 255, 0]]
        ];
        let mut picture = None;
        write_opponent(rgb.view(), &mut picture);
        let picture = picture.expect("finite samples");
        assert_eq!(picture.plane(), array![[0.5, 0.5, 0.5], [1.0, 0.0, 0.25]]);
    }
}
