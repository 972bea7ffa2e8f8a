use crate::strip_kernel::{StripKernel, StripWorkspace};

/// What [`FilterBank::respond_rows_into`](crate::FilterBank::respond_rows_into) works in: some rows of
/// a strip, a few kilobytes. One for each thread; it holds nothing that matters from row to row.
#[derive(Clone, Debug, Default)]
pub struct RowWorkspace(Option<((usize, usize, usize), StripWorkspace)>);

impl RowWorkspace {
    /// A workspace that has not grown yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The buffers, as this kernel needs them.
    pub(crate) fn fitted_to(&mut self, kernel: &StripKernel) -> &mut StripWorkspace {
        let held = self.0.take().filter(|(shape, _)| *shape == kernel.shape());
        let held = held.unwrap_or_else(|| (kernel.shape(), kernel.workspace()));
        &mut self.0.insert(held).1
    }
}
