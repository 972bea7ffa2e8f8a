use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::bands;
use crate::dense::cross_arms::CrossArms;
use crate::dense::fitted::numbers;
use crate::dense::nearest::{nearest, place};
use crate::dense::partial_field::{PartialField, is_hidden};

/// Votes that carry an election: more than so many, and more than this part of all.
const LEAST_VOTES: u64 = 3;
const LEAST_SHARE: f32 = 0.4;

/// Every so many rows of a surface vote, and in them every second pair of pixels: an eighth of the time,
/// and neighbours know what their neighbours know.
const ROWS: usize = 4;

/// How much nearer than what lies behind a hidden pixel may come to lie, in pixels.
const HIDDEN_NEARER_PX: f32 = 1.0;

/// One round in which every pixel without an answer takes the shift that most of its surface has:
/// the mean of the shifts in the fullest whole-pixel bin, of equally full ones the farthest. A hidden
/// pixel takes none that is nearer than what lies behind it. Beyond the image's rim nobody votes: what is
/// seen there goes on as it does beside it, and the many who are elsewhere know less of that.
pub(crate) fn vote(
    field: &mut PartialField,
    arms: &CrossArms,
    search: SearchRange,
    room: &mut VoteRoom,
) {
    let (height, width) = field.dx.dim();
    let VoteRoom { ballots, bands } = room;
    take_ballots(field, search, ballots);
    let (bands, rows) = bands::bands(bands, height);
    bands.par_iter_mut().enumerate().for_each(|(i, band)| {
        let BandRoom { boxes, elected } = band;
        elected.clear();
        boxes.resize((search.shifts() + 1).max(boxes.len()), [0; BOXES]);
        for y in (i * rows).min(height)..((i + 1) * rows).min(height) {
            for hole in field.holes(y).filter(|hole| !hole.is_at_rim()) {
                let behind = hole.behind().unwrap_or(f32::NEG_INFINITY);
                for x in hole.columns {
                    let Some(winner) = elect(arms, ballots, boxes, (x, y)) else {
                        continue;
                    };
                    let winner = search.least_dx() as f32 + winner;
                    let seen_by_both = !is_hidden(field.validity[[y, x]]);
                    if seen_by_both || winner >= behind - HIDDEN_NEARER_PX {
                        elected.push((y * width + x, winner));
                    }
                }
            }
        }
    });
    let (dx, known) = (numbers(&mut field.dx), numbers(&mut field.known));
    for (place, winner) in bands.iter().flat_map(|band| &band.elected) {
        (dx[*place], known[*place]) = (*winner, true);
    }
}

/// What voting works in, kept from field to field.
#[derive(Clone, Debug, Default)]
pub(crate) struct VoteRoom {
    ballots: Vec<Ballot>,
    bands: Vec<BandRoom>,
}

/// What a band of rows takes.
#[derive(Clone, Debug, Default)]
struct BandRoom {
    boxes: Vec<[u64; BOXES]>,
    /// The places of pixels that an election was carried for, and their shifts.
    elected: Vec<(usize, f32)>,
}

/// What a pixel says in all elections that it takes part in: in the lower half the bin of its shift, counted
/// from 1 on, or 0 if it knows nothing; in the upper half where in the bin the shift lies, in parts of
/// [`PARTS`], from half a pixel below the bin's own shift on.
#[derive(Clone, Copy, Debug, Default)]
struct Ballot(u32);

impl Ballot {
    const fn bin(self) -> u16 {
        self.0 as u16
    }

    const fn beyond(self) -> u64 {
        (self.0 >> 16) as u64
    }
}

/// Parts of a pixel that a ballot tells apart.
const PARTS: f32 = 4096.0;

/// Boxes that ballots are cast into by turns: neighbours mostly vote alike, and the second of them
/// need not wait for the first to be counted.
const BOXES: usize = 2;

/// A vote in the upper half of a count; below it the sum of what the ballots say beyond their bin.
const VOTE: u64 = 1 << 32;

/// The ballot of every pixel, row-major: filled in once, as each is cast many times.
fn take_ballots(field: &PartialField, search: SearchRange, ballots: &mut Vec<Ballot>) {
    let width = field.dx.ncols();
    let (Some(dx), Some(known)) = (field.dx.as_slice(), field.known.as_slice()) else {
        unreachable!("planes are made in row-major order")
    };
    ballots.resize(dx.len(), Ballot::default());
    ballots
        .par_chunks_mut(width)
        .zip(dx.par_chunks(width).zip(known.par_chunks(width)))
        .for_each(|(ballots, (dx, known))| {
            Arch::new().dispatch(FillIn {
                dx,
                known,
                search,
                ballots,
            });
        });
}

/// A row of shifts, whether they are known, and the ballots that say so.
struct FillIn<'a> {
    dx: &'a [f32],
    known: &'a [bool],
    search: SearchRange,
    ballots: &'a mut [Ballot],
}

impl NullaryFnOnce for FillIn<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let length = self.ballots.len();
        let (dx, known) = (&self.dx[..length], &self.known[..length]);
        let least = self.search.least_dx() as f32;
        let most = (self.search.shifts() - 1) as f32;
        for i in 0..length {
            let shift = dx[i] - least;
            let bin = nearest(shift).clamp(0.0, most);
            let beyond = (shift - bin + 0.5).clamp(0.0, 1.0);
            let bin = if known[i] { place(bin + 1.0) } else { 0 };
            self.ballots[i] = Ballot(bin as u32 | (place(beyond * PARTS) as u32) << 16);
        }
    }
}

/// The shift, counted from the least of the search, that carries the election among the known pixels
/// of a surface. `boxes` are empty before and after; the first takes the ballots of those that know
/// nothing.
fn elect(
    arms: &CrossArms,
    ballots: &[Ballot],
    boxes: &mut [[u64; BOXES]],
    (x, y): (usize, usize),
) -> Option<f32> {
    // The boxes that hold ballots of those that know something.
    let (mut first, mut last) = (u16::MAX, 0);
    for run in arms.region(x, y).step_by(ROWS) {
        for two_pairs in ballots[run].chunks(2 * BOXES) {
            for (i, ballot) in two_pairs.iter().take(BOXES).enumerate() {
                boxes[usize::from(ballot.bin())][i] += VOTE + ballot.beyond();
                first = first.min(ballot.bin().wrapping_sub(1));
                last = last.max(ballot.bin());
            }
        }
    }
    boxes[0] = [0; BOXES];
    if last == 0 {
        return None;
    }
    let first = usize::from(first);
    let cast = &mut boxes[first + 1..=usize::from(last)];
    let (mut votes, mut fullest, mut winner) = (0, 0, 0);
    for (bin, count) in (first..).zip(&*cast) {
        let count: u64 = count.iter().sum();
        votes += count / VOTE;
        if count / VOTE >= fullest / VOTE {
            (fullest, winner) = (count, bin);
        }
    }
    cast.fill([0; BOXES]);
    let most = fullest / VOTE;
    let carried = most > LEAST_VOTES && most as f32 > LEAST_SHARE * votes as f32;
    let beyond = (fullest % VOTE) as f32 / (PARTS * most as f32) - 0.5;
    carried.then_some(winner as f32 + beyond)
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

    use super::*;
    use crate::Validity;
    use crate::dense::eye_view::EyeView;
    use crate::dense::guide::Guide;

    /// The median of the first few known shifts from a place on, of two in the middle the farther.
    fn beside(known: impl Iterator<Item = Option<f32>>) -> Option<f32> {
        let mut shifts: Vec<f32> = known
            .skip_while(Option::is_none)
            .map_while(|shift| shift)
            .take(5)
            .collect();
        shifts.sort_by(f32::total_cmp);
        shifts.get(shifts.len() / 2).copied()
    }

    /// The twin: what one pixel without an answer takes, with whole lists of votes.
    fn plainly(
        field: &PartialField,
        arms: &CrossArms,
        search: SearchRange,
        (x, y): (usize, usize),
    ) -> Option<f64> {
        let width = field.dx.ncols();
        let known = |x: usize, y: usize| field.known[[y, x]].then_some(field.dx[[y, x]]);
        let left = beside((0..x).rev().map(|x| known(x, y)))?;
        let right = beside((x + 1..width).map(|x| known(x, y)))?;
        let mut votes: Vec<Vec<f64>> = vec![Vec::new(); search.shifts()];
        for run in arms.region(x, y).step_by(4) {
            let voters = run.enumerate().filter(|(i, _)| i % 4 < 2);
            for (_, place) in voters {
                if let Some(shift) = known(place % width, place / width) {
                    let bin = (shift - search.least_dx() as f32).round() as usize;
                    votes[bin].push(f64::from(shift));
                }
            }
        }
        let all: usize = votes.iter().map(Vec::len).sum();
        // Of equally full bins the last is the farthest.
        let fullest = votes.iter().max_by_key(|votes| votes.len())?;
        if fullest.len() <= 3 || fullest.len() as f64 <= 0.4 * all as f64 {
            return None;
        }
        let winner = fullest.iter().sum::<f64>() / fullest.len() as f64;
        let behind = f64::from(left.max(right));
        (!is_hidden(field.validity[[y, x]]) || winner >= behind - 1.0).then_some(winner)
    }

    proptest! {
        /// Ballots that are filled in once and counted in halves of numbers elect as lists do.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..50, height in 1usize..30, least in -20i32..5, shifts in 1u64..20,
            surfaces in 1u64..4, seed: u64,
        ) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dim = (height, width);
            let luma = Array2::from_shape_simple_fn(dim, || random(12) as f32 / 255.0);
            let mut guide = Guide::default();
            guide.take_in(&EyeView::grey(&LumaImage::new(luma).unwrap()), false, 1.0);
            let mut arms = CrossArms::default();
            let search = SearchRange::new(least, least + shifts as i32 - 1).unwrap();
            // Few surfaces, so that most elections are carried; no shift lies between two bins.
            let levels: Vec<u64> = (0..surfaces).map(|_| random(shifts)).collect();
            let dx = Array2::from_shape_simple_fn(dim, || {
                let level = levels[random(surfaces) as usize] as f32;
                let within = (random(63) as f32 - 31.0) / 64.0;
                least as f32 + (level + within).clamp(0.0, shifts as f32 - 1.0)
            });
            let validity = Array2::from_shape_simple_fn(dim, || match random(6) {
                0 => Validity::Occluded,
                1 => Validity::Inconsistent,
                _ => Validity::Valid,
            });
            let before = PartialField::new(dx, validity, Array2::default(dim));
            arms.take_in(&guide, &before.known);
            let mut after = before.clone();
            vote(&mut after, &arms, search, &mut VoteRoom::default());
            for y in 0..height {
                for x in 0..width {
                    let own = before.dx[[y, x]];
                    let found = after.dx[[y, x]];
                    if before.known[[y, x]] {
                        prop_assert_eq!(found, own);
                        continue;
                    }
                    let elected = plainly(&before, &arms, search, (x, y));
                    prop_assert_eq!(after.known[[y, x]], elected.is_some(), "{}, {}", x, y);
                    let want = elected.unwrap_or(f64::from(own));
                    // Ballots hold parts of 4096.
                    prop_assert!((f64::from(found) - want).abs() < 2e-4, "{found}, {want}");
                }
            }
        }
    }
}
