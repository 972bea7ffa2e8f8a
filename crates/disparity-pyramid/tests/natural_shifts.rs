//! A natural image shifted by a part of a pixel is seen shifted by just that.

use disparity_pyramid::{MatchParams, estimate};
use ndarray::{Array2, Axis};
use rustfft::FftPlanner;
use rustfft::num_complex::Complex32;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

/// The left picture of the Motorcycle pair (D. Scharstein et al., 2014).
const MOTORCYCLE: &[u8] = include_bytes!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../fixtures/motorcycle/left.png"
));

/// A square cut out of the middle of the picture: wheels, an engine, a wall.
const SIDE: usize = 256;
const CORNER: (usize, usize) = (240, 120);

fn natural() -> Array2<f32> {
    let picture = image::load_from_memory(MOTORCYCLE)
        .expect("a PNG")
        .to_luma32f();
    let (x, y) = CORNER;
    Array2::from_shape_fn((SIDE, SIDE), |(row, column)| {
        picture.get_pixel((x + column) as u32, (y + row) as u32).0[0]
    })
}

/// The image as trigonometric interpolation has it at `(x - dx, y - dy)`: exact for every wave that
/// the samples hold, the square repeated without end.
fn shifted(image: &Array2<f32>, dx: f32, dy: f32) -> Array2<f32> {
    let mut planner = FftPlanner::new();
    let mut along = |plane: &mut Array2<Complex32>, forward: bool| {
        let fft = if forward {
            planner.plan_fft_forward(SIDE)
        } else {
            planner.plan_fft_inverse(SIDE)
        };
        for axis in [Axis(1), Axis(0)] {
            for mut line in plane.lanes_mut(axis) {
                let mut buffer = line.to_vec();
                fft.process(&mut buffer);
                line.iter_mut()
                    .zip(buffer)
                    .for_each(|(to, from)| *to = from);
            }
        }
    };
    let mut plane = image.mapv(|luma| Complex32::new(luma, 0.0));
    along(&mut plane, true);
    let frequency = |index: usize| {
        let signed = if index > SIDE / 2 {
            index as f32 - SIDE as f32
        } else {
            index as f32
        };
        std::f32::consts::TAU * signed / SIDE as f32
    };
    for ((row, column), wave) in plane.indexed_iter_mut() {
        *wave *= Complex32::cis(-(frequency(column) * dx + frequency(row) * dy));
    }
    along(&mut plane, false);
    plane.mapv(|sample| sample.re / (SIDE * SIDE) as f32)
}

/// The mean of both components' errors over valid pixels away from the border, px.
fn bias(image: &Array2<f32>, dx: f32, dy: f32) -> (f32, f32) {
    const MARGIN: usize = 24;
    let size = Size {
        width: SIDE,
        height: SIDE,
    };
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size).expect("a bank");
    let eyes = Binocular {
        left: image.clone(),
        right: shifted(image, dx, dy),
    };
    let responses = eyes.map(|eye| {
        let eye = LumaImage::new(eye).expect("finite samples");
        bank.respond(&eye).expect("the planned size")
    });
    let field = estimate(&responses, MatchParams::default()).expect("one bank");
    let (mut sum, mut count) = ((0.0, 0.0), 0.0);
    for y in MARGIN..SIDE - MARGIN {
        for x in MARGIN..SIDE - MARGIN {
            if let Some(found) = field.at(x, y) {
                sum = (sum.0 + found.dx - dx, sum.1 + found.dy - dy);
                count += 1.0;
            }
        }
    }
    assert!(count > 0.3 * ((SIDE - 2 * MARGIN) * (SIDE - 2 * MARGIN)) as f32);
    (sum.0 / count, sum.1 / count)
}

#[test]
fn a_part_of_a_pixel_has_no_bias() {
    let image = natural();
    for tenth in 0..=10u8 {
        let shift = f32::from(tenth) / 10.0;
        let (dx, dy) = (shift, 1.0 - shift);
        let (along_x, along_y) = bias(&image, dx, dy);
        // Measured: at most 0.002 px.
        assert!(
            along_x.abs() < 0.02 && along_y.abs() < 0.02,
            "({dx}, {dy}): bias {along_x}, {along_y} px"
        );
    }
}
