use ndarray::Array2;
use v1_gabor::Size;

/// Makes a plane of another size one of this, all `value`; one of this size stays as it is.
pub(crate) fn fit<T: Clone>(plane: &mut Array2<T>, size: Size, value: T) {
    if plane.dim() != size.dim() {
        *plane = Array2::from_elem(size.dim(), value);
    }
}

/// The numbers of a plane, row after row.
pub(crate) fn numbers<T>(plane: &mut Array2<T>) -> &mut [T] {
    plane
        .as_slice_mut()
        .expect("planes are made in row-major order")
}
