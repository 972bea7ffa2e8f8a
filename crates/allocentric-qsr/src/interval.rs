use std::ops::{Add, Mul, Sub};

/// Every number from `low` to `high`; each operation rounds its ends outward by one step, so the
/// result contains what exact arithmetic gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Interval {
    pub(crate) const fn point(at: f64) -> Self {
        Self { low: at, high: at }
    }

    fn outward(low: f64, high: f64) -> Self {
        Self {
            low: low.next_down(),
            high: high.next_up(),
        }
    }

    /// The interval of the absolute values.
    pub(crate) fn magnitude(self) -> Self {
        if self.low <= 0.0 && self.high >= 0.0 {
            Self {
                low: 0.0,
                high: self.high.max(-self.low),
            }
        } else {
            let [a, b] = [self.low.abs(), self.high.abs()];
            Self {
                low: a.min(b),
                high: a.max(b),
            }
        }
    }

    /// The length of a vector with these parts.
    pub(crate) fn hypot(self, other: Self) -> Self {
        let [a, b] = [self.magnitude(), other.magnitude()];
        // The platform's hypot is within one step of the truth.
        let length = Self::outward(a.low.hypot(b.low), a.high.hypot(b.high));
        Self {
            low: length.low.max(0.0),
            high: length.high,
        }
    }

    /// The signs a number of the interval may have.
    pub(crate) fn signs(self) -> impl Iterator<Item = i8> + Clone {
        let possible = [
            (-1, self.low < 0.0),
            (0, self.low <= 0.0 && self.high >= 0.0),
            (1, self.high > 0.0),
        ];
        possible
            .into_iter()
            .filter_map(|(sign, may)| may.then_some(sign))
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::outward(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low)
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let ends = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        Self::outward(
            ends.into_iter().fold(f64::INFINITY, f64::min),
            ends.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn intervals() -> impl Strategy<Value = (Interval, f64)> {
        (-5.0..5.0f64, 0.0..3.0f64, 0.0..=1.0f64).prop_map(|(low, wide, at)| {
            let high = low + wide;
            (Interval { low, high }, (low + at * wide).clamp(low, high))
        })
    }

    proptest! {
        /// Whatever numbers are true, the result contains what they give.
        #[test]
        fn results_contain_the_truth((a, x) in intervals(), (b, y) in intervals()) {
            let holds = |interval: Interval, value: f64| interval.low <= value && value <= interval.high;
            prop_assert!(holds(a + b, x + y));
            prop_assert!(holds(a - b, x - y));
            prop_assert!(holds(a * b, x * y));
            prop_assert!(holds(a.magnitude(), x.abs()));
            prop_assert!(holds(a.hypot(b), x.hypot(y)));
        }
    }
}
