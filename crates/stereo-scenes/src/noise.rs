/// Smooth random values over space: one octave of a texture, between -1 and 1.
///
/// Every integer point of space carries a random value, fixed by `seed`; between them the values
/// run smoothly (a quintic blend, so that the slope has no step at the lattice). Detail is about
/// two units wide and nothing is finer than one unit.
#[inline]
pub(crate) fn value_noise([x, y, z]: [f32; 3], seed: u32) -> f32 {
    let ((x, u), (y, v), (z, w)) = (cell(x), cell(y), cell(z));
    let (x0, y0, z0) = (
        x.wrapping_mul(X_STEP),
        y.wrapping_mul(Y_STEP),
        z.wrapping_mul(Z_STEP).wrapping_add(seed),
    );
    let (x1, y1, z1) = (
        x0.wrapping_add(X_STEP),
        y0.wrapping_add(Y_STEP),
        z0.wrapping_add(Z_STEP),
    );
    // Written as arrays so that the compiler does the eight corners in vector registers.
    let xs = [x0, x1, x0, x1, x0, x1, x0, x1];
    let ys = [y0, y0, y1, y1, y0, y0, y1, y1];
    let zs = [z0, z0, z0, z0, z1, z1, z1, z1];
    let mut corner = [0.0; 8];
    for k in 0..8 {
        corner[k] = random(xs[k] ^ ys[k] ^ zs[k]);
    }
    let mut edge = [0.0; 4];
    for k in 0..4 {
        edge[k] = corner[2 * k] + u * (corner[2 * k + 1] - corner[2 * k]);
    }
    let near = edge[0] + v * (edge[1] - edge[0]);
    let far = edge[2] + v * (edge[3] - edge[2]);
    near + w * (far - near)
}

/// Odd and far from each other, so that neighbouring lattice points share few bits.
const X_STEP: u32 = 0x9E37_79B1;
const Y_STEP: u32 = 0x85EB_CA77;
const Z_STEP: u32 = 0xC2B2_AE3D;

/// The lattice point below, and the blended way to the next one.
#[inline]
fn cell(x: f32) -> (u32, f32) {
    // `floor` is a call into the C library on machines without SSE 4.1; this is three instructions.
    let truncated = x as i32;
    let below = truncated - i32::from(truncated as f32 > x);
    let t = x - below as f32;
    (below as u32, t * t * t * (t * (t * 6.0 - 15.0) + 10.0))
}

/// A number between -1 and 1 from a lattice point's bits.
#[inline]
fn random(bits: u32) -> f32 {
    // Half of `mix`: the steps have already spread the coordinates over the bits.
    let bits = (bits ^ (bits >> 15)).wrapping_mul(0x846C_A68B);
    ((bits ^ (bits >> 16)) >> 8) as i32 as f32 * (1.0 / 8_388_608.0) - 1.0
}

/// Spreads every bit of a number over all bits: an integer hash.
#[inline]
pub(crate) const fn mix(bits: u32) -> u32 {
    let bits = (bits ^ (bits >> 16)).wrapping_mul(0x7FEB_352D);
    let bits = (bits ^ (bits >> 15)).wrapping_mul(0x846C_A68B);
    bits ^ (bits >> 16)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Noise stays in its range and has no step: across a lattice plane too.
        #[test]
        fn noise_is_bounded_and_continuous(
            x in -500.0f32..500.0, y in -500.0f32..500.0, z in -500i16..500, seed: u32,
        ) {
            let z = f32::from(z);
            let (below, above) = (
                value_noise([x, y, z - 1e-4], seed),
                value_noise([x, y, z + 1e-4], seed),
            );
            prop_assert!(below.abs() <= 1.0 && above.abs() <= 1.0);
            // The blend is flat at the lattice, so only the rounding of x and y remains.
            prop_assert!((below - above).abs() < 1e-3);
        }
    }

    /// The mean is near zero and the values spread, for every seed: nothing is constant.
    #[test]
    fn noise_has_no_mean_and_some_spread() {
        for seed in 0..8 {
            let values: Vec<f32> = (0..4000)
                .map(|k| k as f32)
                .map(|k| value_noise([k * 0.37, k * 0.21, k * 0.11], mix(seed)))
                .collect();
            let mean = values.iter().sum::<f32>() / 4000.0;
            let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / 4000.0).sqrt();
            // Some thousand independent cells of spread 0.3: a mean of 0.05 is beyond 5 sigma.
            assert!(mean.abs() < 0.05, "seed {seed}: mean {mean}");
            assert!(
                (0.2..0.45).contains(&spread),
                "seed {seed}: spread {spread}"
            );
        }
    }
}
