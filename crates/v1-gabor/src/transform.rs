use ndarray::{Array2, Axis};
use num_complex::Complex32;
use rustfft::FftPlanner;

/// From samples to frequencies, or back.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Direction {
    Forward,
    Inverse,
}

/// The unnormalised two-dimensional Fourier transform of a plane, in place: every row, then every
/// column.
pub(crate) fn transform(plane: &mut Array2<Complex32>, direction: Direction) {
    let mut planner = FftPlanner::new();
    for axis in [Axis(1), Axis(0)] {
        let length = plane.len_of(axis);
        let fft = match direction {
            Direction::Forward => planner.plan_fft_forward(length),
            Direction::Inverse => planner.plan_fft_inverse(length),
        };
        let mut line = vec![Complex32::ZERO; length];
        for mut lane in plane.lanes_mut(axis) {
            for (sample, value) in line.iter_mut().zip(&lane) {
                *sample = *value;
            }
            fft.process(&mut line);
            for (value, sample) in lane.iter_mut().zip(&line) {
                *value = *sample;
            }
        }
    }
}
