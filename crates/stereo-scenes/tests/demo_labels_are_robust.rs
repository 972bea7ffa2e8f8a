//! The true qualitative labels of the demonstration do not hang on a millimetre or a degree.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use stereo_scenes::{Exposure, Room, TrueObject, render};

/// Bounds of the distance classes of both of the paper's robot systems, in metres.
const BOUNDS_M: [f64; 5] = [0.60, 1.00, 1.20, 1.50, 2.50];
const MARGIN_M: f64 = 0.04;
const MARGIN_DEG: f64 = 3.0;

fn objects() -> Vec<TrueObject> {
    let room = Room::demo();
    let head = room.head();
    let size = v1_gabor::Size {
        width: head.size.width / 4,
        height: head.size.height / 4,
    };
    let gaze = head.resized(size).fixate(room.fixation_m()).unwrap();
    let exposure = Exposure {
        samples: 1,
        ..Exposure::default()
    };
    render(&room, &gaze, exposure).unwrap().truth.objects
}

/// Over the ground: x to the right, z forward.
fn ground([x, _, z]: [f64; 3]) -> (f64, f64) {
    (x, z)
}

/// How far an angle is from the nearest of the four axes, in degrees.
fn off_axis(angle_rad: f64) -> f64 {
    let turned = angle_rad.to_degrees().rem_euclid(90.0);
    turned.min(90.0 - turned)
}

/// By the centres of bodies and by what a perfect observer sees of them alike.
#[test]
fn margins_hold() {
    let objects = objects();
    let centres: Vec<_> = objects.iter().map(|o| ground(o.centre_m)).collect();
    let surfaces: Vec<_> = objects
        .iter()
        .map(|o| ground(o.surface.unwrap().point_m))
        .collect();
    let clear = |distance: f64, what: &str| {
        for bound in BOUNDS_M {
            assert!(
                (distance - bound).abs() >= MARGIN_M,
                "{what}: {distance:.3} m is near {bound} m"
            );
        }
    };
    for places in [centres, surfaces] {
        for (object, &(x, z)) in objects.iter().zip(&places) {
            let name = &object.name;
            clear(x.hypot(z), name);
            let bearing = x.atan2(z);
            assert!(off_axis(bearing) >= MARGIN_DEG, "{name} is straight ahead");
            for (other, &(there_x, there_z)) in objects.iter().zip(&places) {
                if other.label != object.label {
                    let (dx, dz) = (there_x - x, there_z - z);
                    let pair = format!("{name} to {}", other.name);
                    clear(dx.hypot(dz), &pair);
                    let turn = dx.atan2(dz) - bearing;
                    assert!(off_axis(turn) >= MARGIN_DEG, "{pair} lies on an axis");
                }
            }
        }
    }
}

/// Every object shows enough of itself, mostly to both eyes, within the depths that matter.
#[test]
fn objects_are_in_view() {
    for object in objects() {
        let name = &object.name;
        assert!(object.pixels > 400, "{name}: {} pixels", object.pixels);
        assert!(
            object.binocular_pixels * 4 > object.pixels * 3,
            "{name}: the right eye sees {} of {}",
            object.binocular_pixels,
            object.pixels
        );
        let depth = object.surface.unwrap().depth_m;
        assert!((0.75..1.45).contains(&depth), "{name} at {depth} m");
    }
}
