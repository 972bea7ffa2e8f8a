/// The ground that a scan is about: a part of a ring before the head, at the height that the things
/// stand on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// The nearest distance over the ground, in metres.
    pub nearest_m: f64,
    /// The farthest, in metres.
    pub farthest_m: f64,
    /// How far to either side, in radians.
    pub aside_rad: f64,
}

impl Default for Field {
    /// What an arm gets to and a little more: 0.7 to 1.9 m, 50 degrees to either side.
    fn default() -> Self {
        Self {
            nearest_m: 0.7,
            farthest_m: 1.9,
            aside_rad: 50f64.to_radians(),
        }
    }
}

/// The side of the squares whose middles stand for the ground, in metres.
const STEP_M: f64 = 0.12;

impl Field {
    /// Places of the field a step apart, `[right, forward]` of the head in metres, row by row.
    pub(crate) fn places(&self) -> Vec<[f64; 2]> {
        let steps = (self.farthest_m / STEP_M).ceil() as i32;
        let along = |step: i32| f64::from(step) * STEP_M;
        (0..=steps)
            .flat_map(|forward| (-steps..=steps).map(move |right| [along(right), along(forward)]))
            .filter(|&[right, forward]| {
                let distance_m = right.hypot(forward);
                (self.nearest_m..=self.farthest_m).contains(&distance_m)
                    && right.atan2(forward).abs() <= self.aside_rad
            })
            .collect()
    }
}
