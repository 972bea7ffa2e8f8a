use std::fmt;

use serde::Serialize;

use crate::depth_reference::DepthReference;
use crate::{Case, Depth, DepthSet, Mode, compose};

/// A cell where the published calculus leaves out what is true, with triangles that show it.
///
/// As data `{"case": 1, "first": "d", "second": "fd", "published": ["fd"], "sound": [..],
/// "witnesses": [{"class": "ch", "first_um": 1190000, "second_um": 1200000, "third_um": 10000}]}`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Omission {
    /// The number of the case.
    pub case: u8,
    /// The class of the first distance, by its short label.
    pub first: String,
    /// The class of the second distance.
    pub second: String,
    /// What the published calculus answers.
    pub published: Vec<String>,
    /// What the sound calculus answers.
    pub sound: Vec<String>,
    /// One triangle for every class the published answer leaves out, nearest first.
    pub witnesses: Vec<TriangleWitness>,
}

/// Three sides of a triangle that exists, in whole micrometres: none is longer than the sum of
/// the other two.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TriangleWitness {
    /// The class of the third side, by its short label.
    pub class: String,
    /// The side of the first class.
    pub first_um: u64,
    /// The side of the second class.
    pub second_um: u64,
    /// The side the published answer denies.
    pub third_um: u64,
}

/// How many micrometres a bound of one millimetre has.
const UM: u64 = 1000;

/// The cells of a case in which the published answer excludes a real configuration, row by row.
///
/// CASE 4 answers everything in both modes, so it has none.
#[must_use]
pub fn omissions(reference: &DepthReference, case: Case) -> Vec<Omission> {
    let all = || reference.all().iter();
    let cell = |mode, i: Depth, j: Depth| compose(reference, case, mode, i.into(), j.into()).depth;
    let labels = |set: DepthSet| -> Vec<String> {
        set.iter().map(|d| reference.short(d).to_owned()).collect()
    };
    all()
        .flat_map(|first| all().map(move |second| (first, second)))
        .filter_map(|(first, second)| {
            let published = cell(Mode::Published, first, second);
            let sound = cell(Mode::Sound, first, second);
            let left_out = sound.iter().filter(|&class| !published.contains(class));
            let witnesses: Vec<TriangleWitness> = left_out
                .filter_map(|class| triangle(reference, [first, second, class]))
                .collect();
            (!witnesses.is_empty()).then(|| Omission {
                case: case.number(),
                first: reference.short(first).to_owned(),
                second: reference.short(second).to_owned(),
                published: labels(published),
                sound: labels(sound),
                witnesses,
            })
        })
        .collect()
}

/// A triangle whose sides belong to these three classes: in whole centimetres if there is one,
/// else in millimetres or micrometres, and flat if there is one, for those are read at a glance.
fn triangle(reference: &DepthReference, classes: [Depth; 3]) -> Option<TriangleWitness> {
    let [first, second, third] = classes.map(|class| span(reference, class));
    let sides = [10 * UM, UM, 1].into_iter().find_map(|grain| {
        let pairs = || {
            let second = steps(second, grain);
            steps(first, grain)
                .into_iter()
                .flat_map(move |x| second.clone().into_iter().map(move |y| (x, y)))
        };
        let flat = pairs().find_map(|(x, y)| {
            let ends = [x.abs_diff(y), x + y];
            let r = ends.into_iter().find(|r| third.0 <= *r && *r < third.1)?;
            Some((x, y, r))
        });
        flat.or_else(|| {
            pairs().find_map(|(x, y)| {
                let least = third.0.max(x.abs_diff(y)).next_multiple_of(grain);
                (least < third.1 && least <= x + y).then_some((x, y, least))
            })
        })
    });
    sides.map(|(first_um, second_um, third_um)| TriangleWitness {
        class: reference.short(classes[2]).to_owned(),
        first_um,
        second_um,
        third_um,
    })
}

/// The sides of a class in micrometres, from the first that belongs to it to the first that does
/// not; the last class is cut off at four times its bound and a metre.
fn span(reference: &DepthReference, class: Depth) -> (u64, u64) {
    let low = reference.low_mm(class);
    let high = reference.high_mm(class).unwrap_or(4 * low + 1000);
    (low * UM, high * UM)
}

/// Sides of a span that are multiples of the grain: those next to both ends and one between.
fn steps((low, high): (u64, u64), grain: u64) -> Vec<u64> {
    let first = low.next_multiple_of(grain);
    let last = (high - 1) / grain * grain;
    let middle = (first.midpoint(last) / grain) * grain;
    let mut sides = vec![
        first,
        first + grain,
        middle,
        last.saturating_sub(grain),
        last,
    ];
    sides.retain(|side| (low..high).contains(side));
    sides.dedup();
    sides
}

impl fmt::Display for Omission {
    /// One line for every witness: `CASE 1: d, fd -> {fd}, but 119 cm and 120 cm on one line,
    /// overlapping, leave 1 cm (ch)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, witness) in self.witnesses.iter().enumerate() {
            if at > 0 {
                writeln!(f)?;
            }
            let (x, y, r) = (witness.first_um, witness.second_um, witness.third_um);
            let way = if r == x.abs_diff(y) {
                "on one line, overlapping,"
            } else if r == x + y {
                "on one line, end to end,"
            } else {
                "at a suitable angle"
            };
            write!(
                f,
                "CASE {}: {}, {} -> {{{}}}, but {} and {} {way} leave {} ({})",
                self.case,
                self.first,
                self.second,
                self.published.join(", "),
                Centimetres(x),
                Centimetres(y),
                Centimetres(r),
                witness.class,
            )?;
        }
        Ok(())
    }
}

/// Micrometres as a person reads them.
struct Centimetres(u64);

impl fmt::Display for Centimetres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (whole, part) = (self.0 / 10_000, self.0 % 10_000);
        if part == 0 {
            write!(f, "{whole} cm")
        } else {
            let digits = format!("{part:04}");
            write!(f, "{whole}.{} cm", digits.trim_end_matches('0'))
        }
    }
}
