//! Planes of random dots, constant and slanted, in both components at once.
mod dots;
mod texture;

use disparity_pyramid::{MatchParams, estimate};
use dots::Dots;
use texture::respond;
use v1_gabor::Size;

const SIZE: Size = Size {
    width: 200,
    height: 160,
};

/// A plane of disparity: its value in the middle and its gradients.
#[derive(Clone, Copy, Debug)]
struct Plane {
    dx: f64,
    dy: f64,
    /// `d dx / dx` and `d dx / dy`.
    slant: (f64, f64),
    /// `d dy / dx` and `d dy / dy`.
    tilt: (f64, f64),
}

impl Plane {
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - 0.5 * SIZE.width as f64, y - 0.5 * SIZE.height as f64);
        (
            self.dx + self.slant.0 * x + self.slant.1 * y,
            self.dy + self.tilt.0 * x + self.tilt.1 * y,
        )
    }

    /// The left place that the right eye sees at `(u, v)`, by fixed point: gradients are small.
    fn back(&self, u: f64, v: f64) -> (f64, f64) {
        (0..40).fold((u, v), |(x, y), _| {
            let (dx, dy) = self.at(x, y);
            (u - dx, v - dy)
        })
    }
}

/// Mean absolute errors of both components over valid pixels away from the border, and the density.
fn errors(plane: Plane, seed: u64) -> (f64, f64, f64) {
    const MARGIN: usize = 20;
    let dots = Dots { seed };
    let eyes = respond(
        SIZE,
        |x, y| dots.at(x, y),
        |u, v| {
            let (x, y) = plane.back(u, v);
            dots.at(x, y)
        },
    );
    let field = estimate(&eyes, MatchParams::default()).expect("one bank");
    let (mut along_x, mut along_y, mut valid, mut all) = (0.0, 0.0, 0.0, 0.0);
    for y in MARGIN..SIZE.height - MARGIN {
        for x in MARGIN..SIZE.width - MARGIN {
            all += 1.0;
            if let Some(found) = field.at(x, y) {
                let (dx, dy) = plane.at(x as f64, y as f64);
                along_x += (f64::from(found.dx) - dx).abs();
                along_y += (f64::from(found.dy) - dy).abs();
                valid += 1.0;
            }
        }
    }
    (along_x / valid, along_y / valid, valid / all)
}

#[test]
fn every_plane_is_found_to_a_fiftieth_of_a_pixel() {
    let planes = [
        (-7.3, 1.2, (0.0, 0.0), (0.0, 0.0)),
        (3.5, -2.6, (0.0, 0.0), (0.0, 0.0)),
        (-6.0, 0.5, (0.02, 0.0), (0.0, 0.0)),
        (-6.0, 0.5, (0.0, 0.025), (0.0, 0.0)),
        (-6.0, 0.5, (0.02, 0.02), (0.01, 0.0)),
    ];
    for (seed, (dx, dy, slant, tilt)) in (1..).zip(planes) {
        let plane = Plane {
            dx,
            dy,
            slant,
            tilt,
        };
        let (along_x, along_y, density) = errors(plane, seed);
        // Constant planes are found to 0.003 px; the error grows with the gradient, as each filter
        // sees several shifts at once, and reaches 0.02 px at a gradient of 0.03.
        assert!(
            along_x < 0.02 && along_y < 0.02,
            "{plane:?}: {along_x}, {along_y} px"
        );
        assert!(density > 0.98, "{plane:?}: {density}");
    }
}
