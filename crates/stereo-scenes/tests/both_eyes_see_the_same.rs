//! What both eyes see looks alike, and visibility means what it says.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use ndarray::Array2;
use stereo_scenes::{Exposure, Room, View, render};
use v1_gabor::Size;

fn look(room: &Room) -> View {
    let head = room.head().resized(Size {
        width: 320,
        height: 240,
    });
    let gaze = head.fixate(room.fixation_m()).unwrap();
    render(room, &gaze, Exposure::default()).unwrap()
}

fn between(plane: &Array2<f32>, x: f32, y: f32) -> f32 {
    let (x0, y0) = (x.floor(), y.floor());
    let (a, b) = (x - x0, y - y0);
    let (x0, y0) = (x0 as usize, y0 as usize);
    let at = |dx: usize, dy: usize| {
        plane[[
            (y0 + dy).min(plane.nrows() - 1),
            (x0 + dx).min(plane.ncols() - 1),
        ]]
    };
    (1.0 - b) * ((1.0 - a) * at(0, 0) + a * at(1, 0)) + b * ((1.0 - a) * at(0, 1) + a * at(1, 1))
}

/// Depth is smooth around the pixel, and all of its neighbours are visible: no outline is near.
fn is_inner(view: &View, x: usize, y: usize) -> bool {
    let truth = &view.truth;
    let (height, width) = truth.visible.dim();
    if x < 2 || y < 2 || x + 2 >= width || y + 2 >= height {
        return false;
    }
    let here = truth.labels.at(x, y);
    let depth = truth.depth.at(x, y).unwrap();
    (y - 2..=y + 2).all(|v| {
        (x - 2..=x + 2).all(|u| {
            truth.visible[[v, u]]
                && truth.labels.at(u, v) == here
                && (truth.depth.at(u, v).unwrap() - depth).abs() < 0.03 * depth
        })
    })
}

/// The right image at the true match is the left image, where no outline is near.
#[test]
fn brightness_is_constant() {
    for room in [Room::demo(), Room::shelf()] {
        let view = look(&room);
        let right = view.images.right.plane().to_owned();
        let (mut differences, mut mismatched) = (Vec::new(), Vec::new());
        for ((y, x), &left) in view.images.left.plane().indexed_iter() {
            if is_inner(&view, x, y) {
                let (u, v) = (
                    x as f32 + view.truth.dx[[y, x]],
                    y as f32 + view.truth.dy[[y, x]],
                );
                differences.push((between(&right, u, v) - left).abs());
                mismatched.push((between(&right, (u + 3.0).min(319.0), v) - left).abs());
            }
        }
        assert!(differences.len() > 30_000, "{} pixels", differences.len());
        let mean = differences.iter().sum::<f32>() / differences.len() as f32;
        let off = mismatched.iter().sum::<f32>() / mismatched.len() as f32;
        // Bilinear interpolation between samples of texture that reaches down to the pixel loses
        // a part of the finest octave, some 0.02; a match that is 3 px off loses far more.
        assert!(mean < 0.025, "mean difference {mean}");
        assert!(off > 2.0 * mean, "3 px off: {off}, at the match: {mean}");
    }
}

/// What the right eye sees too is what no nearer point of the left view covers in the right image,
/// and the unseen strip lies to the left of near objects.
#[test]
fn visible_points_are_the_nearest_at_their_match() {
    let view = look(&Room::demo());
    let truth = &view.truth;
    let mut nearest = Array2::from_elem(truth.visible.dim(), f32::INFINITY);
    let target = |y: usize, x: usize| {
        let (u, v) = (x as f32 + truth.dx[[y, x]], y as f32 + truth.dy[[y, x]]);
        let inside = (0.0..=319.0).contains(&u) && (0.0..=239.0).contains(&v);
        inside.then(|| (v.round() as usize, u.round() as usize))
    };
    for ((y, x), _) in truth.visible.indexed_iter() {
        if let Some(there) = target(y, x) {
            nearest[there] = nearest[there].min(truth.depth.at(x, y).unwrap());
        }
    }
    let (mut inside, mut hidden, mut agree) = (0, 0, 0);
    for ((y, x), &visible) in truth.visible.indexed_iter() {
        let Some(there) = target(y, x) else {
            assert!(!visible, "({x}, {y}) is outside of the right image");
            continue;
        };
        let depth = truth.depth.at(x, y).unwrap();
        inside += 1;
        hidden += usize::from(!visible);
        agree += usize::from(visible == (depth < 1.03 * nearest[there]));
    }
    assert!(hidden > 500, "{hidden} hidden pixels");
    // A z-buffer of whole pixels errs along outlines and leaves gaps; 3 % of the pixels are such.
    assert!(agree * 100 > inside * 97, "{agree} of {inside} agree");
}
