use dorsal::disparity_pyramid::{FromVotes, MatchParams, Start};
use dorsal::egocentric_depth::{Reach, StereoRig};
use serde::Serialize;

/// Where a search for disparities began, and over how many scales it went.
#[derive(Debug)]
pub(crate) struct Searched {
    /// Whether a coarse look chose them.
    pub(crate) found: bool,
    /// At least one.
    pub(crate) starts: Vec<StartRecord>,
    pub(crate) scales: usize,
}

/// A start of a search. The first component is in the sign of files.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct StartRecord {
    /// `x_left - x_right`.
    disparity_px: f32,
    /// `y_right - y_left`: positive if the right picture's rows lie lower.
    vertical_px: f32,
}

impl Searched {
    /// The search that the parameters ask for.
    pub(crate) fn given(scales: usize, matching: &MatchParams) -> Self {
        Self {
            found: false,
            starts: vec![StartRecord::of(matching.zero_disparity_px)],
            scales,
        }
    }

    /// The search that was: it began where the parameters say unless a coarse look chose.
    pub(crate) fn of(found: &FromVotes, matching: &MatchParams) -> Self {
        let shifts = found.starts.iter().map(|start: &Start| start.shift_px);
        let starts: Vec<_> = shifts.map(StartRecord::of).collect();
        if starts.is_empty() {
            return Self::given(found.scales, matching);
        }
        Self {
            found: true,
            starts,
            scales: found.scales,
        }
    }

    /// The scales and the starts, for a person: `5 scales from 64 px and 120 px (8 px down)`.
    pub(crate) fn sentence(&self) -> String {
        let starts: Vec<_> = self.starts.iter().map(StartRecord::words).collect();
        let by = if self.found {
            ", found by a coarse look"
        } else {
            ""
        };
        format!("{} from {}{by}", scales_words(self.scales), list(&starts))
    }

    /// The depths that the scales can tell about the starts with a rig, from the nearest to the
    /// farthest; `None` if there are none.
    pub(crate) fn reach(&self, rig: &StereoRig) -> Option<Reach> {
        let scales = u32::try_from(self.scales).ok()?;
        let about = |start: &StartRecord| rig.reach(scales, f64::from(0.0 - start.disparity_px));
        self.starts
            .iter()
            .filter_map(about)
            .reduce(|all, one| Reach {
                nearest_m: all.nearest_m.min(one.nearest_m),
                farthest_m: all.farthest_m.max(one.farthest_m),
            })
    }

    /// What the scales reach with a rig, in a sentence.
    pub(crate) fn reach_sentence(&self, rig: &StereoRig) -> String {
        let starts = self.starts.iter().map(|start| start.disparity_px);
        let starts: Vec<_> = starts.map(|px| format!("{px:.1} px")).collect();
        let search = format!(
            "{} around a disparity of {}",
            scales_words(self.scales),
            list(&starts)
        );
        match self.reach(rig) {
            Some(Reach {
                nearest_m,
                farthest_m,
            }) if farthest_m.is_finite() => {
                format!("{search} reach depths from {nearest_m:.2} to {farthest_m:.2} m")
            }
            Some(Reach { nearest_m, .. }) => {
                format!("{search} reach every depth beyond {nearest_m:.2} m")
            }
            None if self.found => format!(
                "{search} reach no depth in front of this rig; \
                 are the pictures a pair of this rig, left before right?"
            ),
            None => format!(
                "{search} reach no depth in front of this rig; \
                 choose --zero-disparity and --scales for the distances that matter"
            ),
        }
    }
}

impl StartRecord {
    fn of((dx, dy): (f32, f32)) -> Self {
        Self {
            disparity_px: 0.0 - dx,
            vertical_px: dy,
        }
    }

    fn words(&self) -> String {
        let (across, down) = (self.disparity_px, self.vertical_px.abs());
        match self.vertical_px {
            vertical if vertical > 0.0 => format!("{across} px ({down} px down)"),
            vertical if vertical < 0.0 => format!("{across} px ({down} px up)"),
            _ => format!("{across} px"),
        }
    }
}

fn scales_words(scales: usize) -> String {
    let plural = if scales == 1 { "" } else { "s" };
    format!("{scales} scale{plural}")
}

/// `a`, `a and b`, `a, b and c`.
fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_is_told_in_words() {
        let matching = MatchParams::default();
        assert_eq!(
            Searched::given(6, &matching).sentence(),
            "6 scales from 0 px"
        );
        let several = Searched {
            found: true,
            starts: [(-64.0, 0.0), (-120.0, 8.0), (8.0, -24.0)]
                .map(StartRecord::of)
                .to_vec(),
            scales: 5,
        };
        assert_eq!(
            several.sentence(),
            "5 scales from 64 px, 120 px (8 px down) and -8 px (24 px up), found by a coarse look"
        );
    }
}
