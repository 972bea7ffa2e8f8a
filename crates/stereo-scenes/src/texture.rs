use serde::Deserialize;

use crate::{noise::mix, noise::value_noise, vector::Vector};

/// How a surface is painted.
///
/// The paint is solid: a function of the point in the body's own axes, so that it has no seams.
/// It sums octaves of noise from `patch_m` down to about one pixel, of nearly equal contrast, as
/// natural images have them; the octaves that a pixel cannot resolve are left out.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Texture {
    /// What the paint looks like.
    #[serde(default)]
    pub pattern: Pattern,
    /// Colour where the pattern is brightest: red, green and blue, each in `[0, 1]`.
    pub colour: [f32; 3],
    /// Colour where the pattern is darkest; a quarter of `colour` when not given.
    #[serde(default)]
    pub ink: Option<[f32; 3]>,
    /// How far the pattern goes toward its two colours: 0 is flat, 1 is strong.
    #[serde(default = "one")]
    pub contrast: f32,
    /// Size of the coarsest patches, in metres.
    #[serde(default = "decimetre")]
    pub patch_m: f32,
    /// Chooses one paint among those that look alike.
    #[serde(default)]
    pub seed: u32,
}

/// The kinds of paint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pattern {
    /// Patches and speckles of all sizes, alike in all directions.
    #[default]
    Noise,
    /// Every other octave is drawn out along the body's own x axis, as the grain of wood.
    Wood,
    /// One colour and nothing else: no eye can match it.
    Plain,
}

const fn one() -> f32 {
    1.0
}

const fn decimetre() -> f32 {
    0.1
}

impl Default for Texture {
    /// Grey noise.
    fn default() -> Self {
        Self {
            pattern: Pattern::Noise,
            colour: [0.8; 3],
            ink: None,
            contrast: one(),
            patch_m: decimetre(),
            seed: 0,
        }
    }
}

/// How much contrast the next finer octave keeps.
///
/// 1 would be the equal contrast of natural images' `1/f` amplitude; a little less looks less like
/// sand and still gives the finest filters plenty to hold on to.
const PERSISTENCE: f32 = 0.85;

/// Brings the sum of octaves, of spread about 0.6, near the bend of the soft limit, not beyond.
const GAIN: f32 = 1.2;

/// How much longer than wide the grain of wood is.
const GRAIN: f32 = 12.0;

impl Texture {
    /// The colour at a point of the body, in the body's own axes (metres), seen by a pixel that
    /// covers `footprint_m` of the surface. `body` tells one body's paint from another's.
    pub(crate) fn colour_at(&self, point: Vector, footprint_m: f32, body: u32) -> [f32; 3] {
        if self.pattern == Pattern::Plain {
            return self.colour;
        }
        let ink = self.ink.unwrap_or(self.colour.map(|share| 0.25 * share));
        let point = [point.x as f32, point.y as f32, point.z as f32];
        let level = GAIN * self.contrast * self.octaves(point, footprint_m, mix(self.seed ^ body));
        // A soft limit: a hard one would cut crests flat, and flat patches cannot be matched.
        let bright = 0.5 + 0.5 * level / (1.0 + level * level).sqrt();
        let mut colour = [0.0; 3];
        for (c, (bright_end, dark_end)) in colour.iter_mut().zip(self.colour.iter().zip(ink)) {
            *c = dark_end + bright * (bright_end - dark_end);
        }
        colour
    }

    fn octaves(&self, point: [f32; 3], footprint_m: f32, seed: u32) -> f32 {
        let mut sum = 0.0;
        let mut amplitude = 1.0;
        // The spacing is half a patch, since detail is two spacings wide at the least.
        let mut spacing_m = 0.5 * self.patch_m;
        let per_footprint = footprint_m.recip();
        let mut frequency = spacing_m.recip();
        let mut seed = seed;
        let mut turned = turn(point);
        let mut stretched = self.pattern == Pattern::Wood;
        // Below one pixel a spacing is beyond Nyquist, and the octave fades out on the way from
        // two pixels to one.
        while spacing_m > footprint_m {
            let fade = (spacing_m * per_footprint - 1.0).min(1.0);
            let at = if stretched {
                let [x, y, z] = point;
                [x * (1.0 / GRAIN), y, z]
            } else {
                turned
            };
            // The offset keeps a flat panel off the lattice planes, where noise is strongest.
            let [x, y, z] = at;
            let at = [
                x * frequency + 0.37,
                y * frequency + 0.37,
                z * frequency + 0.37,
            ];
            sum += amplitude * fade * value_noise(at, seed);
            amplitude *= PERSISTENCE;
            spacing_m *= 0.5;
            frequency *= 2.0;
            seed = mix(seed);
            turned = turn(turned);
            stretched = !stretched && self.pattern == Pattern::Wood;
        }
        sum
    }
}

/// The rotation of the quaternion (1, 2, 3, 4): each octave's lattice lies askew to the last, so
/// that no direction of the lattice shows in the sum.
fn turn([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        (-10.0 * x + 2.0 * y + 11.0 * z) * (1.0 / 15.0),
        (2.0 * x - y + 2.0 * z) * (1.0 / 3.0),
        (5.0 * x + 14.0 * y + 2.0 * z) * (1.0 / 15.0),
    ]
}
