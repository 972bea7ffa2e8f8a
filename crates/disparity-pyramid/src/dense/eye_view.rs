use ndarray::ArrayView2;
use v1_gabor::LumaImage;

/// What one eye sees, as the dense estimator takes it: luma for the phases, and colour, where the
/// camera has it, to tell where one surface ends.
#[derive(Clone, Copy, Debug)]
pub struct EyeView<'a> {
    /// The luma, by habit in `[0, 1]`.
    pub luma: &'a LumaImage,
    /// Red, green and blue `[[y, x]]` of the same picture; without it the luma stands in.
    pub rgb: Option<ArrayView2<'a, [u8; 3]>>,
}

impl<'a> EyeView<'a> {
    /// A grey picture.
    #[must_use]
    pub const fn grey(luma: &'a LumaImage) -> Self {
        Self { luma, rgb: None }
    }
}
