use ndarray::{Array2, ArrayView2};
use num_complex::Complex32;

use crate::filter_bank::pad;
use crate::transform::{Direction, transform};
use crate::{FilterBank, LumaImage, Responses, Size, V1Responses, WrongSize};

impl FilterBank {
    /// The same responses by way of the Fourier domain: the image's spectrum times each filter's.
    ///
    /// Slower than [`respond`](Self::respond) for 11 taps, and without a line in common: it is the
    /// second opinion on the separable bank. Borders are replicated, as there.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    pub fn respond_by_fourier(&self, image: &LumaImage) -> Result<V1Responses, WrongSize> {
        self.respond_with(image, |plane| self.filter_by_fourier(plane))
    }

    fn filter_by_fourier(&self, plane: ArrayView2<'_, f32>) -> Responses {
        let size = Size::of_dim(plane.dim());
        let params = self.params();
        let padded = pad(plane, params.radius);
        let dim = padded.dim();
        let mut spectrum = padded.mapv(|luma| Complex32::new(luma, 0.0));
        transform(&mut spectrum, Direction::Forward);

        let orientations = params.orientations;
        let mut responses = Responses::silence(params, size);
        let samples = responses.samples_mut();
        for q in 0..orientations {
            // A correlation is a convolution with the filter turned round, so tap k goes to -k,
            // counted cyclically. A further shift by the radius drops the padding at the same time:
            // the wrapped-around rows are those of the padding.
            let mut filter = Array2::zeros(dim);
            for ((y, x), &tap) in self.filter(q).indexed_iter() {
                filter[[(dim.0 - y) % dim.0, (dim.1 - x) % dim.1]] += tap;
            }
            transform(&mut filter, Direction::Forward);
            filter *= &spectrum;
            transform(&mut filter, Direction::Inverse);
            let scale = 1.0 / (dim.0 * dim.1) as f32;
            for y in 0..size.height {
                for x in 0..size.width {
                    let pixel = (y * size.width + x) * 2 * orientations;
                    samples[pixel + q] = filter[[y, x]].re * scale;
                    samples[pixel + orientations + q] = filter[[y, x]].im * scale;
                }
            }
        }
        responses
    }
}
