use ndarray::Array2;

use crate::Responses;

impl Responses {
    /// The energy of one orientation at every pixel, `[[y, x]]`: `E_q = Re(G_q)^2 + Im(G_q)^2`,
    /// what a complex cell of that orientation fires at.
    ///
    /// In squared units of luma; a grating of amplitude `A` at the filter's peak has `A^2 / 4`.
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn energy(&self, orientation: usize) -> Array2<f32> {
        self.plane(orientation).mapv(|response| response.norm_sqr())
    }
}
