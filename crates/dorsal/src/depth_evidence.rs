use allocentric_qsr::{AskedPlace, Evidence, LookEvidence, ObjectId};
use egocentric_depth::{DepthMap, Eye, Head, Observer, Position, StereoRig};

use crate::SeenThings;
use crate::seen_things::Meets;

/// Lines of sight along each side of the window that a place is judged by.
const SAMPLES: usize = 32;

/// A ball is never asked about as smaller than this radius in pixels, so that at least one line of
/// sight meets it: the next centre of a pixel is at most half a diagonal away.
const LEAST_PX: f64 = 0.75;

/// One in so many depths may be stray: a wrong match, not a surface.
const STRAY: f64 = 1.0 / 20.0;

/// A depth map that tells a memory what it shows of places where nothing was reported.
///
/// A place is the ball of `within_m` around a point. Every line of sight of the left eye that meets
/// the ball is compared with the depth measured on it: the surface lies *behind* the ball, or in
/// *front* of it, where it is so by three standard errors of the depth. The place is
///
/// - [`Evidence::FreeSpace`] where the whole ball is in the image and what is left, the lines that do
///   not end behind it, is less than half of what the object would cover: neither the object nor a
///   hole that could hide it is there. Where the object has no radius, one line in twenty may be left;
/// - [`Evidence::Occluded`] where more than half of the lines end in front;
/// - [`Evidence::OutOfView`] where the point is not in the image;
/// - [`Evidence::Taken`] where more than one line in twenty meets a thing that is seen and has no place
///   ([`DepthEvidence::beside`]);
/// - [`Evidence::NoEvidence`] else: a hole, no texture, one eye only, or a surface in the place
///   itself, which may be the object.
#[derive(Clone, Debug)]
pub struct DepthEvidence<'a> {
    depth: &'a DepthMap,
    rig: &'a StereoRig,
    eye: Eye,
    eyes_above_ground_m: f64,
    disparity_sigma_px: f64,
    things: Option<&'a SeenThings<'a>>,
}

impl<'a> DepthEvidence<'a> {
    /// The evidence of a depth map that was triangulated with this rig. The ground, from which a
    /// memory counts heights, lies `eyes_above_ground_m` below the eyes; one standard deviation of
    /// a disparity is the map's own, else `disparity_sigma_px`, as in
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
            things: None,
        }
    }

    /// The same evidence beside what labels say. A depth on a thing that has no place is believed of
    /// nothing, nor is one that puts a pixel of a placed thing far from its place: such pixels matched by
    /// chance, and would show the ground free on which the thing stands. An object whose middle is seen
    /// where its remembered place does not reach is [`Evidence::Elsewhere`], so is one whose foot is seen to
    /// stand elsewhere on the ground, and so is one that is not
    /// seen at all while nothing hides its place: unlike free space, that does not ask for surfaces
    /// behind the place, which few are where the place is so unsure that it reaches below the ground.
    #[must_use]
    pub const fn beside(self, things: &'a SeenThings<'a>) -> Self {
        Self {
            things: Some(things),
            ..self
        }
    }

    /// The depth at a pixel, NaN where it is not known or not believed, and whether a thing without a
    /// place is seen there.
    fn depth_at(&self, x: usize, y: usize) -> (f64, bool) {
        let z_m = self.depth.at(x, y).map_or(f64::NAN, f64::from);
        match self.things.map_or(Meets::Ground, |things| things.at(x, y)) {
            Meets::Unplaced => (f64::NAN, true),
            Meets::Placed(near, far) if !(near..=far).contains(&z_m) => (f64::NAN, false),
            Meets::Placed(..) | Meets::Ground => (z_m, false),
        }
    }

    /// Where a place lies in the head frame, and how far around it the eye can tell.
    fn ball(&self, place: AskedPlace) -> (Position<Head>, f64) {
        let down_m = self.eyes_above_ground_m - place.height_m;
        let level = Position::<Observer>::new(place.right_m, down_m, place.forward_m);
        let centre = self.rig.to_head(level);
        let (fx, fy) = self.eye.intrinsics.focal_px;
        let [x, y, z] = centre.to_array();
        let range_m = (x - self.eye.centre.x_m).hypot(y).hypot(z);
        (centre, place.within_m.max(LEAST_PX * range_m / fx.min(fy)))
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

    /// The depths at which the line of sight of a pixel enters and leaves a ball, if it meets it.
    fn meets(
        &self,
        (x, y): (usize, usize),
        centre: Position<Head>,
        within_m: f64,
    ) -> Option<(f64, f64)> {
        let ray = self.eye.ray((x as f64, y as f64))?;
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (from, to) = (ray.origin.to_array(), centre.to_array());
        let way: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        // The nearest point of the line to the centre, and half the chord to either side of it.
        let length = dot(ray.direction, ray.direction);
        let middle = dot(way, ray.direction) / length;
        let chord = (within_m * within_m - dot(way, way)) / length + middle * middle;
        (chord >= 0.0).then(|| {
            let half = chord.sqrt();
            let depth = |along: f64| ray.origin.z_m + along * ray.direction[2];
            (depth(middle - half), depth(middle + half))
        })
    }

    /// What becomes of the lines of sight that meet a place; nothing if its middle is not in the picture.
    fn lines(&self, place: AskedPlace) -> Option<Lines> {
        let (centre, within_m) = self.ball(place);
        let size = self.depth.size();
        let (width, height) = (size.width as f64, size.height as f64);
        let in_image = |(u, v): (f64, f64)| {
            (-0.5..=width - 0.5).contains(&u) && (-0.5..=height - 0.5).contains(&v)
        };
        if !self.eye.project(centre).is_some_and(in_image) {
            return None;
        }
        let mut lines = Lines {
            covered: (place.radius_m / within_m).powi(2),
            ..Lines::default()
        };
        // A ball that reaches beside or behind the eye is met by no line that says anything.
        let Some(window) = self.window(centre, within_m) else {
            return Some(lines);
        };
        lines.whole = in_image((window.columns.0, window.rows.0))
            && in_image((window.columns.1, window.rows.1));
        // The error of a depth grows with its square along a line of sight.
        let own = self.depth.disparity_sigma_px();
        let relative =
            |sigma_px: f64| 3.0 * self.rig.depth_sigma_m(centre, sigma_px) / centre.z_m.powi(2);
        let of_any = relative(self.disparity_sigma_px);
        for y in samples(window.rows, size.height) {
            for x in samples(window.columns, size.width) {
                let Some((near_m, far_m)) = self.meets((x, y), centre, within_m) else {
                    continue;
                };
                // Comparisons with an unknown depth are false.
                let (z_m, unplaced) = self.depth_at(x, y);
                let relative = own.map_or(of_any, |own| relative(f64::from(own[[y, x]])));
                let error_m = relative * z_m * z_m;
                lines.asked += 1.0;
                lines.hidden += f64::from(u8::from(unplaced));
                lines.before += f64::from(u8::from(z_m + error_m < near_m));
                lines.reach += f64::from(u8::from(z_m - error_m > near_m));
                lines.behind += f64::from(u8::from(z_m - error_m > far_m));
            }
        }
        Some(lines)
    }
}

impl LookEvidence for DepthEvidence<'_> {
    fn at(&self, place: AskedPlace) -> Evidence {
        let Some(lines) = self.lines(place) else {
            return Evidence::OutOfView;
        };
        if 2.0 * lines.before > lines.asked {
            Evidence::Occluded
        } else if lines.are_free(lines.behind) {
            Evidence::FreeSpace
        } else if lines.hidden > lines.asked * STRAY {
            Evidence::Taken
        } else {
            Evidence::NoEvidence
        }
    }

    fn of(&self, object: &ObjectId, place: AskedPlace) -> Evidence {
        let Some(things) = self.things else {
            return self.at(place);
        };
        let (centre, within_m) = self.ball(place);
        let stands_off = || {
            things
                .foot(object, self.rig, self.eyes_above_ground_m)
                .is_some_and(|foot| {
                    let off = [
                        foot.right_m - place.right_m,
                        foot.forward_m - place.forward_m,
                    ];
                    foot.is_whole && off[0].hypot(off[1]) > within_m + 3.0 * foot.pixel_m
                })
        };
        match things.middle(object) {
            Some(pixel) if self.meets(pixel, centre, within_m).is_none() => Evidence::Elsewhere,
            Some(_) if stands_off() => Evidence::Elsewhere,
            // It is seen where it may be.
            Some(_) => Evidence::NoEvidence,
            // Nothing stands before the place, and what is seen in it bears another name or none.
            None if self
                .lines(place)
                .is_some_and(|lines| lines.are_free(lines.reach)) =>
            {
                Evidence::Elsewhere
            }
            None => self.at(place),
        }
    }
}

/// What becomes of the lines of sight that meet a place: how many there are, and for how many something
/// is known of what they meet.
#[derive(Clone, Copy, Debug, Default)]
struct Lines {
    asked: f64,
    /// They end in front of the place.
    before: f64,
    /// They end in the place, or behind it.
    reach: f64,
    /// They end behind the place.
    behind: f64,
    /// They meet a thing that has no place.
    hidden: f64,
    /// Whether the whole place is in the picture.
    whole: bool,
    /// The part of the place that the object asked about would cover.
    covered: f64,
}

impl Lines {
    /// Whether the lines that are not among these are too few to hide the object.
    fn are_free(&self, these: f64) -> bool {
        let left = self.asked * STRAY.max(self.covered / 2.0);
        self.whole && self.asked > 0.0 && self.asked - these <= left
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
