//! The same arguments give the same bits.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use stereo_scenes::{Exposure, Room, View, render};
use v1_gabor::Size;

fn look(threads: usize, exposure: Exposure) -> View {
    let room = Room::demo();
    let head = room.head().resized(Size {
        width: 100,
        height: 75,
    });
    let gaze = head.fixate(room.fixation_m()).unwrap();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| render(&room, &gaze, exposure)).unwrap()
}

#[test]
fn threads_change_nothing() {
    let exposure = Exposure {
        noise_sigma: 0.01,
        noise_seed: 7,
        right_gain: 0.9,
        ..Exposure::default()
    };
    let (one, three) = (look(1, exposure), look(3, exposure));
    assert_eq!(one.colour, three.colour);
    assert_eq!(one.images, three.images);
    assert_eq!(one.truth.dx, three.truth.dx);
    assert_eq!(one.truth.dy, three.truth.dy);
    assert_eq!(one.truth.depth.metres(), three.truth.depth.metres());
    assert_eq!(one.truth.labels, three.truth.labels);
    assert_eq!(one.truth.visible, three.truth.visible);
    assert_eq!(one.truth.objects, three.truth.objects);
}

/// Gain scales the right eye alone; noise has the spread that was asked for, and no echo between
/// the eyes.
#[test]
fn exposure_does_what_it_says() {
    let plain = look(2, Exposure::default());
    let gain = Exposure {
        right_gain: 0.5,
        ..Exposure::default()
    };
    let dim = look(2, gain);
    assert_eq!(plain.colour.left, dim.colour.left);
    assert_eq!(plain.colour.right.mapv(|c| 0.5 * c), dim.colour.right);

    let noise = Exposure {
        noise_sigma: 0.02,
        noise_seed: 1,
        ..Exposure::default()
    };
    let noisy = look(2, noise);
    let left = &noisy.images.left.plane() - &plain.images.left.plane();
    let right = &noisy.images.right.plane() - &plain.images.right.plane();
    // 7500 samples: the spread is known to 0.8 %, a correlation to 0.012; five sigma of each.
    assert!((left.std(0.0) - 0.02).abs() < 0.001);
    assert!((right.std(0.0) - 0.02).abs() < 0.001);
    let echo = (&left * &right).mean().unwrap() / (0.02 * 0.02);
    assert!(echo.abs() < 0.06, "correlation {echo}");
}
