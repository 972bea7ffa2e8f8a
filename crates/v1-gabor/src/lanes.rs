use std::ops::{Deref, DerefMut};

use crate::machine::Machine;
use crate::separable::Kernel;

/// One value for each of the neighbouring pixels that are filtered together: as many as the
/// machine's vectors hold.
#[allow(unreachable_pub, reason = "the hidden module machine speaks of it")]
pub type Lanes<const LANES: usize> = [f32; LANES];

/// The most lanes of any machine.
pub(crate) const MOST_LANES: usize = 16;

/// The most taps on either side that the fast pass is compiled for.
pub(crate) const MOST_RADIUS: usize = 7;

/// Values that one step of a horizontal kernel sees: the lanes and the taps on either side. A power
/// of two above what is needed, so that offsets into it need no check.
pub(crate) const WINDOW: usize = 32;

/// Columns filtered before the next: the rows that the kernels give for one strip stay in the first
/// cache.
pub(crate) const STRIP: usize = 96;

/// One row of a strip: the strip, the taps on either side, and what the last window reads beyond.
/// Not a power of two long, which would crowd a few cache sets, and begun at a cache line, so that
/// whole vectors are stored without crossing one.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Row([f32; STRIP + 2 * WINDOW + 16]);

impl Row {
    /// A row of nothing.
    pub(crate) const EMPTY: Self = Self([0.0; STRIP + 2 * WINDOW + 16]);

    /// As many values as there are lanes, from `start` on.
    #[inline(always)]
    pub(crate) fn lanes<const LANES: usize>(&self, start: usize) -> &Lanes<LANES> {
        lanes_at(&self.0, start)
    }

    /// The same, to be written.
    #[inline(always)]
    pub(crate) fn lanes_mut<const LANES: usize>(&mut self, start: usize) -> &mut Lanes<LANES> {
        lanes_at_mut(&mut self.0, start)
    }
}

impl Deref for Row {
    type Target = [f32; STRIP + 2 * WINDOW + 16];

    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Row {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

/// One number in every lane, in a cache line of its own.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Spread(Lanes<MOST_LANES>);

impl Spread {
    pub(crate) const fn new(value: f32) -> Self {
        Self([value; MOST_LANES])
    }

    #[inline(always)]
    pub(crate) fn load<const LANES: usize, M: Machine<LANES>>(&self, machine: M) -> M::Vector {
        machine.load(lanes_at(&self.0, 0))
    }
}

/// A kernel with each tap repeated over the lanes.
#[derive(Clone, Debug)]
pub(crate) struct SpreadKernel {
    /// At `0..=radius` from the centre. Kept in place rather than behind a pointer, as the loops
    /// over kernels are short.
    taps: [Spread; MOST_RADIUS + 1],
}

impl SpreadKernel {
    /// A kernel's taps, times a factor.
    pub(crate) fn new(kernel: &Kernel, factor: f32) -> Self {
        let tap = |k: usize| kernel.taps.get(k).map_or(0.0, |tap| factor * tap);
        Self {
            taps: std::array::from_fn(|k| Spread::new(tap(k))),
        }
    }

    /// The tap at `k` from the centre, in every lane.
    #[inline(always)]
    pub(crate) fn tap<const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        k: usize,
    ) -> M::Vector {
        self.taps[k].load(machine)
    }

    /// An even kernel's result from the middle value and the sums of those at equal distance.
    #[inline(always)]
    pub(crate) fn even<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        middle: M::Vector,
        sums: &[M::Vector; RADIUS],
    ) -> M::Vector {
        let mut value = machine.multiply(self.tap(machine, 0), middle);
        for k in 0..RADIUS {
            value = machine.multiply_add(self.tap(machine, k + 1), sums[k], value);
        }
        value
    }

    /// An odd kernel's result from the differences of the values at equal distance.
    #[inline(always)]
    pub(crate) fn odd<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        differences: &[M::Vector; RADIUS],
    ) -> M::Vector {
        let mut value = machine.multiply(self.tap(machine, 1), differences[0]);
        for k in 1..RADIUS {
            value = machine.multiply_add(self.tap(machine, k + 1), differences[k], value);
        }
        value
    }
}

/// What the horizontal kernels see of one row at as many places as there are lanes: the values themselves and their
/// neighbours, in pairs of equal distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbours<'a>(&'a [f32; WINDOW]);

impl<'a> Neighbours<'a> {
    /// Around `row[x + RADIUS..]`.
    ///
    /// # Panics
    /// If fewer than [`WINDOW`] values follow.
    #[inline(always)]
    pub(crate) fn at(row: &'a Row, x: usize) -> Self {
        let (window, _) = row[x..]
            .split_first_chunk::<WINDOW>()
            .expect("a row is a window longer than a strip");
        Self(window)
    }

    #[inline(always)]
    pub(crate) fn middle<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        self,
        machine: M,
    ) -> M::Vector {
        self.side(machine, RADIUS)
    }

    /// The two values at `k` from the middle, added.
    #[inline(always)]
    pub(crate) fn sum<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        self,
        machine: M,
        k: usize,
    ) -> M::Vector {
        machine.add(
            self.side(machine, RADIUS + k),
            self.side(machine, RADIUS - k),
        )
    }

    /// The value `k` after the middle less the one `k` before it.
    #[inline(always)]
    pub(crate) fn difference<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        self,
        machine: M,
        k: usize,
    ) -> M::Vector {
        machine.subtract(
            self.side(machine, RADIUS + k),
            self.side(machine, RADIUS - k),
        )
    }

    /// [`sum`](Self::sum) for every `k` from 1 on.
    #[inline(always)]
    pub(crate) fn sums<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        self,
        machine: M,
    ) -> [M::Vector; RADIUS] {
        let mut sums = [self.side(machine, RADIUS); RADIUS];
        for k in 0..RADIUS {
            sums[k] = self.sum::<RADIUS, LANES, M>(machine, k + 1);
        }
        sums
    }

    /// [`difference`](Self::difference) for every `k` from 1 on.
    #[inline(always)]
    pub(crate) fn differences<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        self,
        machine: M,
    ) -> [M::Vector; RADIUS] {
        let mut differences = [self.side(machine, RADIUS); RADIUS];
        for k in 0..RADIUS {
            differences[k] = self.difference::<RADIUS, LANES, M>(machine, k + 1);
        }
        differences
    }

    #[inline(always)]
    fn side<const LANES: usize, M: Machine<LANES>>(self, machine: M, offset: usize) -> M::Vector {
        machine.load(lanes_at(self.0, offset))
    }
}

/// As many values as there are lanes, from `start` on.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub(crate) fn lanes_at<const LANES: usize>(values: &[f32], start: usize) -> &Lanes<LANES> {
    values[start..]
        .first_chunk()
        .expect("as many values as lanes")
}

/// The same, to be written.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub(crate) fn lanes_at_mut<const LANES: usize>(
    values: &mut [f32],
    start: usize,
) -> &mut Lanes<LANES> {
    values[start..]
        .first_chunk_mut()
        .expect("as many values as lanes")
}
