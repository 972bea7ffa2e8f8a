use num_complex::Complex32;
use v1_gabor::{Responses, WaveVector};

/// The responses at a place `(x, y)` between pixels, inside the image, by orientation.
///
/// Each of the four neighbours is turned by the carrier's phase between it and the place before they
/// are weighed, as interpolation of a carrier itself is biased by up to 0.045 px. This is the plain
/// form of what [`Warp`](crate::warp::Warp) does for all pixels of an image.
pub(crate) fn between(
    responses: &Responses,
    waves: &[WaveVector],
    x: f32,
    y: f32,
) -> impl Iterator<Item = Complex32> {
    let size = responses.size();
    let (left, above) = (x as usize, y as usize);
    let neighbours = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
        let u = (left + i).min(size.width - 1);
        let v = (above + j).min(size.height - 1);
        let (far_x, far_y) = (x - (left + i) as f32, y - (above + j) as f32);
        let weight = (1.0 - far_x.abs()) * (1.0 - far_y.abs());
        (responses.pixel(u, v), weight, (far_x, far_y))
    });
    waves.iter().enumerate().map(move |(q, k)| {
        let parts = neighbours.iter().map(|(pixel, weight, (far_x, far_y))| {
            let response = Complex32::new(pixel.even[q], pixel.odd[q]);
            response * Complex32::from_polar(*weight, k.x * far_x + k.y * far_y)
        });
        parts.sum()
    })
}
