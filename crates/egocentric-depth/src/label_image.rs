use ndarray::{Array2, ArrayView2};
use v1_gabor::Size;

/// The number that marks one object in a [`LabelImage`]; never 0, which marks no object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Label(pub std::num::NonZeroU16);

/// Which object each pixel of the left image shows: 0 for none, else its [`Label`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelImage {
    labels: Array2<u16>,
}

impl LabelImage {
    /// Takes a plane `[[y, x]]` of label numbers, 0 for no object.
    #[must_use]
    pub const fn new(labels: Array2<u16>) -> Self {
        Self { labels }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        Size::of_dim(self.labels.dim())
    }

    /// The object at a pixel; `None` where there is none, and outside the image.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<Label> {
        let number = *self.labels.get((y, x))?;
        std::num::NonZeroU16::new(number).map(Label)
    }

    /// The plane `[[y, x]]` of label numbers, 0 for no object.
    #[must_use]
    pub fn plane(&self) -> ArrayView2<'_, u16> {
        self.labels.view()
    }

    /// Every object that has at least one pixel, in ascending order.
    #[must_use]
    pub fn labels(&self) -> Vec<Label> {
        // A table of all numbers there can be costs less than a set asked at every pixel.
        let mut present = vec![false; usize::from(u16::MAX) + 1];
        for &number in &self.labels {
            present[usize::from(number)] = true;
        }
        (0..=u16::MAX)
            .filter(|&number| present[usize::from(number)])
            .filter_map(std::num::NonZeroU16::new)
            .map(Label)
            .collect()
    }
}
