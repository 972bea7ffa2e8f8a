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

/// The first places of a run.
pub(crate) const FIRST_PLACES: [u8; LANES] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25,
    26, 27, 28, 29, 30, 31,
];

/// What stands at places that are no shifts.
pub(crate) const NO_SHIFT: u8 = u8::MAX;

/// The winner among the summed path costs of a pixel, the first of equals; `least` is the least of
/// them. `sums` is a whole number of vectors, [`NO_SHIFT`] beyond the last shift.
#[inline(always)]
pub(crate) fn winner<W: Wide>(wide: W, sums: &[u8], least: u8) -> Winner {
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
    Winner {
        place,
        beyond,
        margin: least_but_for(wide, sums, place) - least,
    }
}

/// [`NO_SHIFT`] at three places, between as many places without anything as a vector has: read from the
/// right place on, it hides a shift and its neighbours.
const HIDES: [u8; 2 * LANES + 3] = {
    let mut hides = [0; 2 * LANES + 3];
    hides[LANES] = NO_SHIFT;
    hides[LANES + 1] = NO_SHIFT;
    hides[LANES + 2] = NO_SHIFT;
    hides
};

/// The least of the sums that are neither at `place` nor beside it.
#[inline(always)]
fn least_but_for<W: Wide>(wide: W, sums: &[u8], place: usize) -> u8 {
    let mut lowest = wide.splat(NO_SHIFT);
    for (block, run) in sums.as_chunks::<LANES>().0.iter().enumerate() {
        // Where the winner's place lies before or after the block, nothing is hidden in it.
        let from = (block * LANES + LANES + 1).wrapping_sub(place);
        let from = if from <= LANES + 2 { from } else { 0 };
        let Some(hides) = HIDES[from..].first_chunk() else {
            return NO_SHIFT;
        };
        lowest = wide.min(lowest, wide.add(wide.load(run), wide.load(hides)));
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
            let found = winner(Plain, &sums, least);
            let place = costs.iter().position(|cost| *cost == least).unwrap();
            prop_assert_eq!(found.place, place);
            prop_assert!(found.beyond.abs() <= 0.5);
            let others = costs.iter().enumerate().filter(|(i, _)| i.abs_diff(place) > 1);
            let second = others.map(|(_, cost)| *cost).min().unwrap_or(NO_SHIFT);
            prop_assert_eq!(found.margin, second - least);
        }
    }
}
