use v1_gabor::{FilterBank, LumaImage, RowWorkspace, WrongSize};

/// One row of responses after the other.
///
/// Responses of a whole image are 8 bytes a pixel and orientation, and reading them back from memory
/// takes longer than the filters do; a row stays where it was written.
#[derive(Clone, Debug, Default)]
pub(crate) struct BankRows {
    workspace: RowWorkspace,
    samples: Vec<f32>,
}

impl BankRows {
    /// The responses of row `y`: for each pixel the even parts of all orientations, then the odd
    /// ones. The bank is one that answers by rows, as all of this estimator are.
    ///
    /// # Errors
    /// [`WrongSize`] if the bank was planned for other images.
    pub(crate) fn row(
        &mut self,
        bank: &FilterBank,
        eye: &LumaImage,
        y: usize,
    ) -> Result<&[f32], WrongSize> {
        self.fit(bank);
        let answered = bank.respond_rows_into(eye, y, &mut self.workspace, &mut self.samples)?;
        debug_assert!(answered, "{BY_ROWS}");
        Ok(&self.samples)
    }

    /// The same numbers part by part: the even parts of each orientation along the row, then the odd ones.
    ///
    /// # Errors
    /// [`WrongSize`] if the bank was planned for other images.
    pub(crate) fn parts(
        &mut self,
        bank: &FilterBank,
        eye: &LumaImage,
        y: usize,
    ) -> Result<&[f32], WrongSize> {
        self.fit(bank);
        let answered =
            bank.respond_row_parts_into(eye, y, &mut self.workspace, &mut self.samples)?;
        debug_assert!(answered, "{BY_ROWS}");
        Ok(&self.samples)
    }

    fn fit(&mut self, bank: &FilterBank) {
        let parts = 2 * bank.params().orientations;
        self.samples.resize(bank.size().width * parts, 0.0);
    }
}

const BY_ROWS: &str = "filters of 7 and 11 taps have a pass over rows";
