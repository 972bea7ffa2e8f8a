use ndarray::Array2;

use crate::Responses;

impl Responses {
    /// The amplitude of one orientation at every pixel, `[[y, x]]`: `rho_q = |G_q|`, the square
    /// root of the [`energy`](Self::energy).
    ///
    /// In units of luma; a grating of amplitude `A` at the filter's peak has `A / 2`.
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn amplitude(&self, orientation: usize) -> Array2<f32> {
        self.plane(orientation).mapv(|response| response.norm())
    }
}
