use crate::{Label, Observer, Position};

/// Where the labelled objects of one look are, seen from the observer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EgocentricScene {
    /// The objects that could be located, by ascending label.
    pub objects: Vec<LocatedObject>,
    /// The labelled objects that could not, and why, by ascending label.
    pub unlocated: Vec<UnlocatedObject>,
}

impl EgocentricScene {
    /// The located object with this label.
    #[must_use]
    pub fn object(&self, label: Label) -> Option<&LocatedObject> {
        self.objects.iter().find(|object| object.label == label)
    }
}

/// A labelled object and its place in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocatedObject {
    /// The label.
    pub label: Label,
    /// The robust centroid in the level observer frame: the line of sight of the median pixel at
    /// the median depth.
    pub position: Position<Observer>,
    /// What the position may be off by: its covariance in square metres, in the observer frame.
    /// It is longest along the line of sight.
    pub covariance_m2: [[f64; 3]; 3],
    /// The median pixel `(x, y)` of the left image.
    pub pixel: (f64, f64),
    /// The median depth in metres, along the head's forward axis.
    pub depth_m: f64,
    /// How far the depths of the object's pixels spread about the median: a robust standard
    /// deviation in metres, of the object's own extent and of the noise together.
    pub spread_m: f64,
    /// How many pixels bear the label.
    pub pixels: usize,
    /// How many of these have a known depth.
    pub reliable_pixels: usize,
    /// How many of these agree on the depth, beyond whom the label bleeds over an edge.
    pub agreeing_pixels: usize,
}

impl LocatedObject {
    /// How far away over the ground, in metres.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        self.position.distance_m()
    }

    /// The direction over the ground in radians, in `[0, 2 pi)`: 0 is right, `pi / 2` front,
    /// `pi` left.
    #[must_use]
    pub fn bearing_rad(&self) -> f64 {
        self.position.bearing_rad()
    }

    /// The length of the line from the observer, in metres.
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.position.range_m()
    }

    /// One standard deviation of the position along each axis, in metres.
    #[must_use]
    pub fn sigma_m(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.covariance_m2[axis][axis].sqrt())
    }

    /// One standard deviation of [`LocatedObject::distance_m`], to first order.
    #[must_use]
    pub fn distance_sigma_m(&self) -> f64 {
        let distance_m = self.distance_m();
        self.sigma_of([
            self.position.x_m / distance_m,
            0.0,
            self.position.z_m / distance_m,
        ])
    }

    /// One standard deviation of [`LocatedObject::bearing_rad`], to first order.
    #[must_use]
    pub fn bearing_sigma_rad(&self) -> f64 {
        let square = self.distance_m() * self.distance_m();
        self.sigma_of([-self.position.z_m / square, 0.0, self.position.x_m / square])
    }

    /// The standard deviation of a quantity with this gradient over the position.
    fn sigma_of(&self, gradient: [f64; 3]) -> f64 {
        let variance: f64 = (0..3)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| gradient[i] * self.covariance_m2[i][j] * gradient[j])
            .sum();
        // Rounding may leave a vanishing variance a little below 0.
        variance.max(0.0).sqrt()
    }
}

/// A labelled object that has no place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnlocatedObject {
    /// The label.
    pub label: Label,
    /// How many pixels bear the label.
    pub pixels: usize,
    /// How many of these have a known depth.
    pub reliable_pixels: usize,
    /// Why that is not enough.
    pub reason: WhyUnlocated,
}

/// Why an object has no place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WhyUnlocated {
    /// Too few of its pixels have a known depth.
    #[error("too few pixels have a known depth: {needed} are needed")]
    TooFewReliablePixels {
        /// How many would do.
        needed: usize,
    },
    /// The line of sight of its median pixel does not point forward with this rig.
    #[error("its line of sight does not point forward with this rig")]
    NotInFront,
}
