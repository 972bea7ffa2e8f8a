use crate::ObjectId;

/// The farthest sighting taken, in metres; farther, a position in whole micrometres is no help.
const FARTHEST_M: f64 = 1e6;

/// The largest standard error of a position, in metres, whose square still counts in whole square
/// micrometres.
const VAGUEST_M: f64 = 1e3;

/// Where an observer sees an object, over the ground.
///
/// Horizontal distance, never the range along the line of sight: the labels live on the ground
/// plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// The object seen.
    pub object: ObjectId,
    /// Horizontal distance from the observer, in metres; from 0 to 1000 km.
    pub distance_m: f64,
    /// Direction over the ground in radians, counter-clockwise seen from above: front pi/2,
    /// right 0. Any finite angle.
    pub bearing_rad: f64,
    /// Standard error of the distance, in metres, at most 1 km; zero claims that it is exact.
    pub sigma_distance_m: f64,
    /// Standard error of the bearing, in radians, at most 1 km across at this distance; zero
    /// claims that it is exact.
    pub sigma_bearing_rad: f64,
}

/// Why a sighting shows nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadSighting {
    /// The distance is negative, no number, or beyond 1000 km.
    #[error("`{object}` at a distance of {distance_m} m: it must lie between 0 and 1e6 m")]
    Distance {
        /// The object sighted.
        object: ObjectId,
        /// Its distance.
        distance_m: f64,
    },
    /// The bearing is not finite.
    #[error("`{object}` at a bearing of {bearing_rad} rad: it must be finite")]
    Bearing {
        /// The object sighted.
        object: ObjectId,
        /// Its bearing.
        bearing_rad: f64,
    },
    /// A standard error is negative, no number, or more than 1 km over the ground.
    #[error(
        "`{object}` with a standard error of {sigma}: \
         it must not be negative, nor more than 1000 m over the ground"
    )]
    Sigma {
        /// The object sighted.
        object: ObjectId,
        /// The standard error, in metres or radians.
        sigma: f64,
    },
    /// One look shows the object twice.
    #[error("`{0}` is seen twice in one look; an object has one place")]
    Twice(ObjectId),
    /// The half-width of the intervals is negative, no number, or beyond 1000.
    #[error("intervals of {0} standard errors: the number must lie between 0 and 1000")]
    Sigmas(f64),
    /// The reading tolerance is no angle below an eighth of a turn.
    #[error("a reading tolerance of {0} rad: it must lie between 0 and pi/4")]
    Tolerance(f64),
}

impl Sighting {
    pub(crate) fn check(&self) -> Result<(), BadSighting> {
        let object = || self.object.clone();
        if !(0.0..=FARTHEST_M).contains(&self.distance_m) {
            return Err(BadSighting::Distance {
                object: object(),
                distance_m: self.distance_m,
            });
        }
        if !self.bearing_rad.is_finite() {
            return Err(BadSighting::Bearing {
                object: object(),
                bearing_rad: self.bearing_rad,
            });
        }
        let along = (self.sigma_distance_m, self.sigma_distance_m);
        let across = (
            self.sigma_bearing_rad,
            self.sigma_bearing_rad * self.distance_m,
        );
        for (sigma, over_ground_m) in [along, across] {
            if !(sigma.is_finite() && sigma >= 0.0 && over_ground_m <= VAGUEST_M) {
                return Err(BadSighting::Sigma {
                    object: object(),
                    sigma,
                });
            }
        }
        Ok(())
    }
}
