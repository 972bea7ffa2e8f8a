use std::f32::consts::FRAC_PI_2;
use std::ops::Range;

use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce, Scalar};
use v1_gabor::WaveVector;
use v1_gabor::machine::Machine;

use crate::Validity;
use crate::dense::nearest::{ROUNDER, nearest, place};
use crate::phase::{angle, cosine, wrap};
use crate::rough::Rough;
use crate::vector::{store, vector};

/// The most that the phase may move a shift, in pixels: what is left of a whole pixel after the
/// parabola.
pub(crate) const MOST_STEP_PX: f32 = 0.4;

/// Beyond this a step is not told any more exactly, in pixels.
const FAR_STEP_PX: f32 = 4.0;

/// Least agreement of the phases with the shift that they give together.
pub(crate) const LEAST_COHERENCE: f32 = 0.5;

/// Largest difference of shifts within 5 x 5 pixels, in pixels: across the end of a surface a filter
/// sees both sides, and its phase is neither's.
pub(crate) const MOST_RANGE_PX: f32 = 1.5;

/// Most banks that are asked together.
pub(crate) const MOST_BANKS: usize = 2;

/// Most orientations of a bank.
pub(crate) const MOST_ORIENTATIONS: usize = 8;

/// At least the lanes of the widest vector there is.
pub(crate) const MOST_LANES: usize = 16;

/// Pixels and parts that are turned together.
pub(crate) const SQUARE: usize = 8;

/// Where a shift may move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gates<'a> {
    /// Largest difference of shifts around, in pixels.
    pub(crate) ranges: &'a Array2<f32>,
    pub(crate) validity: &'a Array2<Validity>,
}

impl<'a> Gates<'a> {
    /// Those of one row.
    pub(crate) fn row(&self, y: usize) -> (&'a [f32], &'a [Validity]) {
        let width = self.ranges.ncols();
        let pixels = y * width..(y + 1) * width;
        match (self.ranges.as_slice(), self.validity.as_slice()) {
            (Some(ranges), Some(validity)) => (&ranges[pixels.clone()], &validity[pixels]),
            _ => unreachable!("planes are made in row-major order"),
        }
    }
}

/// What both eyes' phases along one row are read from.
pub(crate) trait PhaseSource {
    /// The wave vectors, by orientation.
    fn waves(&self) -> &[WaveVector];

    /// Reads what both eyes say of a few pixels of a row: the left one there, the right one where the
    /// shifts lead to; what is out of view answers nothing.
    fn read<M: Machine<SQUARE>>(
        &self,
        machine: M,
        pixels: &Range<usize>,
        width: usize,
        block: &mut Block,
    );

    /// How much the product of both eyes' responses at an orientation counts: `squared` is its squared
    /// modulus, `energy` the sum of the responses' own.
    fn weight<S: Rough>(&self, simd: S, squared: S::f32s, energy: S::f32s) -> S::f32s;
}

/// One row of pixels, of which as many as a vector holds are asked side by side.
///
/// With `z = Q_R(x + round dx) conj Q_L(x)` and `ph = arg z + w_x (dx - round dx)` (the phase grows
/// along x, and the right eye's is read `dx` further on) and weights `W`, the shift still to add is
/// `-sum W w_x ph / sum W w_x^2`, over the orientations of all sources. Only answers move, and only where
/// the gates say that one surface is seen: without them the step hurts at the ends of surfaces. How well
/// the phases agree with it is the `coherence`, from -1 to 1, 0 where nothing is heard.
pub(crate) struct Row<'a, P> {
    /// At most [`MOST_BANKS`] are asked.
    pub(crate) sources: &'a [P],
    pub(crate) dx: &'a mut [f32],
    pub(crate) coherence: &'a mut [f32],
    pub(crate) ranges: &'a [f32],
    pub(crate) validity: &'a [Validity],
}

impl<P: PhaseSource> Row<'_, P> {
    /// Moves each shift by what the phases still differ there (hyperacuity), in the machine's vectors.
    pub(crate) fn sharpen(self) {
        match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(v4) => v4.vectorize(Compiled(self, v4, *v4)),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(v3) => v3.vectorize(Compiled(self, v3, v3)),
            _ => Compiled(self, Scalar, Scalar).call(),
        }
    }

    #[inline(always)]
    fn walk<S: Rough, M: Machine<SQUARE>>(self, simd: S, machine: M) {
        let mut block = Block::default();
        let width = self.dx.len();
        for start in (0..width).step_by(MOST_LANES) {
            let pixels = start..(start + MOST_LANES).min(width);
            block.dx = lanes(&self.dx[pixels.clone()], 0.0);
            block.hear(simd, machine, self.sources, (pixels.clone(), width));
            for lane in (0..MOST_LANES).step_by(S::F32_LANES) {
                block.agree(simd, lane, self.sources);
            }
            let dx = &mut self.dx[pixels.clone()];
            let coherences = &mut self.coherence[pixels.clone()];
            let validity = &self.validity[pixels.clone()];
            let ranges = &self.ranges[pixels];
            for i in 0..dx.len().min(MOST_LANES) {
                let (step, coherence) = (block.steps[i], block.coherences[i]);
                let takes = validity[i].is_valid()
                    & (ranges[i] < MOST_RANGE_PX)
                    & (coherence > LEAST_COHERENCE)
                    & (step.abs() < MOST_STEP_PX);
                coherences[i] = coherence;
                dx[i] += if takes { step } else { 0.0 };
            }
        }
    }
}

/// A few values, and nothing in the lanes beyond them. Where there are as many as lanes, their number is
/// known to the compiler, and they are copied at once.
#[inline(always)]
pub(crate) fn lanes<T: Copy>(values: &[T], nothing: T) -> [T; MOST_LANES] {
    if let Some(values) = values.first_chunk() {
        return *values;
    }
    let mut lanes = [nothing; MOST_LANES];
    lanes[..values.len()].copy_from_slice(values);
    lanes
}

/// One row's work, compiled for one machine.
struct Compiled<'a, P, S, M>(Row<'a, P>, S, M);

impl<P: PhaseSource, S: Rough, M: Machine<SQUARE>> NullaryFnOnce for Compiled<'_, P, S, M> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Self(row, simd, machine) = self;
        row.walk(simd, machine);
    }
}

/// What is known of a few neighbouring pixels, lane by lane.
pub(crate) struct Block {
    /// The shifts, in pixels.
    pub(crate) dx: [f32; MOST_LANES],
    /// Even and odd parts of each orientation of both eyes, the right ones at the shifted pixel.
    pub(crate) left: [[f32; MOST_LANES]; 2 * MOST_ORIENTATIONS],
    pub(crate) right: [[f32; MOST_LANES]; 2 * MOST_ORIENTATIONS],
    /// Phases and weights of all orientations of all sources.
    phases: [[f32; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
    weights: [[f32; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
    /// The shifts that the phases still ask for, in pixels, and how well they agree with them.
    steps: [f32; MOST_LANES],
    coherences: [f32; MOST_LANES],
}

impl Default for Block {
    fn default() -> Self {
        Self {
            dx: [0.0; MOST_LANES],
            left: [[0.0; MOST_LANES]; 2 * MOST_ORIENTATIONS],
            right: [[0.0; MOST_LANES]; 2 * MOST_ORIENTATIONS],
            phases: [[0.0; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
            weights: [[0.0; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
            steps: [0.0; MOST_LANES],
            coherences: [0.0; MOST_LANES],
        }
    }
}

impl Block {
    /// Where each pixel's shift leads, beyond the end of every row if it is out of view.
    #[inline(always)]
    pub(crate) fn seen(&self, pixels: &Range<usize>) -> [usize; MOST_LANES] {
        let mut seen = [usize::MAX; MOST_LANES];
        let first = pixels.start as f32;
        for lane in 0..MOST_LANES {
            seen[lane] = place(first + lane as f32 + nearest(self.dx[lane]));
        }
        for beyond in &mut seen[pixels.len()..] {
            *beyond = usize::MAX;
        }
        seen
    }

    /// The phases and the weights of all orientations of all sources at a few pixels of a row.
    #[inline(always)]
    fn hear<P: PhaseSource, S: Rough, M: Machine<SQUARE>>(
        &mut self,
        simd: S,
        machine: M,
        sources: &[P],
        (pixels, width): (Range<usize>, usize),
    ) {
        let splat = |value| simd.splat_f32s(value);
        let (zero, tiny) = (splat(0.0), splat(f32::MIN_POSITIVE));
        let rounder = splat(ROUNDER);
        let two = |a, b, c, d| simd.mul_add_e_f32s(a, b, simd.mul_f32s(c, d));
        let mut channel = 0;
        for source in sources.iter().take(MOST_BANKS) {
            source.read(machine, &pixels, width, self);
            let waves = source.waves();
            for (q, wave) in waves.iter().enumerate() {
                let wave_x = splat(wave.x);
                let odd_part = waves.len() + q;
                for lane in (0..MOST_LANES).step_by(S::F32_LANES) {
                    let dx = vector(simd, &self.dx, lane);
                    let whole = simd.sub_f32s(simd.add_f32s(dx, rounder), rounder);
                    let beyond = simd.sub_f32s(dx, whole);
                    let (le, lo) = (
                        vector(simd, &self.left[q], lane),
                        vector(simd, &self.left[odd_part], lane),
                    );
                    let (re, ro) = (
                        vector(simd, &self.right[q], lane),
                        vector(simd, &self.right[odd_part], lane),
                    );
                    let even = two(re, le, ro, lo);
                    let odd = simd.sub_f32s(simd.mul_f32s(ro, le), simd.mul_f32s(re, lo));
                    let angle = angle(simd, odd, even);
                    let phase = wrap(simd, simd.mul_add_e_f32s(wave_x, beyond, angle));
                    let squared = two(even, even, odd, odd);
                    let energy = simd.add_f32s(two(le, le, lo, lo), two(re, re, ro, ro));
                    let weight = source.weight(simd, squared, energy);
                    let opposed = simd.less_than_f32s(splat(FRAC_PI_2), simd.abs_f32s(phase));
                    let weight = simd.select_f32s(opposed, zero, weight);
                    let heard = simd.less_than_f32s(tiny, squared);
                    let weight = simd.select_f32s(heard, weight, zero);
                    store(simd, &mut self.phases[channel], lane, phase);
                    store(simd, &mut self.weights[channel], lane, weight);
                }
                channel += 1;
            }
        }
    }

    /// The shifts that the phases at some of the pixels, from a lane on, still ask for together, and their
    /// agreement with them.
    #[inline(always)]
    fn agree<P: PhaseSource, S: Rough>(&mut self, simd: S, lane: usize, sources: &[P]) {
        let splat = |value| simd.splat_f32s(value);
        let (zero, tiny) = (splat(0.0), splat(f32::MIN_POSITIVE));
        let (mut numerator, mut denominator, mut heard) = (zero, zero, zero);
        let mut channel = 0;
        for source in sources.iter().take(MOST_BANKS) {
            for wave in source.waves() {
                let phase = vector(simd, &self.phases[channel], lane);
                let weight = vector(simd, &self.weights[channel], lane);
                let wave_x = splat(wave.x);
                let weighed = simd.mul_f32s(weight, wave_x);
                numerator = simd.mul_add_e_f32s(weighed, phase, numerator);
                denominator = simd.mul_add_e_f32s(weighed, wave_x, denominator);
                heard = simd.add_f32s(heard, weight);
                channel += 1;
            }
        }
        let anything = simd.less_than_f32s(tiny, denominator);
        let step = simd.quotient(simd.neg_f32s(numerator), simd.max_f32s(denominator, tiny));
        // Where only the orientation along the rows is heard, a step can be anything; so far it is
        // refused, and a cosine would lose its angle.
        let far = simd.min_f32s(simd.max_f32s(step, splat(-FAR_STEP_PX)), splat(FAR_STEP_PX));
        let step = simd.select_f32s(anything, far, zero);
        let mut agreement = zero;
        let mut channel = 0;
        for source in sources.iter().take(MOST_BANKS) {
            for wave in source.waves() {
                let phase = vector(simd, &self.phases[channel], lane);
                let weight = vector(simd, &self.weights[channel], lane);
                let left_over = simd.mul_add_e_f32s(splat(wave.x), step, phase);
                agreement = simd.mul_add_e_f32s(weight, cosine(simd, left_over), agreement);
                channel += 1;
            }
        }
        let agreement = simd.quotient(agreement, simd.max_f32s(heard, tiny));
        let agreement = simd.select_f32s(anything, agreement, zero);
        store(simd, &mut self.steps, lane, step);
        store(simd, &mut self.coherences, lane, agreement);
    }
}
