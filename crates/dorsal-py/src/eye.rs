use std::thread;

use dorsal::disparity_pyramid::EyeView;
use dorsal::v1_gabor::{Binocular, LumaImage, Size};
use ndarray::{Array2, CowArray, Ix2};
use numpy::{IntoPyArray as _, PyArray2};
use pyo3::prelude::*;
use stereo_formats::picture::Picture;

use crate::eye_array::EyeArray;
use crate::plane_store;
use crate::refusal::value_error;

/// From so many pixels on the two eyes are read by two threads: below, starting one costs more.
const PIXELS_FOR_TWO: usize = 1 << 17;

/// What one eye sees, as an array says it.
#[derive(Debug)]
pub(crate) enum Eye {
    /// Codes of a camera, read as the command reads a file.
    Picture(Picture),
    /// Luma alone.
    Luma(LumaImage),
}

/// What of an eye is wanted beside its luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Nothing: no colour is copied.
    Luma,
    /// The colours too, as guides of the dense estimators and of segments.
    Colours,
}

impl Eye {
    /// Takes an array; see [`EyeArray::of`]. `name` is the argument's.
    pub(crate) fn of(name: &str, array: &Bound<'_, PyAny>, wanted: Wanted) -> PyResult<Self> {
        let array = EyeArray::of(name, array)?;
        let eye = array.view().read(wanted);
        eye.map_err(|why| value_error(format!("{name}{why}")))
    }

    pub(crate) const fn luma(&self) -> &LumaImage {
        match self {
            Self::Picture(picture) => picture.luma(),
            Self::Luma(luma) => luma,
        }
    }

    pub(crate) fn size(&self) -> Size {
        self.luma().size()
    }

    /// As the dense estimator sees it.
    pub(crate) fn view(&self) -> EyeView<'_> {
        match self {
            Self::Picture(picture) => EyeView {
                luma: picture.luma(),
                rgb: Some(picture.rgb()),
            },
            Self::Luma(luma) => EyeView::grey(luma),
        }
    }

    /// Red, green and blue; of luma alone three equal ones, which saturate.
    pub(crate) fn rgb(&self) -> CowArray<'_, [u8; 3], Ix2> {
        match self {
            Self::Picture(picture) => picture.rgb().into(),
            Self::Luma(luma) => {
                let grey = |luma: f32| [(255.0 * luma).round() as u8; 3];
                luma.plane().mapv(grey).into()
            }
        }
    }

    /// Gives the plane back for the next look.
    pub(crate) fn keep(self) {
        if let Self::Luma(luma) = self {
            let (plane, start) = luma.into_plane().into_raw_vec_and_offset();
            if start.unwrap_or(0) == 0 {
                plane_store::keep(plane);
            }
        }
    }
}

/// Both eyes of a look, of one size.
///
/// Arrays are read while Python's lock is held, so that nobody writes into them meanwhile.
pub(crate) fn both_eyes(
    left: &Bound<'_, PyAny>,
    right: &Bound<'_, PyAny>,
    wanted: Wanted,
) -> PyResult<Binocular<Eye>> {
    let arrays = Binocular {
        left: EyeArray::of("left", left)?,
        right: EyeArray::of("right", right)?,
    };
    let views = arrays.as_ref().map(EyeArray::view);
    let (left, right) = if views.left.pixels() < PIXELS_FOR_TWO {
        (views.left.read(wanted), views.right.read(wanted))
    } else {
        thread::scope(|scope| {
            let right = scope.spawn(|| views.right.read(wanted));
            let left = views.left.read(wanted);
            let right = right.join();
            (
                left,
                right.unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            )
        })
    };
    let named = |name: &'static str| move |why: String| value_error(format!("{name}{why}"));
    let eyes = Binocular {
        left: left.map_err(named("left"))?,
        right: right.map_err(named("right"))?,
    };
    let (left, right) = (eyes.left.size(), eyes.right.size());
    if left == right {
        Ok(eyes)
    } else {
        Err(value_error(format!(
            "left has {left} pixels and right has {right}; the two eyes need pictures of one size"
        )))
    }
}

/// The luma that the first level sees of a picture, from 0 (black) to 1 (white).
#[pyfunction]
pub(crate) fn luma<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let plane: Array2<f32> = match Eye::of("image", image, Wanted::Luma)? {
        Eye::Picture(picture) => picture.into_luma().into_plane(),
        Eye::Luma(luma) => luma.into_plane(),
    };
    Ok(plane.into_pyarray(py))
}
