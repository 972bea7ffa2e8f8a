use ndarray::Array2;

use crate::Responses;

impl Responses {
    /// The local phase of one orientation at every pixel, `[[y, x]]`: `phi_q = arg G_q` in
    /// `(-pi, pi]` radians. NaN where the response is exactly 0 and has no phase.
    ///
    /// It is 0 on a bright line, `pi` on a dark one, `-pi/2` where brightness rises along the wave
    /// vector and `pi/2` where it falls. To compare two phases, take the angle of `G conj(G')`
    /// rather than the difference of two such planes: it wraps by itself.
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn local_phase(&self, orientation: usize) -> Array2<f32> {
        self.plane(orientation).mapv(|response| {
            if response.norm_sqr() > 0.0 {
                response.arg()
            } else {
                f32::NAN
            }
        })
    }
}
