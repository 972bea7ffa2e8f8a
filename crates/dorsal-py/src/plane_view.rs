use ndarray::ArrayView2;
use numpy::{Element, PyArray2, PyArrayMethods as _};
use pyo3::pyclass::boolean_struct::True;
use pyo3::{Bound, PyClass};

/// A plane that `owner` keeps, as NumPy sees it: no copy, and read-only; `None` if it keeps none.
pub(crate) fn plane_view<'py, O, T>(
    owner: &Bound<'py, O>,
    plane: impl for<'a> FnOnce(&'a O) -> Option<ArrayView2<'a, T>>,
) -> Option<Bound<'py, PyArray2<T>>>
where
    O: PyClass<Frozen = True> + Sync,
    T: Element,
{
    let kept = plane(owner.get())?;
    // SAFETY: the plane is borrowed from a frozen object, which Rust reaches by shared reference only and in which
    // nothing is mutable within: it is neither moved nor written as long as that object lives. The array holds a
    // reference to the object, and cannot be made writable, as it does not own its data.
    #[allow(
        unsafe_code,
        reason = "a copy of every plane costs a megapixel 0.4 ms each, and no safe form shares it"
    )]
    let array = unsafe { PyArray2::borrow_from_array(&kept, owner.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    Some(array)
}
