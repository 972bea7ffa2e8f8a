use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::dense::bands::bands;
use crate::dense::fitted::numbers;
use crate::dense::nearest::{nearest, place};
use crate::{SearchRange, Validity};

/// How far a claim may lie from the pixel that it is for: half a pixel of rounding, and a little.
const AGREES_PX: f32 = 0.6;

/// Follows each shift to the other eye and asks what that eye's own shift there is (`other_dx`,
/// right minus left as well). Where the two differ by more than `tolerance_px`, the pixel is
/// inconsistent if some shift of the search would lead to a pixel that agrees with it, for then the
/// match may only have been missed, and occluded if there is none.
pub(crate) fn look_back(
    dx: ArrayView2<'_, f32>,
    other_dx: ArrayView2<'_, f32>,
    tolerance_px: f32,
    search: SearchRange,
    (verdicts, rooms): (&mut Array2<Validity>, &mut Vec<RowRoom>),
) {
    let width = dx.ncols();
    let (Some(dx), Some(other_dx)) = (dx.to_slice(), other_dx.to_slice()) else {
        unreachable!("planes are made in row-major order")
    };
    let (rooms, rows) = bands(rooms, dx.len() / width);
    numbers(verdicts)
        .par_chunks_mut(rows * width)
        .zip(dx.par_chunks(rows * width))
        .zip(other_dx.par_chunks(rows * width))
        .zip(rooms)
        .for_each(|(((verdicts, dx), other_dx), room)| {
            let rows = verdicts
                .chunks_exact_mut(width)
                .zip(dx.chunks_exact(width))
                .zip(other_dx.chunks_exact(width));
            for ((verdicts, dx), other_dx) in rows {
                judge(verdicts, dx, (other_dx, tolerance_px), room);
                if verdicts.contains(&Validity::Occluded) {
                    claim(other_dx, search, room);
                    spare_the_claimed(verdicts, &room.claimed);
                }
            }
        });
}

/// Calls inconsistent what is occluded though some pixel of the other eye says it sees it.
fn spare_the_claimed(verdicts: &mut [Validity], claimed: &[bool]) {
    for (verdict, claimed) in verdicts.iter_mut().zip(claimed) {
        let missed = *claimed & (*verdict == Validity::Occluded);
        let why = if missed {
            Validity::Inconsistent
        } else {
            *verdict
        };
        *verdict = why;
    }
}

/// What one row takes. Where pixels lead is told apart from what is done there: the one is computed side
/// by side, the other is memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowRoom {
    /// Where each pixel leads, the width where that is out of view; twice if it lies between two.
    leads: [Vec<u32>; 2],
    /// The other eye's row, NaN beyond its end, and what it says where each pixel leads.
    other: Vec<f32>,
    told: Vec<f32>,
    /// Which pixels some pixel of the other eye says it sees; beyond the last stands for none.
    claimed: Vec<bool>,
}

/// Which pixels of a row the other eye confirms; what it does not is called occluded.
fn judge(
    verdicts: &mut [Validity],
    dx: &[f32],
    (other_dx, tolerance_px): (&[f32], f32),
    room: &mut RowRoom,
) {
    let RowRoom {
        leads: [leads, _],
        other,
        told,
        ..
    } = room;
    leads.resize(dx.len(), 0);
    Arch::new().dispatch(Seen { dx, leads });
    other.clear();
    other.extend_from_slice(other_dx);
    other.push(f32::NAN);
    told.clear();
    told.extend(leads.iter().map(|seen| other[*seen as usize]));
    Arch::new().dispatch(Verdicts {
        dx,
        told,
        leads,
        tolerance_px,
        verdicts,
    });
}

/// Where the shifts of a row lead, the width where that is out of view.
struct Seen<'a> {
    dx: &'a [f32],
    leads: &'a mut [u32],
}

impl NullaryFnOnce for Seen<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.dx.len();
        let leads = &mut self.leads[..width];
        for x in 0..width {
            leads[x] = place(x as f32 + self.dx[x]).min(width) as u32;
        }
    }
}

/// Whether what the other eye says agrees.
struct Verdicts<'a> {
    dx: &'a [f32],
    told: &'a [f32],
    leads: &'a [u32],
    tolerance_px: f32,
    verdicts: &'a mut [Validity],
}

impl NullaryFnOnce for Verdicts<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.dx.len();
        let (told, leads) = (&self.told[..width], &self.leads[..width]);
        let verdicts = &mut self.verdicts[..width];
        for x in 0..width {
            let agrees = (self.dx[x] - told[x]).abs() <= self.tolerance_px;
            let there = if agrees {
                Validity::Valid
            } else {
                Validity::Occluded
            };
            let in_view = leads[x] < width as u32;
            verdicts[x] = if in_view { there } else { Validity::OutOfView };
        }
    }
}

/// Which pixels of a row some pixel of the other eye says it sees.
fn claim(other_dx: &[f32], search: SearchRange, room: &mut RowRoom) {
    let width = other_dx.len();
    let [first, second] = &mut room.leads;
    first.resize(width, 0);
    second.resize(width, 0);
    let claims = Claims {
        other_dx,
        search,
        leads: [first, second],
    };
    let between = Arch::new().dispatch(claims);
    room.claimed.clear();
    room.claimed.resize(width + 1, false);
    for x in first {
        room.claimed[*x as usize] = true;
    }
    if between {
        for x in second {
            room.claimed[*x as usize] = true;
        }
    }
}

/// Where the shifts of the other eye lead back to, the width where that is no shift of the search or
/// out of view. Halfway between two pixels both are claimed; says whether any are.
struct Claims<'a> {
    other_dx: &'a [f32],
    search: SearchRange,
    leads: [&'a mut [u32]; 2],
}

impl NullaryFnOnce for Claims<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let width = self.other_dx.len();
        let (least, most) = (self.search.least_dx() as f32, self.search.most_dx() as f32);
        let [first, second] = self.leads;
        let (first, second) = (&mut first[..width], &mut second[..width]);
        let mut any = 0;
        for i in 0..width {
            let seen = i as f32;
            let from = seen - self.other_dx[i];
            let x = nearest(from);
            let beyond = from - x;
            let aside = if beyond > 0.0 { 1.0 } else { -1.0 };
            let between = beyond.abs() > 1.0 - AGREES_PX;
            let other = if between { x + aside } else { x };
            // An eye that says nothing, NaN, claims nothing: no comparison holds.
            let searched = (least <= seen - x) & (seen - x <= most);
            let lead = place(x).min(width) as u32;
            first[i] = if searched { lead } else { width as u32 };
            let searched = (least <= seen - other) & (seen - other <= most);
            let lead = place(other).min(width) as u32;
            second[i] = if searched { lead } else { width as u32 };
            any |= u32::from(between);
        }
        any > 0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Claims from the other eye's side are what each missed pixel finds if it tries every shift.
        #[test]
        fn claims_and_trials_agree(
            width in 1usize..40, least in -20i32..5, more in 0i32..20, tolerance_px in 0.0f32..2.0, seed: u64,
        ) {
            let search = SearchRange::new(least, least + more).unwrap();
            let mut state = seed | 1;
            let mut random = || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                least as f32 - 0.5 + (state >> 20) as f32 % (8.0 * (more as f32 + 1.0)) / 8.0
            };
            let dx = Array2::from_shape_simple_fn((1, width), &mut random);
            let other_dx = Array2::from_shape_simple_fn((1, width), || {
                let dx = random();
                if dx > least as f32 + 8.0 { f32::NAN } else { dx }
            });
            let mut verdicts = Array2::from_elem((1, width), Validity::NoEnergy);
            look_back(dx.view(), other_dx.view(), tolerance_px, search, (&mut verdicts, &mut Vec::new()));
            for (x, verdict) in verdicts.iter().enumerate() {
                let dx = dx[[0, x]];
                let there = |dx: i32| {
                    let seen = usize::try_from(x as i32 + dx).ok()?;
                    other_dx.get([0, seen]).copied()
                };
                // Halves are rounded as the machine does.
                let seen = there((x as f32 + dx).round_ties_even() as i32 - x as i32);
                let claimed = (least..=least + more)
                    .any(|dx| there(dx).is_some_and(|other| (other - dx as f32).abs() < AGREES_PX));
                let want = match seen {
                    None => Validity::OutOfView,
                    Some(other) if (dx - other).abs() <= tolerance_px => Validity::Valid,
                    Some(_) if claimed => Validity::Inconsistent,
                    Some(_) => Validity::Occluded,
                };
                prop_assert_eq!(*verdict, want, "at {}", x);
            }
        }
    }
}
