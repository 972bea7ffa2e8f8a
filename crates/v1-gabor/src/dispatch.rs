use pulp::{Arch, NullaryFnOnce};

use crate::lanes::MOST_RADIUS;
use crate::machine::Machine;
use crate::strip_kernel::{Layout, StripKernel, StripWorkspace};

/// The instructions that a bank may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Instructions {
    /// The widest that this machine has, of those that are compiled: AVX-512, or AVX2 with fused
    /// multiplication, on x86, the base instructions elsewhere.
    #[default]
    Widest,
    /// What every machine of the compiled target has: the same bits on all of them, a few units in
    /// the last place from the widest, and slower.
    Portable,
}

/// Rows `from..` of an image through a [`StripKernel`], as many as `responses` holds.
#[derive(Debug)]
pub(crate) struct Rows<'a> {
    pub(crate) kernel: &'a StripKernel,
    pub(crate) image: &'a [f32],
    pub(crate) width: usize,
    pub(crate) from: usize,
    pub(crate) layout: Layout,
    pub(crate) responses: &'a mut [f32],
    pub(crate) workspace: &'a mut StripWorkspace,
}

/// The same rows, with the number of taps and the way of adding known to the compiler.
struct Compiled<'a, const RADIUS: usize, const LANES: usize, M>(Rows<'a>, M);

impl Rows<'_> {
    /// Whether the fast pass is compiled for filters of this radius.
    pub(crate) const fn are_compiled_for(radius: usize) -> bool {
        matches!(radius, 3..=MOST_RADIUS)
    }

    /// Filters the rows.
    pub(crate) fn respond(self, radius: usize, instructions: Instructions) {
        match radius {
            3 => self.respond_compiled::<3>(instructions),
            4 => self.respond_compiled::<4>(instructions),
            5 => self.respond_compiled::<5>(instructions),
            6 => self.respond_compiled::<6>(instructions),
            7 => self.respond_compiled::<7>(instructions),
            _ => unreachable!("the plan takes the plain pass for other radii"),
        }
    }

    fn respond_compiled<const RADIUS: usize>(self, instructions: Instructions) {
        match (instructions, Arch::new()) {
            // Sixteen lanes turn sixteen parts at a time, and are no gain where there are fewer.
            #[cfg(target_arch = "x86_64")]
            (Instructions::Widest, Arch::V4(v4))
                if self.layout == Layout::ByPixel && !self.kernel.parts().is_multiple_of(16) =>
            {
                v4.vectorize(Compiled::<RADIUS, 8, _>(self, *v4));
            }
            #[cfg(target_arch = "x86_64")]
            (Instructions::Widest, Arch::V4(v4)) => {
                v4.vectorize(Compiled::<RADIUS, 16, _>(self, v4));
            }
            #[cfg(target_arch = "x86_64")]
            (Instructions::Widest, Arch::V3(v3)) => {
                v3.vectorize(Compiled::<RADIUS, 8, _>(self, v3));
            }
            _ => Compiled::<RADIUS, 8, _>(self, pulp::Scalar).call(),
        }
    }
}

impl<const RADIUS: usize, const LANES: usize, M: Machine<LANES>> NullaryFnOnce
    for Compiled<'_, RADIUS, LANES, M>
{
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Rows {
            kernel,
            image,
            width,
            from,
            layout,
            responses,
            workspace,
        } = self.0;
        let machine = self.1;
        let stride = width * kernel.parts();
        for (row, out) in responses.chunks_exact_mut(stride).enumerate() {
            kernel.respond_row::<RADIUS, LANES, M>(
                machine,
                image,
                width,
                from + row,
                (layout, out),
                workspace,
            );
        }
    }
}
