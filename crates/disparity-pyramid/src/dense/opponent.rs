use ndarray::ArrayView2;
use v1_gabor::LumaImage;

/// How much redder than cyan a picture is, `1/2 + (R - (G + B) / 2) / 2`, in `[0, 1]` with the channels in
/// `[0, 1]`: one half where it is grey. It is the opponent colour that the retina tells first, and tells apart
/// what luma does not, such as an orange lamp before a blue wall of the same brightness.
///
/// # Panics
/// If the picture has no pixel; no eye has such a one.
pub(crate) fn opponent(rgb: ArrayView2<'_, [u8; 3]>) -> LumaImage {
    let samples = rgb.mapv(|[red, green, blue]| {
        let cyan = 0.5 * (f32::from(green) + f32::from(blue));
        0.5 + (f32::from(red) - cyan) * (0.5 / 255.0)
    });
    LumaImage::new(samples).expect("bytes are finite, and a picture has pixels")
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
        assert_eq!(
            opponent(rgb.view()).plane(),
            array![[0.5, 0.5, 0.5], [1.0, 0.0, 0.25]]
        );
    }
}
