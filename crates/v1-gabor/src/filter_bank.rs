use ndarray::{Array2, ArrayView2};
use num_complex::Complex32;
use rayon::prelude::*;

use crate::bank_workspace::BandWorkspace;
use crate::dispatch::Rows;
use crate::pyramid::{reduce, reduce_into};
use crate::samples::Samples;
use crate::separable::Separable;
use crate::separable_pass::SeparablePass;
use crate::strip_kernel::{Layout, StripKernel, StripWorkspace};
use crate::{
    BadParams, BankWorkspace, Family, GaborParams, Instructions, LumaImage, Responses,
    RowWorkspace, Size, V1Responses,
};

/// A bank of oriented quadrature filters of one [`Family`], planned for images of one size and good
/// for any number of them.
///
/// By default they are Gabor filters,
/// `h_q(x, y) = exp(-(x^2 + y^2) / (2 sigma^2)) exp(-j omega0 (x cos theta_q + y sin theta_q))`
/// (equation 1 of the paper), applied as a correlation so that phase grows with `x`, freed of its
/// DC, scaled to unit gain at its peak.
///
/// ```
/// use ndarray::Array2;
/// use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};
///
/// let size = Size { width: 64, height: 48 };
/// let bank = FilterBank::plan(GaborParams { scales: 3, ..GaborParams::default() }, size)?;
/// let grating = Array2::from_shape_fn(size.dim(), |(_, x)| (1.5 * x as f32).sin());
/// let responses = bank.respond(&LumaImage::new(grating)?)?;
/// let finest = &responses.scales()[0];
/// // Vertical bars excite the orientation whose wave vector lies along x, not the one across it.
/// assert!(finest.at(0, 32, 24).norm() > 100.0 * finest.at(4, 32, 24).norm());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FilterBank {
    family: Family,
    params: GaborParams,
    size: Size,
    separable: Separable,
    strip_kernel: StripKernel,
    instructions: Instructions,
}

/// The image has another size than the bank was planned for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this bank was planned for images of {planned} and got one of {given}")]
pub struct WrongSize {
    /// Size the bank was planned for.
    pub planned: Size,
    /// Size of the image.
    pub given: Size,
}

impl FilterBank {
    /// Plans a bank for images of one size. The family is chosen by its parameters:
    /// [`GaborParams`], [`SteerableParams`](crate::SteerableParams), or a [`Family`].
    ///
    /// # Errors
    /// [`BadParams`] says which parameter cannot be, and why.
    pub fn plan(family: impl Into<Family>, size: Size) -> Result<Self, BadParams> {
        let family = family.into();
        family.check(size)?;
        let separable = family.kernels();
        Ok(Self {
            family,
            params: family.as_gabor(),
            size,
            strip_kernel: StripKernel::new(&separable),
            separable,
            instructions: Instructions::default(),
        })
    }

    /// The same bank, bound to these instructions.
    #[must_use]
    pub const fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.instructions = instructions;
        self
    }

    /// Whether the other bank has the same filters for images of the same size, bound to the same
    /// instructions: whether both give the same bits.
    #[must_use]
    pub fn is_same_as(&self, other: &Self) -> bool {
        let plan = |bank: &Self| (bank.family, bank.size, bank.instructions);
        plan(self) == plan(other)
    }

    /// The family that the bank was planned for, with its parameters.
    #[must_use]
    pub const fn family(&self) -> Family {
        self.family
    }

    /// The parameters that the bank was planned with; of another family, the Gabor filters of the
    /// same orientations, scales, peak frequency, bandwidth and width.
    #[must_use]
    pub const fn params(&self) -> GaborParams {
        self.params
    }

    /// The size of the images that the bank was planned for.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The filter of one orientation, `[[y, x]]`, `taps x taps`, its centre in the middle.
    ///
    /// The response at a pixel is the sum over the taps of the image around that pixel times the
    /// filter (a correlation: the filter is not turned round).
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn filter(&self, orientation: usize) -> Array2<Complex32> {
        let recipe = &self.separable.recipes[orientation];
        let radius = self.params.radius as isize;
        let taps = self.params.taps();
        Array2::from_shape_fn((taps, taps), |(y, x)| {
            self.separable
                .sample(recipe, x as isize - radius, y as isize - radius)
        })
    }

    /// The responses of every orientation at every scale, finest first.
    ///
    /// For one image. For a stream of them, [`respond_into`](Self::respond_into) saves the memory
    /// traffic of fresh buffers.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    pub fn respond(&self, image: &LumaImage) -> Result<V1Responses, WrongSize> {
        let mut responses = self.silence();
        self.respond_into(image, &mut self.workspace(), &mut responses)?;
        Ok(responses)
    }

    /// The same responses, written over those of an earlier image.
    ///
    /// With the [`workspace`](Self::workspace) and the responses of the frame before, nothing large
    /// is allocated. Responses of another bank are replaced.
    ///
    /// ```
    /// # use ndarray::Array2;
    /// # use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};
    /// # let size = Size { width: 64, height: 48 };
    /// # let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
    /// # let frames = vec![LumaImage::new(Array2::zeros(size.dim()))?; 2];
    /// let mut workspace = bank.workspace();
    /// let mut responses = bank.silence();
    /// for frame in &frames {
    ///     bank.respond_into(frame, &mut workspace, &mut responses)?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for; the responses
    /// then stay as they are.
    pub fn respond_into(
        &self,
        image: &LumaImage,
        workspace: &mut BankWorkspace,
        responses: &mut V1Responses,
    ) -> Result<(), WrongSize> {
        self.check_size(image)?;
        self.fit(responses, 0);
        self.fit_workspace(workspace);
        let BankWorkspace { coarser, bands, .. } = workspace;
        let mut plane = image.plane();
        let mut coarser = coarser.iter_mut();
        for scale in responses.scales_mut() {
            self.respond_at_one_scale(plane, bands, scale.samples_mut());
            if let Some(next) = coarser.next() {
                reduce_into(plane, next);
                plane = next.view();
            }
        }
        Ok(())
    }

    /// The responses at the finest scale row by row, from the top, each handed over as soon as it is
    /// there and then forgotten: `visit(y, row)`. In the row stand for each pixel the even (real) parts
    /// of all orientations, then the odd (imaginary) ones.
    ///
    /// Responses of a whole image are 64 bytes a pixel for eight orientations, and writing them to
    /// memory takes longer than the filters do. What needs them only once, or only near by, saves
    /// that.
    ///
    /// ```
    /// # use ndarray::Array2;
    /// # use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};
    /// # let size = Size { width: 64, height: 48 };
    /// # let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
    /// # let image = LumaImage::new(Array2::zeros(size.dim()))?;
    /// let mut energy = 0.0;
    /// bank.respond_by_rows(&image, &mut bank.workspace(), |_, row| {
    ///     energy += row.iter().map(|part| part * part).sum::<f32>();
    /// })?;
    /// assert_eq!(energy, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    pub fn respond_by_rows(
        &self,
        image: &LumaImage,
        workspace: &mut BankWorkspace,
        mut visit: impl FnMut(usize, &[f32]),
    ) -> Result<(), WrongSize> {
        self.check_size(image)?;
        self.fit_workspace(workspace);
        let BankWorkspace {
            bands, responses, ..
        } = workspace;
        let row = self.size.width * 2 * self.params.orientations;
        if responses.as_slice().len() != row {
            *responses = Samples::zeros(row);
        }
        let responses = responses.as_mut_slice();
        if Rows::are_compiled_for(self.params.radius) {
            for y in 0..self.size.height {
                self.respond_at_rows(image.plane(), y, &mut bands[0].strips, responses);
                visit(y, responses);
            }
        } else {
            let padded = pad(image.plane(), self.params.radius);
            let pass = SeparablePass::new(&self.separable);
            let mut between = pass.workspace(self.size.width);
            for y in 0..self.size.height {
                pass.respond_row(padded.view(), y, responses, &mut between);
                visit(y, responses);
            }
        }
        Ok(())
    }

    /// The responses of the rows from `from` on at the finest scale, as many as `responses` holds: for
    /// each pixel the even (real) parts of all orientations, then the odd (imaginary) ones. The bits
    /// are those of [`respond`](Self::respond), whatever the rows and whoever asks for them. False, and
    /// nothing written, if this bank's filters have no pass over single rows
    /// ([`answers_by_rows`](Self::answers_by_rows)).
    ///
    /// For who wants some rows in a thread of his own: nothing of the bank is written to.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    ///
    /// # Panics
    /// If the image has fewer rows.
    pub fn respond_rows_into(
        &self,
        image: &LumaImage,
        from: usize,
        workspace: &mut RowWorkspace,
        responses: &mut [f32],
    ) -> Result<bool, WrongSize> {
        self.check_size(image)?;
        if !self.answers_by_rows() {
            return Ok(false);
        }
        let strips = workspace.fitted_to(&self.strip_kernel);
        self.respond_at_rows(image.plane(), from, strips, responses);
        Ok(true)
    }

    /// The same numbers, part by part: of each row from `from` on at the finest scale the even parts of
    /// one orientation after the other, each as long as the image is wide, then the odd ones. For who
    /// computes with neighbouring pixels side by side; it takes a third less time, since nothing is turned.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    ///
    /// # Panics
    /// If the image has fewer rows.
    pub fn respond_row_parts_into(
        &self,
        image: &LumaImage,
        from: usize,
        workspace: &mut RowWorkspace,
        parts: &mut [f32],
    ) -> Result<bool, WrongSize> {
        self.check_size(image)?;
        if !self.answers_by_rows() {
            return Ok(false);
        }
        let strips = workspace.fitted_to(&self.strip_kernel);
        let responses = (Layout::ByPart, parts);
        self.respond_at_rows_in(image.plane(), from, strips, responses);
        Ok(true)
    }

    /// Whether [`respond_rows_into`](Self::respond_rows_into) answers: filters with a radius of 3 to 7
    /// pixels, which are those of all defaults.
    #[must_use]
    pub const fn answers_by_rows(&self) -> bool {
        Rows::are_compiled_for(self.params.radius)
    }

    /// The same filters for the scales from the second on: the bank whose responses
    /// [`respond_coarser_into`](Self::respond_coarser_into) writes. `None` if there is one scale only.
    #[must_use]
    pub fn coarser(&self) -> Option<Self> {
        let params = GaborParams {
            scales: self.params.scales.checked_sub(1).filter(|&left| left > 0)?,
            ..self.params
        };
        Some(Self {
            params,
            family: self.family.with_scales(params.scales),
            size: self.size.halved(),
            ..self.clone()
        })
    }

    /// The responses at every scale but the finest, for who asks for those
    /// [row by row](Self::respond_rows_into): a third of all. `responses` are the
    /// [coarser](Self::coarser) bank's, its first scale being this one's second, and are replaced if
    /// they are another's; of one scale only, nothing is left to be written.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for; the responses
    /// then stay as they are.
    pub fn respond_coarser_into(
        &self,
        image: &LumaImage,
        workspace: &mut BankWorkspace,
        responses: &mut V1Responses,
    ) -> Result<(), WrongSize> {
        self.check_size(image)?;
        if self.params.scales == 1 {
            return Ok(());
        }
        self.fit(responses, 1);
        self.fit_workspace(workspace);
        let BankWorkspace {
            coarser: planes,
            bands,
            ..
        } = workspace;
        let mut plane = image.plane();
        for (scale, next) in responses.scales_mut().iter_mut().zip(planes) {
            reduce_into(plane, next);
            plane = next.view();
            self.respond_at_one_scale(plane, bands, scale.samples_mut());
        }
        Ok(())
    }

    /// Replaces responses of another bank, this one's scales counting from `first`.
    fn fit(&self, responses: &mut V1Responses, first: usize) {
        let params = GaborParams {
            scales: self.params.scales - first,
            ..self.params
        };
        let sizes = responses.scales().iter().map(Responses::size);
        if responses.params() != params || !sizes.eq(self.sizes().skip(first)) {
            let silence = |size| Responses::silence(params, size);
            let scales = self.sizes().skip(first).map(silence);
            *responses = V1Responses::new(params, scales.collect());
        }
    }

    /// Replaces buffers of another bank.
    fn fit_workspace(&self, workspace: &mut BankWorkspace) {
        if !workspace.fits(self.sizes(), &self.strip_kernel) {
            *workspace = self.workspace();
        }
    }

    /// The responses to a black image: what [`respond_into`](Self::respond_into) writes over.
    #[must_use]
    pub fn silence(&self) -> V1Responses {
        let scales = self
            .sizes()
            .map(|size| Responses::silence(self.params, size));
        V1Responses::new(self.params, scales.collect())
    }

    /// The buffers that this bank works in, for as many threads as the caller's rayon pool has.
    #[must_use]
    pub fn workspace(&self) -> BankWorkspace {
        BankWorkspace::new(self.sizes(), &self.strip_kernel)
    }

    /// The size of each scale, finest first.
    fn sizes(&self) -> impl Iterator<Item = Size> {
        std::iter::successors(Some(self.size), |size| Some(size.halved())).take(self.params.scales)
    }

    fn respond_at_one_scale(
        &self,
        plane: ArrayView2<'_, f32>,
        bands: &mut [BandWorkspace],
        samples: &mut [f32],
    ) {
        if !Rows::are_compiled_for(self.params.radius) {
            return self.respond_plainly(plane, samples);
        }
        let (height, width) = plane.dim();
        let rows = height.div_ceil(bands.len());
        samples
            .par_chunks_mut(rows * width * 2 * self.params.orientations)
            .zip(bands)
            .enumerate()
            .for_each(|(band, (responses, workspace))| {
                self.respond_at_rows(plane, band * rows, &mut workspace.strips, responses);
            });
    }

    /// The responses of the rows from `from` on, as many as `responses` holds.
    fn respond_at_rows(
        &self,
        plane: ArrayView2<'_, f32>,
        from: usize,
        workspace: &mut StripWorkspace,
        responses: &mut [f32],
    ) {
        self.respond_at_rows_in(plane, from, workspace, (Layout::ByPixel, responses));
    }

    /// The same in any layout.
    fn respond_at_rows_in(
        &self,
        plane: ArrayView2<'_, f32>,
        from: usize,
        workspace: &mut StripWorkspace,
        (layout, responses): (Layout, &mut [f32]),
    ) {
        let radius = self.params.radius;
        let rows = Rows {
            kernel: &self.strip_kernel,
            image: plane.to_slice().expect("an image is contiguous"),
            width: plane.dim().1,
            from,
            layout,
            responses,
            workspace,
        };
        rows.respond(radius, self.instructions);
    }

    /// The same by way of [`SeparablePass`], which any radius may take and which is the oracle of
    /// the fast one.
    fn respond_plainly(&self, plane: ArrayView2<'_, f32>, samples: &mut [f32]) {
        let (_, width) = plane.dim();
        let padded = pad(plane, self.params.radius);
        let pass = SeparablePass::new(&self.separable);
        samples
            .par_chunks_mut(width * 2 * self.params.orientations)
            .enumerate()
            .for_each_init(
                || pass.workspace(width),
                |workspace, (y, row)| pass.respond_row(padded.view(), y, row, workspace),
            );
    }

    fn check_size(&self, image: &LumaImage) -> Result<(), WrongSize> {
        if image.size() == self.size {
            return Ok(());
        }
        Err(WrongSize {
            planned: self.size,
            given: image.size(),
        })
    }

    /// Walks the pyramid of an image, finest scale first, with one way to filter a plane.
    pub(crate) fn respond_with(
        &self,
        image: &LumaImage,
        filter: impl Fn(ArrayView2<'_, f32>) -> Responses,
    ) -> Result<V1Responses, WrongSize> {
        self.check_size(image)?;
        let mut scales = vec![filter(image.plane())];
        let mut plane: Option<Array2<f32>> = None;
        for _ in 1..self.params.scales {
            let coarser = reduce(plane.as_ref().map_or(image.plane(), |plane| plane.view()));
            scales.push(filter(coarser.view()));
            plane = Some(coarser);
        }
        Ok(V1Responses::new(self.params, scales))
    }
}

/// The plane with its border replicated `radius` pixels outwards on every side.
pub(crate) fn pad(plane: ArrayView2<'_, f32>, radius: usize) -> Array2<f32> {
    let (height, width) = plane.dim();
    Array2::from_shape_fn((height + 2 * radius, width + 2 * radius), |(y, x)| {
        let y = y.saturating_sub(radius).min(height - 1);
        let x = x.saturating_sub(radius).min(width - 1);
        plane[[y, x]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SteerableParams;
    use proptest::prelude::*;

    fn noise(size: Size, seed: u64) -> LumaImage {
        let mut state = seed | 1;
        let plane = Array2::from_shape_simple_fn(size.dim(), || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        });
        LumaImage::new(plane).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// The fast pass says what the plain one says, with the machine's instructions and with the
        /// portable ones, for every family and past the end of a strip.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..600, height in 1usize..20, orientations in 4usize..17,
            radius in 5usize..9, steerable: bool, seed: u64,
        ) {
            let size = Size { width, height };
            let family = if steerable {
                let scales = 1;
                let params = SteerableParams { orientations, radius, scales, ..Default::default() };
                Family::from(params)
            } else {
                GaborParams { orientations, radius, scales: 1, ..Default::default() }.into()
            };
            let bank = FilterBank::plan(family, size).unwrap();
            let image = noise(size, seed);
            let mut plain = bank.silence();
            bank.respond_plainly(image.plane(), plain.scales_mut()[0].samples_mut());
            for instructions in [Instructions::Portable, Instructions::Widest] {
                let bank = bank.clone().with_instructions(instructions);
                let fast = bank.respond(&image).unwrap();
                for q in 0..orientations {
                    let differences = fast.scales()[0].plane(q) - plain.scales()[0].plane(q);
                    // Sums of some 150 products below 0.1, in other orders and with other
                    // roundings: near 1e-6.
                    prop_assert!(differences.iter().all(|d| d.norm() < 4e-6));
                }
            }
        }
    }

    /// Row by row or all at once: the same bits, with the fast pass and with the plain one.
    #[test]
    fn rows_are_those_of_the_whole() {
        let size = Size {
            width: 300,
            height: 40,
        };
        let image = noise(size, 3);
        for radius in [5, 9] {
            let params = GaborParams {
                radius,
                scales: 1,
                ..GaborParams::default()
            };
            let bank = FilterBank::plan(params, size).unwrap();
            let whole = bank.respond(&image).unwrap();
            let mut rows = 0;
            bank.respond_by_rows(&image, &mut bank.workspace(), |y, row| {
                assert_eq!(y, rows);
                rows += 1;
                for (x, parts) in row.chunks_exact(16).enumerate() {
                    let pixel = whole.scales()[0].pixel(x, y);
                    assert_eq!([pixel.even, pixel.odd].concat(), parts);
                }
            })
            .unwrap();
            assert_eq!(rows, size.height);
        }
    }

    /// Part by part the same bits as pixel by pixel, whatever the lanes of either.
    #[test]
    fn parts_are_those_of_the_pixels() {
        let size = Size {
            width: 301,
            height: 9,
        };
        let image = noise(size, 4);
        for (orientations, radius) in [(4, 5), (8, 5), (6, 7)] {
            let params = GaborParams {
                orientations,
                radius,
                scales: 1,
                ..GaborParams::default()
            };
            let bank = FilterBank::plan(params, size).unwrap();
            let mut workspace = RowWorkspace::new();
            let parts = 2 * orientations;
            let mut by_pixel = vec![0.0; 2 * size.width * parts];
            let mut by_part = by_pixel.clone();
            bank.respond_rows_into(&image, 3, &mut workspace, &mut by_pixel)
                .unwrap();
            bank.respond_row_parts_into(&image, 3, &mut workspace, &mut by_part)
                .unwrap();
            for y in 0..2 {
                for part in 0..parts {
                    for x in 0..size.width {
                        let pixel = by_pixel[(y * size.width + x) * parts + part];
                        assert_eq!(by_part[(y * parts + part) * size.width + x], pixel);
                    }
                }
            }
        }
    }

    /// What a workspace and responses held before, of this or of another bank, leaves no trace.
    #[test]
    fn a_second_frame_is_like_a_first() {
        let (size, other) = (
            Size {
                width: 61,
                height: 47,
            },
            Size {
                width: 40,
                height: 90,
            },
        );
        let bank =
            |size: Size| FilterBank::plan(GaborParams::default().fitted_to(size), size).unwrap();
        let mut workspace = bank(other).workspace();
        let mut responses = bank(other).respond(&noise(other, 5)).unwrap();
        for seed in [1, 2, 3] {
            let image = noise(size, seed);
            bank(size)
                .respond_into(&image, &mut workspace, &mut responses)
                .unwrap();
            assert_eq!(responses, bank(size).respond(&image).unwrap());
        }
    }
}
