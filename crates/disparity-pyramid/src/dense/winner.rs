use crate::dense::pixel_cost::LANES;
use crate::dense::wide::Wide;

/// The shift whose paths cost least at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Winner {
    /// Its place among the shifts.
    pub(crate) place: usize,
    /// Where the least of the parabola through its cost and its neighbours' lies, from -0.5 to 0.5.
    pub(crate) beyond: f32,
    /// How much more the best shift that is no neighbour costs.
    pub(crate) margin: u8,
}

/// What stands at places that are no shifts.
pub(crate) const NO_SHIFT: u8 = u8::MAX;

/// The winner among the summed path costs of a pixel, the first of equals; `least` is the least of
/// them. `sums` is a whole number of vectors, [`NO_SHIFT`] beyond the last shift; it is used up.
#[inline(always)]
pub(crate) fn winner<W: Wide>(wide: W, sums: &mut [u8], least: u8) -> Winner {
    let place = first_of(wide, sums, least);
    let beside = |place: Option<usize>| {
        let cost = place.and_then(|place| sums.get(place)).copied();
        cost.filter(|cost| *cost < NO_SHIFT).map(i16::from)
    };
    let before = beside(place.checked_sub(1));
    let after = beside(Some(place + 1));
    let beyond = match (before, after) {
        (Some(before), Some(after)) => {
            let curvature = before + after - 2 * i16::from(least);
            if curvature > 0 {
                0.5 * f32::from(before - after) / f32::from(curvature)
            } else {
                0.0
            }
        }
        _ => 0.0,
    };
    // One by one: to fill three bytes is a call.
    for near in [place.wrapping_sub(1), place, place + 1] {
        if let Some(sum) = sums.get_mut(near) {
            *sum = NO_SHIFT;
        }
    }
    Winner {
        place,
        beyond,
        margin: self::least(wide, sums) - least,
    }
}

#[inline(always)]
fn least<W: Wide>(wide: W, sums: &[u8]) -> u8 {
    let mut lowest = wide.splat(u8::MAX);
    for run in sums.as_chunks::<LANES>().0 {
        lowest = wide.min(lowest, wide.load(run));
    }
    wide.least(lowest)
}

/// The first place that holds a value which is there.
#[inline(always)]
fn first_of<W: Wide>(wide: W, sums: &[u8], value: u8) -> usize {
    for (block, run) in sums.as_chunks::<LANES>().0.iter().enumerate() {
        if let Some(lane) = wide.first_equal(wide.load(run), value) {
            return block * LANES + lane;
        }
    }
    0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dense::wide::Plain;

    proptest! {
        /// The winner is the first of the least, its margin the distance to the least that is no
        /// neighbour.
        #[test]
        fn the_least_wins(costs in prop::collection::vec(0u8..50, 1..80)) {
            let mut sums = costs.clone();
            sums.resize(costs.len().next_multiple_of(LANES), NO_SHIFT);
            let least = *costs.iter().min().unwrap();
            let found = winner(Plain, &mut sums, least);
            let place = costs.iter().position(|cost| *cost == least).unwrap();
            prop_assert_eq!(found.place, place);
            prop_assert!(found.beyond.abs() <= 0.5);
            let others = costs.iter().enumerate().filter(|(i, _)| i.abs_diff(place) > 1);
            let second = others.map(|(_, cost)| *cost).min().unwrap_or(NO_SHIFT);
            prop_assert_eq!(found.margin, second - least);
        }
    }
}
