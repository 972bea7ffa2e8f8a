use serde::Serialize;

use crate::alteration::Alteration;
use crate::robustness_series::Series;

/// Which way the parts of a bad rig lie: 3 px, a degree and 2 % have eight.
///
/// Parts that lie one way add up where parts that lie another cancel: a roll and a scale, each of
/// which lifts one side of the picture, together lift a corner twice as far. So one choice of signs
/// says little about the other seven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct RigSigns {
    /// Whether the right picture lies lower; else higher.
    pub(crate) lower: bool,
    /// Whether it is turned clockwise; else the other way.
    pub(crate) clockwise: bool,
    /// Whether it is larger; else smaller.
    pub(crate) larger: bool,
}

impl RigSigns {
    /// All eight, the one of [`Series::Rig`] first.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        (0..8u8).map(|bits| Self {
            lower: bits & 4 == 0,
            clockwise: bits & 2 == 0,
            larger: bits & 1 == 0,
        })
    }

    /// What they do to the right picture.
    pub(crate) fn alteration(self) -> Alteration {
        let whole = Series::Rig.alteration(1.0);
        let signed = |amount: f64, plus: bool| if plus { amount } else { -amount };
        Alteration {
            down_px: signed(whole.down_px, self.lower),
            roll_deg: signed(whole.roll_deg, self.clockwise),
            scale_percent: signed(whole.scale_percent, self.larger),
            ..whole
        }
    }

    /// Their name in tables.
    pub(crate) const fn title(self) -> &'static str {
        match (self.lower, self.clockwise, self.larger) {
            (true, true, true) => "+3 px, +1 degree, +2 %",
            (true, true, false) => "+3 px, +1 degree, -2 %",
            (true, false, true) => "+3 px, -1 degree, +2 %",
            (true, false, false) => "+3 px, -1 degree, -2 %",
            (false, true, true) => "-3 px, +1 degree, +2 %",
            (false, true, false) => "-3 px, +1 degree, -2 %",
            (false, false, true) => "-3 px, -1 degree, +2 %",
            (false, false, false) => "-3 px, -1 degree, -2 %",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_signs_differ_and_the_series_is_first() {
        let all: Vec<Alteration> = RigSigns::all().map(RigSigns::alteration).collect();
        assert_eq!(all[0], Series::Rig.alteration(1.0));
        for (i, one) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|other| other != one));
            let parts = [one.down_px, one.roll_deg, one.scale_percent];
            assert_eq!(parts.map(f64::abs), [3.0, 1.0, 2.0]);
        }
        let titles: Vec<&str> = RigSigns::all().map(RigSigns::title).collect();
        assert_eq!(titles[6], "-3 px, -1 degree, +2 %");
        assert!(!all[6].down_px.is_sign_positive() && all[6].scale_percent > 0.0);
    }
}
