use dorsal::disparity_pyramid::{DisparityField, MatchParams};
use dorsal::v1_gabor::GaborParams;
use serde::Serialize;

use crate::flow_arguments::FlowArguments;
use crate::look_record::{Counts, Filters, Matching};
use crate::outputs::FileName;
use crate::times::Times;

/// What `flow.json` says of the flow between two frames: schema `dorsal-flow/1`.
#[derive(Debug, Serialize)]
pub(crate) struct FlowRecord {
    schema: &'static str,
    version: &'static str,
    inputs: Inputs,
    width: usize,
    height: usize,
    dense: bool,
    gabor: Filters,
    matching: Matching,
    /// The part of the pixels that are valid.
    density: f64,
    /// Pixels by validity.
    pixels: Counts,
    /// Motion of the valid pixels; `None` if there are none.
    pub(crate) motion_px: Option<Motion>,
    threads: usize,
    time_ms: Times,
    /// The files beside this one.
    pub(crate) files: Vec<FileName>,
}

/// The two frames.
#[derive(Debug, Serialize)]
struct Inputs {
    prev: String,
    next: String,
}

/// How far valid pixels move, in pixels a frame.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Motion {
    /// Median along x, positive to the right.
    pub(crate) median_u: f32,
    /// Median along y, positive downwards.
    pub(crate) median_v: f32,
    /// Median speed.
    pub(crate) median_speed: f32,
    /// Largest speed.
    pub(crate) most_speed: f32,
}

impl FlowRecord {
    pub(crate) fn new(
        arguments: &FlowArguments,
        gabor: &GaborParams,
        matching: &MatchParams,
        field: &DisparityField,
        times: &Times,
    ) -> Self {
        Self {
            schema: "dorsal-flow/1",
            version: env!("CARGO_PKG_VERSION"),
            inputs: Inputs {
                prev: arguments.prev.display().to_string(),
                next: arguments.next.display().to_string(),
            },
            width: field.size().width,
            height: field.size().height,
            dense: arguments.dense,
            gabor: Filters::of(gabor),
            matching: Matching::of(matching),
            density: field.density(),
            pixels: Counts::of(field),
            motion_px: Motion::of(field),
            threads: rayon::current_num_threads(),
            time_ms: times.clone(),
            files: Vec::new(),
        }
    }
}

impl Motion {
    fn of(field: &DisparityField) -> Option<Self> {
        let known = |plane| {
            let known = field.only_valid(plane).into_iter();
            known
                .filter(|shift| shift.is_finite())
                .collect::<Vec<f32>>()
        };
        let (mut u, mut v) = (known(field.dx()), known(field.dy()));
        let mut speed: Vec<f32> = u.iter().zip(&v).map(|(u, v)| u.hypot(*v)).collect();
        let most_speed = speed.iter().copied().reduce(f32::max)?;
        Some(Self {
            median_u: median(&mut u),
            median_v: median(&mut v),
            median_speed: median(&mut speed),
            most_speed,
        })
    }
}

/// The middle one of numbers of which there is at least one.
fn median(numbers: &mut [f32]) -> f32 {
    let middle = numbers.len() / 2;
    *numbers.select_nth_unstable_by(middle, f32::total_cmp).1
}
