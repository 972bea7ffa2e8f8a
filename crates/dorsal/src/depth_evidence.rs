use allocentric_qsr::{AskedPlace, Evidence, LookEvidence};
use egocentric_depth::{DepthMap, Eye, Head, Observer, Position, StereoRig};

/// Samples along each side of the window that a place is judged by.
const SAMPLES: usize = 32;

/// One in so many known depths may be stray: a wrong match, not a surface.
const STRAY: usize = 20;

/// A depth map that tells a memory what it shows of places where nothing was reported.
///
/// A place is the ball of `within_m` around a point. Its window is the smallest upright rectangle of
/// pixels of the left image that holds the ball; every known depth there is compared with the
/// nearest and the farthest the ball reaches along the head's forward axis, three standard errors
/// of the depth beyond. The place is
///
/// - [`Evidence::FreeSpace`] where the whole window is in the image, at least half of it has a known
///   depth, and all but one in twenty of those lie behind: no place is called free by what was not
///   measured;
/// - [`Evidence::Occluded`] where more than half of the window lies in front;
/// - [`Evidence::OutOfView`] where the point is not in the image;
/// - [`Evidence::NoEvidence`] else: a hole, no texture, one eye only, or a surface in the place
///   itself, which may be the object.
#[derive(Clone, Debug)]
pub struct DepthEvidence<'a> {
    depth: &'a DepthMap,
    rig: &'a StereoRig,
    eye: Eye,
    eyes_above_ground_m: f64,
    disparity_sigma_px: f64,
}

impl<'a> DepthEvidence<'a> {
    /// The evidence of a depth map that was triangulated with this rig. The ground, from which a
    /// memory counts heights, lies `eyes_above_ground_m` below the eyes; one standard deviation of
    /// a disparity is `disparity_sigma_px`, as in
    /// [`LocateParams`](egocentric_depth::LocateParams::disparity_sigma_px).
    #[must_use]
    pub fn new(
        depth: &'a DepthMap,
        rig: &'a StereoRig,
        eyes_above_ground_m: f64,
        disparity_sigma_px: f64,
    ) -> Self {
        Self {
            depth,
            rig,
            eye: rig.eyes().left,
            eyes_above_ground_m,
            disparity_sigma_px,
        }
    }

    /// The window of a ball in the head frame; `None` if the ball reaches beside or behind the eye.
    fn window(&self, centre: Position<Head>, within_m: f64) -> Option<Window> {
        let mut window = Window {
            columns: (f64::INFINITY, f64::NEG_INFINITY),
            rows: (f64::INFINITY, f64::NEG_INFINITY),
        };
        for corner in 0..8u8 {
            let side = |bit: u8| {
                if corner >> bit & 1 == 0 {
                    -within_m
                } else {
                    within_m
                }
            };
            let (u, v) = self.eye.project(Position::new(
                centre.x_m + side(0),
                centre.y_m + side(1),
                centre.z_m + side(2),
            ))?;
            window.columns = (window.columns.0.min(u), window.columns.1.max(u));
            window.rows = (window.rows.0.min(v), window.rows.1.max(v));
        }
        Some(window)
    }
}

impl LookEvidence for DepthEvidence<'_> {
    fn at(&self, place: AskedPlace) -> Evidence {
        let down_m = self.eyes_above_ground_m - place.height_m;
        let level = Position::<Observer>::new(place.right_m, down_m, place.forward_m);
        let centre = self.rig.to_head(level);
        let size = self.depth.size();
        let (width, height) = (size.width as f64, size.height as f64);
        let in_image = |(u, v): (f64, f64)| {
            (-0.5..=width - 0.5).contains(&u) && (-0.5..=height - 0.5).contains(&v)
        };
        if !self.eye.project(centre).is_some_and(in_image) {
            return Evidence::OutOfView;
        }
        let Some(window) = self.window(centre, place.within_m) else {
            return Evidence::NoEvidence;
        };
        let whole = in_image((window.columns.0, window.rows.0))
            && in_image((window.columns.1, window.rows.1));
        let (near_m, far_m) = (centre.z_m - place.within_m, centre.z_m + place.within_m);
        // The error of a depth grows with its square along a line of sight.
        let relative =
            3.0 * self.rig.depth_sigma_m(centre, self.disparity_sigma_px) / centre.z_m.powi(2);
        let (mut asked, mut known, mut before, mut behind) = (0, 0, 0, 0);
        for y in samples(window.rows, size.height) {
            for x in samples(window.columns, size.width) {
                asked += 1;
                let Some(z_m) = self.depth.at(x, y).map(f64::from) else {
                    continue;
                };
                let error_m = relative * z_m * z_m;
                known += 1;
                before += usize::from(z_m + error_m < near_m);
                behind += usize::from(z_m - error_m > far_m);
            }
        }
        if 2 * before > asked {
            Evidence::Occluded
        } else if whole && 2 * known >= asked && STRAY * (known - behind) <= known {
            Evidence::FreeSpace
        } else {
            Evidence::NoEvidence
        }
    }
}

/// A rectangle of the image, in pixels: least and greatest column and row.
struct Window {
    columns: (f64, f64),
    rows: (f64, f64),
}

/// The pixels of one side of a window that lie in the image, at most about [`SAMPLES`] of them,
/// evenly spaced.
fn samples((low, high): (f64, f64), length: usize) -> impl Iterator<Item = usize> {
    // The casts saturate, so that what lies before the image begins at its first pixel.
    let first = low.round() as usize;
    let last = (high.round() as usize).min(length.saturating_sub(1));
    let step = ((last.saturating_sub(first) + 1) / SAMPLES).max(1);
    (first..=last).step_by(step)
}
