use crate::dense::pixel_cost::LANES;
use crate::dense::wide::Wide;

/// The shifts whose paths cost least along a row, pixel by pixel.
#[derive(Clone, Debug, Default)]
pub(crate) struct WonRow {
    /// Their places among the shifts.
    places: Vec<u16>,
    /// Their sums, and those of the shifts before and after; [`NO_SHIFT`] where there is none.
    least: Vec<u8>,
    before: Vec<u8>,
    after: Vec<u8>,
}

/// The first places of a run.
pub(crate) const FIRST_PLACES: [u8; LANES] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25,
    26, 27, 28, 29, 30, 31,
];

/// What stands at places that are no shifts.
pub(crate) const NO_SHIFT: u8 = u8::MAX;

impl WonRow {
    /// Makes room.
    pub(crate) fn fit(&mut self, width: usize) {
        self.places.resize(width, 0);
        for sums in [&mut self.least, &mut self.before, &mut self.after] {
            sums.resize(width, NO_SHIFT);
        }
    }

    /// Notes the winner among the summed path costs of pixel `x`, the first of equals; `least` is the
    /// least of them. `sums` is a whole number of vectors from the `first` place on, [`NO_SHIFT`]
    /// beyond the last shift. Gives how much more the best shift costs that is no neighbour.
    #[inline(always)]
    pub(crate) fn note<W: Wide>(
        &mut self,
        wide: W,
        x: usize,
        (first, sums): (usize, &[u8]),
        least: u8,
    ) -> u8 {
        let place = first_of(wide, sums, least);
        self.places[x] = (first + place) as u16;
        self.least[x] = least;
        self.before[x] = match place {
            0 => NO_SHIFT,
            _ => sums[place - 1],
        };
        self.after[x] = sums.get(place + 1).copied().unwrap_or(NO_SHIFT);
        least_but_for(wide, sums, place) - least
    }

    /// The shifts themselves, in pixels, the first place being `least_dx`: between whole ones by the
    /// parabola through the winner's sum and its neighbours', if it has two.
    #[inline(always)]
    pub(crate) fn shifts(&self, least_dx: i32, dx: &mut [f32]) {
        let width = dx.len();
        let (places, least) = (&self.places[..width], &self.least[..width]);
        let (before, after) = (&self.before[..width], &self.after[..width]);
        for x in 0..width {
            let has_two = (before[x] < NO_SHIFT) & (after[x] < NO_SHIFT);
            let (before, after) = (i32::from(before[x]), i32::from(after[x]));
            let curvature = before + after - 2 * i32::from(least[x]);
            let slope = if has_two { before - after } else { 0 };
            let beyond = 0.5 * slope as f32 / curvature.max(1) as f32;
            dx[x] = (least_dx + i32::from(places[x])) as f32 + beyond;
        }
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
        /// neighbour, and the parabola's least lies near it.
        #[test]
        fn the_least_wins(costs in prop::collection::vec(0u8..50, 1..80), first in 0usize..300) {
            let mut sums = costs.clone();
            sums.resize(costs.len().next_multiple_of(LANES), NO_SHIFT);
            let least = *costs.iter().min().unwrap();
            let mut winners = WonRow::default();
            winners.fit(2);
            let margin = winners.note(Plain, 1, (first, &sums), least);
            let mut dx = [0.0; 2];
            winners.shifts(-40, &mut dx);
            let place = costs.iter().position(|cost| *cost == least).unwrap();
            let others = costs.iter().enumerate().filter(|(i, _)| i.abs_diff(place) > 1);
            let second = others.map(|(_, cost)| *cost).min().unwrap_or(NO_SHIFT);
            prop_assert_eq!(margin, second - least);
            let whole = (first + place) as f32 - 40.0;
            let beside = place.checked_sub(1).map(|before| costs[before]).zip(costs.get(place + 1));
            let beyond = beside.map_or(0.0, |(before, after)| {
                let [before, after, least] = [before, *after, least].map(f32::from);
                let curvature = before + after - 2.0 * least;
                if curvature > 0.0 { 0.5 * (before - after) / curvature } else { 0.0 }
            });
            prop_assert!(beyond.abs() <= 0.5);
            prop_assert!((dx[1] - (whole + beyond)).abs() < 1e-4);
        }
    }
}
