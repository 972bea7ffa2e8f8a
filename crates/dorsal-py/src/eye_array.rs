use dorsal::v1_gabor::LumaImage;
use ndarray::{Array2, ArrayView2, ArrayView3};
use numpy::{
    Element, PyArray, PyArrayMethods as _, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArray,
    PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;
use stereo_formats::code_luma::luma_into;
use stereo_formats::picture::{Picture, Samples};

use crate::eye::{Eye, Wanted};
use crate::plane_store::plane_of;
use crate::refusal::value_error;

/// Luma beyond which floats are not from 0 to 1 but codes of a camera.
const MOST_LUMA: f32 = 16.0;

/// An array of what an eye sees, held so that no Rust code writes into it.
pub(crate) enum EyeArray<'py> {
    Grey8(PyReadonlyArray2<'py, u8>),
    Grey16(PyReadonlyArray2<'py, u16>),
    Luma32(PyReadonlyArray2<'py, f32>),
    Luma64(PyReadonlyArray2<'py, f64>),
    Colour8(PyReadonlyArray3<'py, u8>),
    Colour16(PyReadonlyArray3<'py, u16>),
}

/// The same as a plane of samples, of any strides; colours are 3 or 4 channels, of which the first three count.
#[derive(Clone, Copy, Debug)]
pub(crate) enum EyeSamples<'a> {
    Grey8(ArrayView2<'a, u8>),
    Grey16(ArrayView2<'a, u16>),
    Luma32(ArrayView2<'a, f32>),
    Luma64(ArrayView2<'a, f64>),
    Colour8(ArrayView3<'a, u8>),
    Colour16(ArrayView3<'a, u16>),
}

impl<'py> EyeArray<'py> {
    /// Takes an array `(height, width)` of `uint8`, `uint16`, `float32` or `float64`, or `(height, width, 3 or 4)` of
    /// the first two, of any strides. `name` is the argument's.
    pub(crate) fn of(name: &str, array: &Bound<'py, PyAny>) -> PyResult<Self> {
        let Ok(untyped) = array.cast::<PyUntypedArray>() else {
            return Err(value_error(format!("{name} is no NumPy array")));
        };
        let shape = untyped.shape();
        let (found, wanted) = match shape {
            [_, _] => {
                let found = if let Some(codes) = held(name, array)? {
                    Some(Self::Grey8(codes))
                } else if let Some(codes) = held(name, array)? {
                    Some(Self::Grey16(codes))
                } else if let Some(luma) = held(name, array)? {
                    Some(Self::Luma32(luma))
                } else {
                    held(name, array)?.map(Self::Luma64)
                };
                (found, "uint8, uint16, float32 or float64")
            }
            [_, _, 3 | 4] => {
                let found = match held(name, array)? {
                    Some(codes) => Some(Self::Colour8(codes)),
                    None => held(name, array)?.map(Self::Colour16),
                };
                (found, "uint8 or uint16, for colours")
            }
            _ => {
                return Err(value_error(format!(
                    "{name} has shape {shape:?}; a picture is (height, width) or (height, width, 3)"
                )));
            }
        };
        found.ok_or_else(|| {
            value_error(format!(
                "{name} holds {}; wanted is {wanted}",
                untyped.dtype()
            ))
        })
    }

    /// The samples.
    pub(crate) fn view(&self) -> EyeSamples<'_> {
        match self {
            Self::Grey8(codes) => EyeSamples::Grey8(codes.as_array()),
            Self::Grey16(codes) => EyeSamples::Grey16(codes.as_array()),
            Self::Luma32(luma) => EyeSamples::Luma32(luma.as_array()),
            Self::Luma64(luma) => EyeSamples::Luma64(luma.as_array()),
            Self::Colour8(codes) => EyeSamples::Colour8(codes.as_array()),
            Self::Colour16(codes) => EyeSamples::Colour16(codes.as_array()),
        }
    }
}

/// The array, if it holds what is asked for.
fn held<'py, T: Element, D: ndarray::Dimension>(
    name: &str,
    array: &Bound<'py, PyAny>,
) -> PyResult<Option<numpy::PyReadonlyArray<'py, T, D>>> {
    let Ok(array) = array.cast::<PyArray<T, D>>() else {
        return Ok(None);
    };
    let readonly = array.try_readonly();
    let readonly = readonly.map_err(|why| value_error(format!("{name}: {why}")))?;
    Ok(Some(readonly))
}

impl EyeSamples<'_> {
    pub(crate) fn pixels(&self) -> usize {
        match self {
            Self::Grey8(codes) => codes.len(),
            Self::Grey16(codes) => codes.len(),
            Self::Luma32(luma) => luma.len(),
            Self::Luma64(luma) => luma.len(),
            Self::Colour8(codes) => codes.dim().0 * codes.dim().1,
            Self::Colour16(codes) => codes.dim().0 * codes.dim().1,
        }
    }

    /// A copy as the levels take it.
    ///
    /// # Errors
    /// What is wrong, to be said after the argument's name.
    pub(crate) fn read(self, wanted: Wanted) -> Result<Eye, String> {
        let samples = match self {
            Self::Luma32(luma) => return of_luma(copied(luma, |luma| luma)),
            Self::Luma64(luma) => return of_luma(copied(luma, |luma| luma as f32)),
            Self::Grey8(codes) if wanted == Wanted::Luma => {
                return of_codes(copied(codes, |code| f32::from(code) / 255.0));
            }
            Self::Grey16(codes) if wanted == Wanted::Luma => {
                return of_codes(copied(codes, |code| f32::from(code) / 65535.0));
            }
            Self::Colour8(codes) if wanted == Wanted::Luma => return of_codes(luma_of(codes)),
            Self::Grey8(codes) => Samples::Grey8(codes.as_standard_layout().into_owned()),
            Self::Grey16(codes) => Samples::Grey16(codes.as_standard_layout().into_owned()),
            Self::Colour8(codes) => Samples::Rgb8(colours(codes)),
            Self::Colour16(codes) => Samples::Rgb16(colours(codes)),
        };
        let picture = Picture::of_samples(samples).map_err(|why| format!(": {why}"))?;
        Ok(Eye::Picture(picture))
    }
}

/// A plane of samples, in a plane that is kept for them.
fn copied<T: Copy>(samples: ArrayView2<'_, T>, luma: impl Fn(T) -> f32) -> Array2<f32> {
    let mut plane = stored(samples.dim());
    match (plane.as_slice_mut(), samples.as_slice()) {
        (Some(plane), Some(samples)) => {
            for (plane, sample) in plane.iter_mut().zip(samples) {
                *plane = luma(*sample);
            }
        }
        _ => plane.zip_mut_with(&samples, |plane, sample| *plane = luma(*sample)),
    }
    plane
}

/// The luma of colours of 8 bits.
fn luma_of(codes: ArrayView3<'_, u8>) -> Array2<f32> {
    let (height, width, channels) = codes.dim();
    let mut plane = stored((height, width));
    for (mut plane, row) in plane.outer_iter_mut().zip(codes.outer_iter()) {
        let packed = row.as_slice().filter(|_| channels == 3);
        match (plane.as_slice_mut(), packed) {
            (Some(plane), Some(row)) => luma_into(row.as_chunks::<3>().0, plane),
            _ => {
                for (x, plane) in plane.iter_mut().enumerate() {
                    let rgb = [row[[x, 0]], row[[x, 1]], row[[x, 2]]];
                    luma_into(&[rgb], std::slice::from_mut(plane));
                }
            }
        }
    }
    plane
}

fn stored(dim: (usize, usize)) -> Array2<f32> {
    let plane = plane_of(dim.0 * dim.1);
    Array2::from_shape_vec(dim, plane).unwrap_or_else(|_| Array2::zeros(dim))
}

/// Luma that was made of codes.
fn of_codes(luma: Array2<f32>) -> Result<Eye, String> {
    let luma = LumaImage::new(luma).map_err(|why| format!(": {why}"))?;
    Ok(Eye::Luma(luma))
}

/// Luma that a caller has made.
fn of_luma(luma: Array2<f32>) -> Result<Eye, String> {
    let luma = LumaImage::new(luma).map_err(|why| format!(": {why}"))?;
    // A fold without a way out walks whole registers; a search would look at sample after sample.
    let most = luma
        .plane()
        .fold(0.0, |most: f32, luma| most.max(luma.abs()));
    if most > MOST_LUMA {
        return Err(format!(
            " reaches {most}; floats are luma from 0 (black) to 1 (white): divide by the largest code"
        ));
    }
    Ok(Eye::Luma(luma))
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
