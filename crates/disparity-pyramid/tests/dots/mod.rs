//! Random dots that are known at every place, and noise.
#![allow(dead_code, reason = "each test file uses a part of it")]

/// Dots of either sign, one to each cell of a grid at a random place in it: Gaussians of 0.9 px,
/// known at every place.
pub(crate) struct Dots {
    pub(crate) seed: u64,
}

impl Dots {
    const CELL_PX: f64 = 2.5;
    const SIGMA_PX: f64 = 0.9;

    pub(crate) fn at(&self, x: f64, y: f64) -> f32 {
        let cell = |at: f64| (at / Self::CELL_PX).floor() as i64;
        let mut sum = 0.5;
        for row in cell(y) - 2..=cell(y) + 2 {
            for column in cell(x) - 2..=cell(x) + 2 {
                let [across, down, sign] = self.random(column, row);
                let dot = |cell: i64, within: f64| (cell as f64 + within) * Self::CELL_PX;
                let far = (x - dot(column, across)).hypot(y - dot(row, down)) / Self::SIGMA_PX;
                sum += 0.2 * (2.0 * sign - 1.0) * (-0.5 * far * far).exp();
            }
        }
        sum as f32
    }

    /// Three numbers in `[0, 1)` for a cell.
    fn random(&self, column: i64, row: i64) -> [f64; 3] {
        let mut state = self.seed ^ (column as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        state =
            (state ^ (state >> 29)).wrapping_add((row as u64).wrapping_mul(0xBF58_476D_1CE4_E5B9));
        [0; 3].map(|_| {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut mixed = state;
            mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
        })
    }
}

/// White noise: nearly Gaussian, one number a pixel.
pub(crate) struct Noise {
    numbers: Dots,
    sigma: f32,
}

impl Noise {
    pub(crate) fn new(seed: u64, sigma: f32) -> Self {
        Self {
            numbers: Dots { seed },
            sigma,
        }
    }

    /// The sum of twelve uniform numbers has a variance of 1.
    pub(crate) fn at(&self, x: f64, y: f64) -> f32 {
        let of = |k: i64| self.numbers.random(x as i64 + 7919 * k, y as i64);
        let sum: f64 = (1..=4).flat_map(of).sum();
        self.sigma * (sum - 6.0) as f32
    }
}
