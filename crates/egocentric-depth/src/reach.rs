use std::f64::consts::FRAC_PI_2;

use crate::{Head, Position, StereoRig};

/// The depths on the midline that a rig can tell with a given search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// The nearest depth, in metres; 0 if there is no limit in front of the eyes.
    pub nearest_m: f64,
    /// The farthest depth, in metres; infinite if there is no limit.
    pub farthest_m: f64,
}

/// The search that reaches a span of depths: what to ask of level 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// The shift `dx` around which to look, in pixels: the middle of the span.
    pub zero_disparity_px: f64,
    /// The number of scales.
    pub scales: u32,
}

/// The largest shift to either side that the given number of scales can find, in pixels:
/// `0.75 * 2^scales`.
///
/// The phase of the coarsest scale wraps beyond `2^scales` pixels; the last quarter of that is
/// lost to the band width of the filters.
#[must_use]
pub fn reach_px(scales: u32) -> f64 {
    0.75 * f64::from(scales).exp2()
}

impl StereoRig {
    /// The nearest and the farthest depth on the midline whose shift `dx` lies within
    /// [`reach_px`] of `zero_disparity_px`.
    ///
    /// `zero_disparity_px` is the shift the search starts from: 0, unless the right image was
    /// moved beforehand. `None` if no depth in front of the head gives such a shift.
    ///
    /// Pans, focal lengths and principal points count. Tilt, torsion and slip move a shift by little
    /// across the rows, and lenses bend little near the middle of a picture: they do not.
    #[must_use]
    pub fn reach(&self, scales: u32, zero_disparity_px: f64) -> Option<Reach> {
        let reach_px = reach_px(scales);
        let (at_infinity, at_the_eyes) = (self.dx_at_angle(0.0), self.dx_at_angle(FRAC_PI_2));
        let (least_dx, most_dx) = (zero_disparity_px - reach_px, zero_disparity_px + reach_px);
        let meets = least_dx < at_infinity && most_dx > at_the_eyes;
        meets.then(|| Reach {
            nearest_m: if least_dx <= at_the_eyes {
                0.0
            } else {
                self.depth_of_dx(least_dx)
            },
            farthest_m: if most_dx >= at_infinity {
                f64::INFINITY
            } else {
                self.depth_of_dx(most_dx)
            },
        })
    }

    /// The smallest search that reaches every depth on the midline from `nearest_m` to
    /// `farthest_m`, which may be infinite.
    ///
    /// `None` unless `0 < nearest_m < farthest_m` and both eyes see the nearest point.
    #[must_use]
    pub fn search_for(&self, nearest_m: f64, farthest_m: f64) -> Option<Search> {
        if !(nearest_m > 0.0 && nearest_m < farthest_m) {
            return None;
        }
        let on_midline = self.project(Position::<Head>::new(0.0, 0.0, nearest_m))?;
        let nearest_dx = on_midline.right.0 - on_midline.left.0;
        let farthest_dx = self.dx_at_angle((self.baseline_m() / (2.0 * farthest_m)).atan());
        let needed_px = (farthest_dx - nearest_dx) / 2.0;
        Some(Search {
            zero_disparity_px: f64::midpoint(nearest_dx, farthest_dx),
            scales: (1..).find(|&scales| reach_px(scales) >= needed_px)?,
        })
    }

    /// The shift `dx` of the midline point that the left eye sees at the azimuth `angle_rad` and
    /// the right eye at its negative: 0 for a point at infinity, a right angle between the eyes.
    /// It falls strictly as the angle grows, down to minus infinity where an eye loses the point.
    fn dx_at_angle(&self, angle_rad: f64) -> f64 {
        let eyes = self.intrinsics();
        let pan = self.pan_rad();
        let in_left = angle_rad - pan.left;
        let in_right = -angle_rad - pan.right;
        if in_left >= FRAC_PI_2 || in_right <= -FRAC_PI_2 {
            return f64::NEG_INFINITY;
        }
        let left = eyes.left.principal_point_px.0 + eyes.left.focal_px.0 * in_left.tan();
        let right = eyes.right.principal_point_px.0 + eyes.right.focal_px.0 * in_right.tan();
        right - left
    }

    /// The depth on the midline whose shift is `dx`, which lies between those at infinity and at
    /// the eyes. Bisection, because eyes with different pans and lenses leave no closed form.
    fn depth_of_dx(&self, dx: f64) -> f64 {
        let (mut far, mut near) = (0.0, FRAC_PI_2);
        // Each round halves the span; after 100 it is one step of f64.
        for _ in 0..100 {
            let middle = f64::midpoint(far, near);
            if self.dx_at_angle(middle) > dx {
                far = middle;
            } else {
                near = middle;
            }
        }
        self.baseline_m() / 2.0 / f64::midpoint(far, near).tan()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::Binocular;

    use super::*;
    use crate::CameraIntrinsics;

    fn rig(fixation_m: Option<f64>) -> StereoRig {
        let eye = CameraIntrinsics {
            focal_px: (887.0, 887.0),
            principal_point_px: (511.5, 383.5),
        };
        let pan = fixation_m.map_or(0.0, |fixation_m| (0.135 / fixation_m).atan());
        let pans = Binocular {
            left: pan,
            right: -pan,
        };
        StereoRig::vergent(
            Binocular {
                left: eye,
                right: eye,
            },
            0.27,
            pans,
        )
        .unwrap()
    }

    proptest! {
        /// What a search is said to need reaches as far as was asked.
        #[test]
        fn a_search_reaches_what_it_was_asked_for(
            fixation in 0.3f64..5.0,
            nearest in 0.25f64..2.0,
            stretch in 1.1f64..20.0,
        ) {
            let rig = rig(Some(fixation));
            let search = rig.search_for(nearest, nearest * stretch).unwrap();
            let reach = rig.reach(search.scales, search.zero_disparity_px).unwrap();
            prop_assert!(reach.nearest_m <= nearest * (1.0 + 1e-9));
            prop_assert!(reach.farthest_m >= nearest * stretch * (1.0 - 1e-9));
        }

        /// A symmetric head has the closed form `2 f tan(pan - angle) = dx`.
        #[test]
        fn bisection_finds_the_closed_form(fixation in 0.3f64..5.0, scales in 2u32..7) {
            let reach = rig(Some(fixation)).reach(scales, 0.0).unwrap();
            let pan = (0.135 / fixation).atan();
            let turn = (reach_px(scales) / (2.0 * 887.0)).atan();
            let nearest = 0.135 / (pan + turn).tan();
            prop_assert!((reach.nearest_m / nearest - 1.0).abs() < 1e-9);
            if pan > turn {
                let farthest = 0.135 / (pan - turn).tan();
                prop_assert!((reach.farthest_m / farthest - 1.0).abs() < 1e-9);
            } else {
                prop_assert_eq!(reach.farthest_m, f64::INFINITY);
            }
        }
    }

    /// Six scales around a fixation at 1 m see a hand's breadth more than a table: the whole phase
    /// circle would give 0.79 to 1.37 m, the usable three quarters of it 0.83 to 1.26 m.
    #[test]
    fn the_papers_head_sees_a_narrow_span_around_its_fixation() {
        let reach = rig(Some(1.0)).reach(6, 0.0).unwrap();
        assert!((reach.nearest_m - 0.830).abs() < 0.001);
        assert!((reach.farthest_m - 1.255).abs() < 0.001);
    }

    #[test]
    fn parallel_eyes_see_to_infinity_unless_the_search_is_moved() {
        let reach = rig(None).reach(6, 0.0).unwrap();
        assert!((reach.nearest_m - 887.0 * 0.27 / 48.0).abs() < 1e-9);
        assert_eq!(reach.farthest_m, f64::INFINITY);
        let moved = rig(None).reach(6, -100.0).unwrap();
        assert!((moved.nearest_m - 887.0 * 0.27 / 148.0).abs() < 1e-9);
        assert!((moved.farthest_m - 887.0 * 0.27 / 52.0).abs() < 1e-9);
        assert_eq!(rig(None).reach(6, 100.0), None);
    }
}
