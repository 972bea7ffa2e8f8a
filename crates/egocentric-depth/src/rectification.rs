use disparity_pyramid::{Disparity, DisparityField, Validity};
use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::{Binocular, LumaImage, NotAnImage, Size};

use crate::eye::Eye;
use crate::rotation::Rotation;
use crate::{BadRig, CameraIntrinsics, Position, StereoRig};

/// Two eyes of any attitude, behind any lenses, made into parallel pinholes: what turns their
/// pictures into pictures whose rows correspond.
///
/// Both eyes are turned into the frame of their baseline. They share one focal length, the mean of
/// theirs, and one row of principal points; each keeps the middle of its picture in the middle, so
/// that converging eyes keep what they fixate at no disparity (`doffs` is then not 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectification {
    rig: StereoRig,
    size: Size,
    sources: Binocular<Eye>,
    /// From each eye's own frame into the rectified one.
    turns: Binocular<Rotation>,
}

impl Rectification {
    /// Plans the rectification of pictures of this size.
    ///
    /// # Errors
    /// [`BadRig`] if the eyes are no rig along their own baseline.
    pub fn plan(rig: &StereoRig, size: Size) -> Result<Self, BadRig> {
        let aligned = StereoRig::from_pose(rig.intrinsics(), &rig.relative_pose())?
            .with_lenses(rig.lenses())?;
        let sources = aligned.eyes();
        let turns = sources.map(|eye| eye.rotation);
        let focal_px = {
            let ((lx, ly), (rx, ry)) = (
                sources.left.intrinsics.focal_px,
                sources.right.intrinsics.focal_px,
            );
            (lx + ly + rx + ry) / 4.0
        };
        let middle = (
            (size.width as f64 - 1.0) / 2.0,
            (size.height as f64 - 1.0) / 2.0,
        );
        // Where the middle shows nothing that lies in front, as in a picture far off its own axis,
        // the axis takes its place; it looks forward, or the eyes were no rig.
        let shown = sources.map(|eye| {
            let axis = eye.rotation.apply([0.0, 0.0, 1.0]);
            let seen = eye.ray(middle).map(|ray| ray.direction);
            let [x, y, z] = seen.filter(|direction| direction[2] > 0.1).unwrap_or(axis);
            (focal_px * x / z, focal_px * y / z)
        });
        let row = middle.1 - f64::midpoint(shown.left.1, shown.right.1);
        let intrinsics = shown.map(|(x, _)| CameraIntrinsics {
            focal_px: (focal_px, focal_px),
            principal_point_px: (middle.0 - x, row),
        });
        Ok(Self {
            rig: StereoRig::parallel(intrinsics, aligned.baseline_m())?
                .tilted(rig.tilt_rad())?
                .with_sigma(rig.sigma())?,
            size,
            sources,
            turns,
        })
    }

    /// The parallel rig that the rectified pictures belong to.
    #[must_use]
    pub const fn rig(&self) -> StereoRig {
        self.rig
    }

    /// From each eye's own frame into the rectified one: the `R1` and `R2` of calibration files.
    #[must_use]
    pub const fn turns(&self) -> Binocular<Rotation> {
        self.turns
    }

    /// For every pixel `[[y, x]]` of the rectified pictures the place `(u, v)` of the picture as it
    /// was taken that shows it; NaN where nothing does. Places may lie outside the picture.
    #[must_use]
    pub fn maps(&self) -> Binocular<Array2<(f32, f32)>> {
        let rectified = self.rig.intrinsics();
        let map = |camera: CameraIntrinsics, source: Eye| {
            let mut map = Array2::from_elem(self.size.dim(), (f32::NAN, f32::NAN));
            Zip::indexed(&mut map).par_for_each(|(y, x), place| {
                if let Some((u, v)) = taken(&camera, &source, (x as f64, y as f64)) {
                    *place = (u as f32, v as f32);
                }
            });
            map
        };
        Binocular {
            left: map(rectified.left, self.sources.left),
            right: map(rectified.right, self.sources.right),
        }
    }

    /// A field of the rectified pictures as one of the pictures as they were taken: their left `(x, y)`
    /// matches their right `(x + dx, y + dy)`.
    ///
    /// Shifts are read linearly between four pixels of the field that agree to a pixel, else at the
    /// nearest; validity and confidence at the nearest. What the rectified pictures do not show is out
    /// of view. The field's covariance, if it has one, is left behind.
    ///
    /// # Errors
    /// [`WrongFieldSize`] if the field has another size than the pictures.
    pub fn as_taken(&self, field: &DisparityField) -> Result<DisparityField, WrongFieldSize> {
        let mut taken = DisparityField::default();
        self.as_taken_into(field, &mut taken)?;
        Ok(taken)
    }

    /// The same, written over an earlier field.
    ///
    /// # Errors
    /// [`WrongFieldSize`] if the field has another size than the pictures; what it would be written over
    /// stays as it is then.
    pub fn as_taken_into(
        &self,
        field: &DisparityField,
        answers: &mut DisparityField,
    ) -> Result<(), WrongFieldSize> {
        if field.size() != self.size {
            return Err(WrongFieldSize {
                field: field.size(),
                pictures: self.size,
            });
        }
        let cameras = self.rig.intrinsics();
        let out_of_view = Disparity {
            dx: 0.0,
            dy: 0.0,
            confidence: 0.0,
            covariance: None,
        };
        answers.write_over(self.size, |x, y| {
            let found = || {
                let at = (x as f64, y as f64);
                let [across, down, ahead] = self.sources.left.ray(at)?.direction;
                let here =
                    (ahead > 0.0).then(|| cameras.left.pixel((across / ahead, down / ahead)))?;
                let (shift, nearest) = shift_at(field, here)?;
                let there = (here.0 + shift.0, here.1 + shift.1);
                let right = taken(&cameras.right, &self.sources.right, there)?;
                let answer = Disparity {
                    dx: (right.0 - at.0) as f32,
                    dy: (right.1 - at.1) as f32,
                    confidence: field.confidence()[nearest],
                    covariance: None,
                };
                let is_finite = answer.dx.is_finite() && answer.dy.is_finite();
                is_finite.then_some((answer, field.validity()[nearest]))
            };
            found().unwrap_or((out_of_view, Validity::OutOfView))
        });
        Ok(())
    }

    /// The rectified pictures.
    ///
    /// # Errors
    /// [`NotAnImage`] if the pictures are none, which a [`LumaImage`] cannot be.
    pub fn rectify(
        &self,
        eyes: &Binocular<&LumaImage>,
    ) -> Result<Binocular<LumaImage>, NotAnImage> {
        let maps = self.maps();
        Ok(Binocular {
            left: LumaImage::new(resampled(eyes.left.plane(), &maps.left))?,
            right: LumaImage::new(resampled(eyes.right.plane(), &maps.right))?,
        })
    }
}

/// A field of another size than the pictures that were rectified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a field of {field} pixels is not one of rectified pictures of {pictures}")]
pub struct WrongFieldSize {
    /// Size of the field.
    pub field: Size,
    /// Size of the pictures.
    pub pictures: Size,
}

/// Where the eye as it is sees what a rectified camera sees at a pixel; `None` where it sees nothing.
fn taken(camera: &CameraIntrinsics, source: &Eye, pixel: (f64, f64)) -> Option<(f64, f64)> {
    let (across, down) = camera.normalised(pixel);
    // One step along the line of sight from the eye's own place.
    let from = source.centre.to_array();
    let at = std::array::from_fn(|i| from[i] + [across, down, 1.0][i]);
    source.project(Position::from_array(at))
}

/// The shift of a field between its pixels, and the `[y, x]` of the nearest; `None` outside.
fn shift_at(field: &DisparityField, (u, v): (f64, f64)) -> Option<((f64, f64), [usize; 2])> {
    let Size { width, height } = field.size();
    let inside = |at: f64, length: usize| (-0.5..=length as f64 - 0.5).contains(&at);
    if !(inside(u, width) && inside(v, height)) {
        return None;
    }
    let nearest = [
        (v.round() as usize).min(height - 1),
        (u.round() as usize).min(width - 1),
    ];
    let (column, row) = (u.max(0.0).floor() as usize, v.max(0.0).floor() as usize);
    let corners = [
        (row, column),
        (row, column + 1),
        (row + 1, column),
        (row + 1, column + 1),
    ];
    let read = |[y, x]: [usize; 2]| (f64::from(field.dx()[[y, x]]), f64::from(field.dy()[[y, x]]));
    let here = read(nearest);
    let agree = |&(y, x): &(usize, usize)| {
        y < height
            && x < width
            && field.validity()[[y, x]] == field.validity()[nearest]
            && (read([y, x]).0 - here.0).abs() <= 1.0
    };
    if !corners.iter().all(agree) {
        return Some((here, nearest));
    }
    let (across, down) = (u - column as f64, v - row as f64);
    let weights = [
        (1.0 - across) * (1.0 - down),
        across * (1.0 - down),
        (1.0 - across) * down,
        across * down,
    ];
    let shift = corners
        .iter()
        .zip(weights)
        .fold((0.0, 0.0), |sum, (&(y, x), weight)| {
            let (dx, dy) = read([y, x]);
            (sum.0 + weight * dx, sum.1 + weight * dy)
        });
    Some((shift, nearest))
}

/// A picture as a map shows it, channel by channel; see [`resampled`].
#[must_use]
pub fn resampled_rgb(rgb: ArrayView2<'_, [u8; 3]>, map: &Array2<(f32, f32)>) -> Array2<[u8; 3]> {
    let channel = |c: usize| resampled(rgb.mapv(|colour| f32::from(colour[c])).view(), map);
    let (red, green, blue) = (channel(0), channel(1), channel(2));
    // The casts saturate: a cubic runs over at sharp edges.
    Zip::from(&red)
        .and(&green)
        .and(&blue)
        .map_collect(|&r, &g, &b| [r, g, b].map(|level| level.round() as u8))
}

/// The plane as a map shows it: cubic interpolation (Catmull and Rom), the border repeated, and 0
/// where the map shows nothing.
#[must_use]
pub fn resampled(plane: ArrayView2<'_, f32>, map: &Array2<(f32, f32)>) -> Array2<f32> {
    let mut out = Array2::zeros(map.dim());
    resampled_into(plane, map, &mut out);
    out
}

/// The same, written over an earlier plane.
pub fn resampled_into(plane: ArrayView2<'_, f32>, map: &Array2<(f32, f32)>, out: &mut Array2<f32>) {
    if out.dim() != map.dim() {
        *out = Array2::zeros(map.dim());
    }
    Zip::from(out).and(map).par_for_each(|out, &(u, v)| {
        *out = if u.is_finite() && v.is_finite() {
            cubic(plane, u, v)
        } else {
            0.0
        };
    });
}

fn cubic(plane: ArrayView2<'_, f32>, u: f32, v: f32) -> f32 {
    let (height, width) = plane.dim();
    let (column, across) = taps(u);
    let (row, down) = taps(v);
    let place = |at: f32, length: usize| at.clamp(0.0, (length - 1) as f32) as usize;
    let mut sum = 0.0;
    for (j, down) in down.into_iter().enumerate() {
        let y = place(row + j as f32, height);
        for (i, across) in across.into_iter().enumerate() {
            sum += down * across * plane[[y, place(column + i as f32, width)]];
        }
    }
    sum
}

/// The first of four samples about a place, and the weights of Catmull and Rom.
fn taps(at: f32) -> (f32, [f32; 4]) {
    let first = at.floor();
    let t = at - first;
    let weights = [
        t * (t * (2.0 - t) - 1.0) / 2.0,
        (t * t * (3.0 * t - 5.0) + 2.0) / 2.0,
        t * (t * (4.0 - 3.0 * t) + 1.0) / 2.0,
        t * t * (t - 1.0) / 2.0,
    ];
    (first - 1.0, weights)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A cubic through samples of a parabola is that parabola, away from the border.
        #[test]
        fn parabolas_are_kept(u in 2.0f32..8.0, v in 2.0f32..8.0) {
            let plane = Array2::from_shape_fn((11, 11), |(y, x)| {
                let (x, y) = (x as f32, y as f32);
                0.1 * x * x - 0.2 * y * y + 0.3 * x * y + 1.0
            });
            let want = 0.1 * u * u - 0.2 * v * v + 0.3 * u * v + 1.0;
            // Sixteen products of numbers up to 40.
            prop_assert!((cubic(plane.view(), u, v) - want).abs() < 1e-4);
        }
    }
}
