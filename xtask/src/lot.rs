/// Numbers that look drawn by lot and are the same on every machine.
#[derive(Clone, Debug)]
pub(crate) struct Lot(u64);

impl Lot {
    /// The numbers of this seed.
    pub(crate) fn new(seed: u64) -> Self {
        let mut lot = Self(seed);
        // Seeds next to each other begin with numbers next to each other.
        for _ in 0..4 {
            lot.below(2);
        }
        lot
    }

    /// A number below the bound.
    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        // Knuth's MMIX constants; the upper bits are the good ones.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_even_and_the_same() {
        let mut lot = Lot::new(7);
        let mut counts = [0u32; 6];
        for _ in 0..60_000 {
            counts[lot.below(6) as usize] += 1;
        }
        // Six standard deviations of a die thrown so often are 550.
        assert!(counts.iter().all(|count| count.abs_diff(10_000) < 550));
        let again: Vec<u64> = std::iter::repeat_with(|| lot.clone().below(9))
            .take(2)
            .collect();
        assert_eq!(again[0], again[1]);
    }
}
