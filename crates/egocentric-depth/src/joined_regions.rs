use ndarray::{Array2, ArrayView2};

use crate::appearance::Contrast;
use crate::grown_regions::Ground;

/// What holds neighbours together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joints<'a> {
    /// The inverse depth of every pixel, as pixels of disparity; NaN where unknown.
    pub(crate) parallax_px: ArrayView2<'a, f32>,
    pub(crate) contrast: &'a Contrast,
    /// The parallax at a depth of one metre, px.
    pub(crate) of_a_metre_px: f32,
    pub(crate) gap_m: f32,
    pub(crate) step_px: f32,
    pub(crate) colour_step: f32,
}

impl Joints<'_> {
    /// How much a change of colour weighs between two pixels: 1 for none, 2 for one colour step.
    pub(crate) fn weight(&self, from: (usize, usize), to: (usize, usize)) -> f32 {
        1.0 + self.contrast.across(from, to) / self.colour_step
    }

    /// The step of parallax that a surface may take at one: a gap in metres, or what disparities are wrong
    /// by where that is more.
    pub(crate) fn most_step_px(&self, parallax_px: f32) -> f32 {
        let gap_px = self.gap_m * parallax_px * parallax_px / self.of_a_metre_px;
        gap_px.max(self.step_px)
    }

    /// Whether two pixels of known depth may belong to one surface. Colours alone never part them: a
    /// surface may be painted in many.
    fn hold(&self, from: (usize, usize), to: (usize, usize)) -> bool {
        let here = self.parallax_px[[from.1, from.0]];
        let step = (self.parallax_px[[to.1, to.0]] - here).abs();
        let most = self.most_step_px(here);
        step <= most && step * self.weight(from, to) <= most
    }
}

/// How far a region reaches over a gap, in pixels: single depths are missing everywhere.
const GAP: usize = 2;

/// The connected regions of what is above the ground, numbered from 1; 0 for all else.
pub(crate) fn join(ground: &Array2<Ground>, joints: &Joints<'_>) -> Array2<u32> {
    let (height, width) = ground.dim();
    let mut parent: Vec<u32> = (0..(height * width) as u32).collect();
    let above = |x: usize, y: usize| ground[[y, x]] == Ground::Above;
    for y in 0..height {
        for x in (0..width).filter(|&x| above(x, y)) {
            let here = (y * width + x) as u32;
            for step in 1..=GAP {
                for (to_x, to_y) in [(x + step, y), (x, y + step)] {
                    if to_x < width
                        && to_y < height
                        && above(to_x, to_y)
                        && joints.hold((x, y), (to_x, to_y))
                    {
                        unite(&mut parent, here, (to_y * width + to_x) as u32);
                    }
                }
            }
        }
    }
    let mut number = vec![0u32; height * width];
    let mut most = 0;
    Array2::from_shape_fn((height, width), |(y, x)| {
        if !above(x, y) {
            return 0;
        }
        let root = root(&mut parent, (y * width + x) as u32) as usize;
        if number[root] == 0 {
            most += 1;
            number[root] = most;
        }
        number[root]
    })
}

/// The pixel that stands for the region of another; paths to it are halved on the way.
fn root(parent: &mut [u32], mut at: u32) -> u32 {
    while parent[at as usize] != at {
        parent[at as usize] = parent[parent[at as usize] as usize];
        at = parent[at as usize];
    }
    at
}

/// Makes one region of two; the earlier pixel stands for it.
fn unite(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}
