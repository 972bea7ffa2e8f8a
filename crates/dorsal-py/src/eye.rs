use dorsal::disparity_pyramid::EyeView;
use dorsal::v1_gabor::{Binocular, LumaImage, Size};
use ndarray::{Array2, ArrayView3, CowArray, Ix2};
use numpy::{
    Element, IntoPyArray as _, PyArray2, PyArray3, PyArrayMethods as _, PyUntypedArray,
    PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;
use stereo_formats::picture::{Picture, Samples};

use crate::refusal::value_error;

/// Luma beyond which floats are not from 0 to 1 but codes of a camera.
const MOST_LUMA: f32 = 16.0;

/// What one eye sees, as an array says it.
#[derive(Debug)]
pub(crate) enum Eye {
    /// Codes of a camera, read as the command reads a file.
    Picture(Picture),
    /// Luma alone.
    Luma(LumaImage),
}

impl Eye {
    /// Takes an array `(height, width)` of `uint8`, `uint16`, `float32` or `float64`, or `(height, width, 3 or 4)` of
    /// the first two, of any strides. `name` is the argument's.
    pub(crate) fn of(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Ok(untyped) = array.cast::<PyUntypedArray>() else {
            return Err(value_error(format!("{name} is no NumPy array")));
        };
        let shape = untyped.shape();
        let grey = match shape {
            [_, _] => true,
            [_, _, 3 | 4] => false,
            _ => {
                return Err(value_error(format!(
                    "{name} has shape {shape:?}; a picture is (height, width) or (height, width, 3)"
                )));
            }
        };
        let named = |why: &dyn std::fmt::Display| value_error(format!("{name}: {why}"));
        let samples = if grey {
            if let Ok(codes) = array.cast::<PyArray2<u8>>() {
                Samples::Grey8(owned(name, codes)?)
            } else if let Ok(codes) = array.cast::<PyArray2<u16>>() {
                Samples::Grey16(owned(name, codes)?)
            } else if let Ok(luma) = array.cast::<PyArray2<f32>>() {
                return Self::of_luma(name, owned(name, luma)?);
            } else if let Ok(luma) = array.cast::<PyArray2<f64>>() {
                let readonly = luma.try_readonly().map_err(|why| named(&why))?;
                return Self::of_luma(name, readonly.as_array().mapv(|luma| luma as f32));
            } else {
                return Err(wrong_dtype(
                    name,
                    untyped,
                    "uint8, uint16, float32 or float64",
                ));
            }
        } else if let Ok(codes) = array.cast::<PyArray3<u8>>() {
            let readonly = codes.try_readonly().map_err(|why| named(&why))?;
            Samples::Rgb8(colours(readonly.as_array()))
        } else if let Ok(codes) = array.cast::<PyArray3<u16>>() {
            let readonly = codes.try_readonly().map_err(|why| named(&why))?;
            Samples::Rgb16(colours(readonly.as_array()))
        } else {
            return Err(wrong_dtype(name, untyped, "uint8 or uint16, for colours"));
        };
        let picture = Picture::of_samples(samples).map_err(|why| named(&why))?;
        Ok(Self::Picture(picture))
    }

    fn of_luma(name: &str, luma: Array2<f32>) -> PyResult<Self> {
        let luma = LumaImage::new(luma).map_err(|why| value_error(format!("{name}: {why}")))?;
        // A fold without a way out walks whole registers; a search would look at sample after sample.
        let most = luma
            .plane()
            .fold(0.0, |most: f32, luma| most.max(luma.abs()));
        if most > MOST_LUMA {
            return Err(value_error(format!(
                "{name} reaches {most}; floats are luma from 0 (black) to 1 (white): divide by the largest code"
            )));
        }
        Ok(Self::Luma(luma))
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
}

/// Both eyes of a look, of one size.
pub(crate) fn both_eyes(
    left: &Bound<'_, PyAny>,
    right: &Bound<'_, PyAny>,
) -> PyResult<Binocular<Eye>> {
    let eyes = Binocular {
        left: Eye::of("left", left)?,
        right: Eye::of("right", right)?,
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
    let plane = match Eye::of("image", image)? {
        Eye::Picture(picture) => picture.into_luma().into_plane(),
        Eye::Luma(luma) => luma.into_plane(),
    };
    Ok(plane.into_pyarray(py))
}

/// A copy of a plane, of any strides: Python may write into the array while the levels run without its lock.
pub(crate) fn owned<T: Element + Copy>(
    name: &str,
    array: &Bound<'_, PyArray2<T>>,
) -> PyResult<Array2<T>> {
    let readonly = array
        .try_readonly()
        .map_err(|why| value_error(format!("{name}: {why}")))?;
    Ok(readonly.as_array().as_standard_layout().into_owned())
}

fn wrong_dtype(name: &str, array: &Bound<'_, PyUntypedArray>, wanted: &str) -> PyErr {
    value_error(format!(
        "{name} holds {}; wanted is {wanted}",
        array.dtype()
    ))
}

/// The first three channels of every pixel.
fn colours<T: Copy>(codes: ArrayView3<'_, T>) -> Array2<[T; 3]> {
    let (height, width, channels) = codes.dim();
    let packed = codes.as_slice().filter(|_| channels == 3);
    let packed = packed.and_then(|codes| {
        let pixels = codes.as_chunks::<3>().0.to_vec();
        Array2::from_shape_vec((height, width), pixels).ok()
    });
    packed.unwrap_or_else(|| {
        Array2::from_shape_fn((height, width), |(y, x)| {
            [codes[[y, x, 0]], codes[[y, x, 1]], codes[[y, x, 2]]]
        })
    })
}
