use serde::Serialize;
use v1_gabor::Responses;

/// What decides how well phases of one scale tell disparities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct PhaseStatistics {
    /// Mean of the phase gradient along the wave vector over the peak frequency, over the responses
    /// that are heard. A disparity read with the peak frequency is this many times the true one.
    pub(crate) frequency_ratio: f64,
    /// Standard deviation of the same, between its 5th and its 95th percentile.
    pub(crate) frequency_spread: f64,
    /// Part of the heard responses whose phase gradient leaves the wave vector by more than 40 % of
    /// the peak frequency: no family's band, one bound for all.
    pub(crate) unstable: f64,
    /// Part of the pixels at which three orientations or more are heard.
    pub(crate) heard: f64,
}

/// The widest departure from the wave vector that counts as stable, over the peak frequency.
const STABLE: f64 = 0.4;

impl PhaseStatistics {
    /// Of one scale of responses; `threshold` is the energy from which a response is heard. `None`
    /// if none is.
    pub(crate) fn of(responses: &Responses, threshold: f32) -> Option<Self> {
        let params = responses.params();
        let omega = f64::from(params.peak_frequency);
        let size = responses.size();
        let mut ratios = Vec::new();
        let mut unstable = 0usize;
        for (q, wave) in params.wave_vectors().into_iter().enumerate() {
            let (kx, ky) = (f64::from(wave.x), f64::from(wave.y));
            let frequency = responses.instantaneous_frequency(q);
            for ((y, x), &along_x) in frequency.along_x.indexed_iter() {
                if responses.at(q, x, y).norm_sqr() > threshold {
                    let (fx, fy) = (f64::from(along_x), f64::from(frequency.along_y[[y, x]]));
                    ratios.push((fx * kx + fy * ky) / (omega * omega));
                    unstable += usize::from((fx - kx).hypot(fy - ky) > STABLE * omega);
                }
            }
        }
        let heard = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
        let heard = heard.filter(|&(x, y)| {
            let orientations = 0..params.orientations;
            let loud = orientations.filter(|&q| responses.at(q, x, y).norm_sqr() > threshold);
            loud.count() >= 3
        });
        let heard = heard.count() as f64 / size.area() as f64;
        let count = ratios.len();
        ratios.sort_unstable_by(f64::total_cmp);
        // Near singularities the gradient is anything: the outermost twentieths are left out.
        let inner = ratios.get(count / 20..count - count / 20)?;
        if inner.is_empty() {
            return None;
        }
        let mean = |of: &dyn Fn(f64) -> f64| {
            inner.iter().map(|&ratio| of(ratio)).sum::<f64>() / inner.len() as f64
        };
        let frequency_ratio = mean(&|ratio| ratio);
        Some(Self {
            frequency_ratio,
            frequency_spread: mean(&|ratio| (ratio - frequency_ratio).powi(2)).sqrt(),
            unstable: unstable as f64 / count as f64,
            heard,
        })
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

    use super::*;

    #[test]
    fn a_slow_grating_turns_slowly() {
        let size = Size {
            width: 64,
            height: 64,
        };
        let params = GaborParams {
            scales: 1,
            ..GaborParams::default()
        };
        let bank = FilterBank::plan(params, size).unwrap();
        let respond = |luma: &dyn Fn(f32) -> f32| {
            let plane = Array2::from_shape_fn(size.dim(), |(_, x)| luma(x as f32));
            bank.respond(&LumaImage::new(plane).unwrap()).unwrap()
        };
        let slow = 0.8 * params.peak_frequency;
        let seen = respond(&|x| 0.5 + 0.3 * (slow * x).cos());
        // Its energy is 0.0137 in orientation 0 and 0.003 in the neighbours: the first alone is heard.
        let told = PhaseStatistics::of(&seen.scales()[0], 6e-3).unwrap();
        assert!((told.frequency_ratio - 0.8).abs() < 0.04, "{told:?}");
        assert!(told.unstable < 0.1, "{told:?}");
        assert_eq!(
            PhaseStatistics::of(&respond(&|_| 0.5).scales()[0], 1e-6),
            None
        );
    }
}
