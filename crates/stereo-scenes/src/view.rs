use ndarray::{Array2, Array3, Axis};
use v1_gabor::{Binocular, LumaImage, NotAnImage};

use crate::{
    exposure::{Exposure, disturb, expose},
    gaze::Gaze,
    room::Room,
    stage::Stage,
    truth::Truth,
};

/// What a head sees of a room, and what is so.
#[derive(Clone, Debug)]
pub struct View {
    /// Grey images (Rec. 601 weights of `colour`), in `[0, 1]` without noise and gain.
    pub images: Binocular<LumaImage>,
    /// Colour images `[[y, x, channel]]`: red, green, blue.
    pub colour: Binocular<Array3<f32>>,
    /// The truth of every pixel of the left image, and of the objects.
    pub truth: Truth,
}

/// Why a head sees no room.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoView {
    /// An eye is outside of the walls, or in one.
    #[error("an eye at {eye_m:?} m is not inside the room, which ends at 0 and {size_m:?} m")]
    Outside {
        /// Place of the eye, in the room frame.
        eye_m: [f64; 3],
        /// The room's largest coordinates.
        size_m: [f64; 3],
    },
    /// No rays, or too many.
    #[error("{0} samples along a side of a pixel; it must be 1 to 16")]
    Samples(usize),
    /// Noise below zero, a gain that is not positive, or one of them no number.
    #[error("noise of sigma {sigma} and a gain of {gain}: sigma must be at least 0, gain positive")]
    Exposure {
        /// Standard deviation of the noise.
        sigma: f32,
        /// Gain of the right eye.
        gain: f32,
    },
    /// Noise or gain so large that a sample is no number any more.
    #[error(transparent)]
    Image(#[from] NotAnImage),
}

/// Casts the rays of both eyes into a room.
///
/// The same arguments give the same bits, whatever the number of threads of the caller's pool.
///
/// # Errors
/// [`NoView`] if an eye is not inside the walls, or the exposure is not possible.
pub fn render(room: &Room, gaze: &Gaze, exposure: Exposure) -> Result<View, NoView> {
    let Exposure {
        samples,
        noise_sigma: sigma,
        noise_seed: seed,
        right_gain: gain,
    } = exposure;
    if !(1..=16).contains(&samples) {
        return Err(NoView::Samples(samples));
    }
    if !(sigma.is_finite() && sigma >= 0.0 && gain.is_finite() && gain > 0.0) {
        return Err(NoView::Exposure { sigma, gain });
    }
    let stage = Stage::new(room, gaze);
    let eyes = gaze.eyes();
    for eye in [&eyes.left, &eyes.right] {
        if !stage.holds(eye.origin()) {
            return Err(NoView::Outside {
                eye_m: eye.origin().to_array(),
                size_m: room.size_m(),
            });
        }
    }
    let mut colour = eyes.map(|eye| expose(&stage, &eye, samples));
    disturb(&mut colour.left, 1.0, sigma, seed);
    // The eyes are two sensors: their noise has nothing in common.
    disturb(&mut colour.right, gain, sigma, !seed);
    Ok(View {
        images: colour
            .as_ref()
            .try_map(|colour| LumaImage::new(luma(colour)))?,
        colour,
        truth: Truth::of(room, &stage, gaze),
    })
}

/// Grey of a colour image, with the weights of ITU-R Rec. 601.
fn luma(colour: &Array3<f32>) -> Array2<f32> {
    colour.map_axis(Axis(2), |rgb| {
        0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]
    })
}
