use pulp::Simd;

/// Puts the smaller of each two values at the first place and the larger at the second, lane by
/// lane, as straight-line code. Plain arrays in place of vectors take fifteen times as long: the
/// compiler does not find the vectors in this much straight-line code.
macro_rules! exchange {
    ($simd:ident, $values:ident: $($low:literal $high:literal),+) => {{
        $(
            let (a, b) = ($values[$low], $values[$high]);
            $values[$low] = $simd.min_f32s(a, b);
            $values[$high] = $simd.max_f32s(a, b);
        )+
    }};
}

/// The median of nine values in each lane: the exchanges of Batcher's odd-even merge sort that the
/// middle place depends on.
#[inline(always)]
pub(crate) fn median_of_9<S: Simd>(simd: S, mut values: [S::f32s; 9]) -> S::f32s {
    exchange!(simd, values:
            0 1, 2 3, 4 5, 6 7, 0 2, 1 3, 4 6, 5 7, 1 2, 5 6, 0 4, 1 5, 2 6, 3 7, 2 4, 3 5, 1 2,
            3 4, 5 6, 0 8, 4 8, 2 4, 3 5, 3 4
    );
    values[4]
}

/// Five values of each lane in ascending order.
#[inline(always)]
pub(crate) fn sorted_5<S: Simd>(simd: S, mut values: [S::f32s; 5]) -> [S::f32s; 5] {
    exchange!(simd, values: 0 3, 1 4, 0 2, 1 3, 0 1, 2 4, 1 2, 3 4, 2 3);
    values
}

/// The median of twenty-five values in each lane that stand in five rows of five, each column in
/// ascending order, and the next larger one: a sorting of each row and of the thirteen that can be in the
/// middle then, without the exchanges that no input of zeros and ones needs. The least of what is left above
/// the median is the next one.
#[inline(always)]
pub(crate) fn middle_of_5_columns<S: Simd>(simd: S, mut values: [S::f32s; 25]) -> [S::f32s; 2] {
    exchange!(simd, values:
            0 3, 1 3, 0 1, 2 4, 1 2, 3 4, 2 3, 5 8, 5 7, 6 8, 5 6, 7 9, 6 7, 8 9, 7 8, 10 13, 11 14,
            10 12, 10 11, 12 14, 13 14, 16 19, 15 17, 16 18, 15 16, 17 19, 16 17, 17 18, 20 23, 21
            24, 20 22, 21 23, 20 21, 22 24, 21 22, 7 15, 21 3, 8 17, 11 20, 13 12, 15 3, 8 16, 11
            13, 20 12, 15 21, 17 16, 20 13, 3 4, 21 8, 3 17, 13 9, 3 8, 20 13, 8 11, 17 20, 16 13, 3
            17, 16 11, 17 16
    );
    let mut next = values[4];
    for above in [9, 11, 12, 20] {
        next = simd.min_f32s(next, values[above]);
    }
    [values[16], next]
}

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;

    /// The medians of nine zeros and ones, of as many inputs as a vector has lanes, from a first one on.
    struct ZerosAndOnes(u32);

    impl WithSimd for ZerosAndOnes {
        type Output = usize;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> usize {
            let Self(first) = self;
            let bit = |i: usize| {
                let lanes: [f32; 16] =
                    std::array::from_fn(|lane| f32::from(((first + lane as u32) >> i & 1) as u8));
                S::as_simd_f32s(&lanes).0[0]
            };
            let medians = median_of_9(simd, std::array::from_fn(bit));
            let mut lanes = [0.0; 16];
            S::as_mut_simd_f32s(&mut lanes).0[0] = medians;
            for (lane, median) in lanes[..S::F32_LANES].iter().enumerate() {
                let ones = (first + lane as u32).count_ones();
                assert_eq!(*median, f32::from(u8::from(ones > 4)));
            }
            S::F32_LANES
        }
    }

    /// A network of exchanges that gives the right median for every input of zeros and ones gives
    /// it for every input (the 0-1 principle), so trying those is a proof.
    #[test]
    fn nine_zeros_and_ones() {
        let mut first = 0;
        while first < 1 << 9 {
            first += Arch::new().dispatch(ZerosAndOnes(first)) as u32;
        }
    }

    /// Sorted columns are so many ones at the end of each.
    struct SortedColumns([usize; 5]);

    impl WithSimd for SortedColumns {
        type Output = ([f32; 2], [f32; 5]);

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let Self(ones) = self;
            let is_one = |x: usize, y: usize| f32::from(u8::from(y >= 5 - ones[x]));
            let value = |i: usize| simd.splat_f32s(is_one(i % 5, i / 5));
            let first = |values: S::f32s| {
                let mut lanes = [0.0; 16];
                S::as_mut_simd_f32s(&mut lanes).0[0] = values;
                lanes[0]
            };
            let middle = middle_of_5_columns(simd, std::array::from_fn(value));
            // The bits of the first number, in the order that they happen to have.
            let bit = |i: usize| {
                let number = ones[0] * 6 + ones[1];
                simd.splat_f32s(f32::from(((number >> i) & 1) as u8))
            };
            (
                middle.map(first),
                sorted_5(simd, std::array::from_fn(bit)).map(first),
            )
        }
    }

    #[test]
    fn five_columns_of_zeros_and_ones() {
        for number in 0..6usize.pow(5) {
            let ones = [0, 1, 2, 3, 4].map(|x| number / 6usize.pow(x) % 6);
            let ([median, next], sorted) = Arch::new().dispatch(SortedColumns(ones));
            let sum: usize = ones.iter().sum();
            assert_eq!(median, f32::from(u8::from(sum > 12)), "{ones:?}");
            assert_eq!(next, f32::from(u8::from(sum > 11)), "{ones:?}");
            assert!(sorted.is_sorted());
            let bits = ((ones[0] * 6 + ones[1]) & 31).count_ones();
            assert_eq!(sorted.iter().sum::<f32>(), bits as f32);
        }
    }
}
