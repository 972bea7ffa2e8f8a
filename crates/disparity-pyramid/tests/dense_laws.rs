//! What the dense estimator must do whatever it sees: find what is there, keep still where there is
//! nothing, and say the same whoever asks.
mod texture;

use disparity_pyramid::{
    Acuity, Cost, DenseMatcher, DenseParams, DisparityField, EyeView, LookBack, SearchRange,
    Validity,
};
use ndarray::Array2;
use proptest::prelude::*;
use texture::Texture;
use v1_gabor::{Binocular, LumaImage, Size};

const SIZE: Size = Size {
    width: 120,
    height: 72,
};

fn look(params: DenseParams, eyes: &Binocular<LumaImage>, range: (i32, i32)) -> DisparityField {
    let matcher = DenseMatcher::plan(params, eyes.left.size()).expect("the parameters can be");
    let search = SearchRange::new(range.0, range.1).expect("a range");
    matcher
        .estimate(&eyes.as_ref().map(EyeView::grey), search)
        .expect("the eyes have the planned size")
}

fn image(size: Size, luma: impl Fn(usize, usize) -> f32) -> LumaImage {
    LumaImage::new(Array2::from_shape_fn(size.dim(), |(y, x)| luma(x, y))).expect("finite samples")
}

/// Random grey dots, one a pixel; the right eye sees them `dx` further right.
fn dots(size: Size, seed: u64, dx: i32) -> Binocular<LumaImage> {
    let dot = |x: i32, y: usize| {
        let mut state = (x + 1000) as u64 ^ (y as u64) << 20 ^ seed << 40;
        for _ in 0..3 {
            state = (state ^ state >> 29).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    Binocular {
        left: image(size, |x, y| dot(x as i32, y)),
        right: image(size, |x, y| dot(x as i32 - dx, y)),
    }
}

/// How far beyond the other eye's border a match may lie and be taken for one at the border: out of
/// view the last cost in view is repeated.
const BORDER_PX: i32 = 3;

fn presets() -> [DenseParams; 2] {
    [DenseParams::best(), DenseParams::fast()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Random dots moved by whole pixels, to the left or the right, are found where both eyes see
    /// them, all but 1 in 200; what only the left eye sees is marked.
    #[test]
    fn moved_dots_are_found(seed: u32, dx in -14i32..=14) {
        let eyes = dots(SIZE, u64::from(seed), dx);
        for params in presets() {
            let field = look(params, &eyes, (-16, 16));
            let (mut seen_by_both, mut right) = (0u32, 0u32);
            for y in 0..SIZE.height {
                for x in 0..SIZE.width {
                    let seen = x as i32 + dx;
                    // Near the border the filters of the two eyes see different things, and the
                    // surface cells carry that a little further in.
                    let inside = |x: i32| (8..SIZE.width as i32 - 8).contains(&x);
                    if inside(seen) && inside(x as i32) {
                        let found = field.at(x, y);
                        seen_by_both += 1;
                        right += u32::from(
                            found.is_some_and(|found| (found.dx - dx as f32).abs() < 0.15),
                        );
                    } else if seen < -BORDER_PX || seen >= SIZE.width as i32 + BORDER_PX {
                        prop_assert!(field.at(x, y).is_none(), "{x}, {y} is out of view");
                    }
                }
            }
            // Single pixels may fail where what lies beyond the border reaches in.
            prop_assert!(right * 200 >= seen_by_both * 199, "{right} of {seen_by_both}");
        }
    }

    /// With the eyes exchanged the shifts are the negative ones, seen from the other eye.
    #[test]
    fn swapped_eyes_negate(seed: u32, dx in -9i32..=9) {
        let eyes = dots(SIZE, u64::from(seed), dx);
        let there = look(DenseParams::best(), &eyes, (-12, 12));
        let back = look(DenseParams::best(), &eyes.swapped(), (-12, 12));
        let mut compared = 0;
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                // Near the border the two eyes' filters see different things.
                let inside = |x: i32| (12..SIZE.width as i32 - 12).contains(&x);
                let seen = x as i32 + dx;
                let seen = (inside(seen) && inside(x as i32)).then_some(seen as usize);
                let other = seen.and_then(|seen| back.at(seen, y));
                if let (Some(one), Some(other)) = (there.at(x, y), other) {
                    prop_assert!((one.dx + other.dx).abs() < 0.5, "{one:?} {other:?}");
                    compared += 1;
                }
            }
        }
        prop_assert!(compared > SIZE.area() / 2);
    }

    /// A slanted plane is found to a few hundredths of a pixel on the mean (its texture has lines of
    /// one wave, along which a phase says little, so single pixels may be off; the steepest planes
    /// measure up to .07 px).
    #[test]
    fn a_slanted_plane(seed in 0u64..1000, slope in -0.05f64..0.05, tilt in -0.05f64..0.05) {
        let texture = Texture::new(seed);
        let shift = |x: f64, y: f64| -10.0 + slope * (x - 60.0) + tilt * (y - 36.0);
        // The right eye's pixel u shows the left place x with x + shift(x) = u.
        let source = |u: f64, y: f64| {
            (u + 10.0 + slope * 60.0 - tilt * (y - 36.0)) / (1.0 + slope)
        };
        let eyes = Binocular {
            left: image(SIZE, |x, y| texture.at(x as f64, y as f64)),
            right: image(SIZE, |x, y| texture.at(source(x as f64, y as f64), y as f64)),
        };
        for (params, most_px) in [(DenseParams::best(), 0.09), (DenseParams::fast(), 0.14)] {
            let field = look(params, &eyes, (-16, 0));
            let (mut sum, mut count) = (0.0, 0);
            for y in 8..SIZE.height - 8 {
                for x in 20..SIZE.width - 8 {
                    let found = field.guess(x, y);
                    sum += (f64::from(found.dx) - shift(x as f64, y as f64)).abs();
                    count += 1;
                }
            }
            let mean = sum / f64::from(count);
            prop_assert!(mean < most_px, "a mean error of {mean} px");
        }
    }
}

/// A wall with a floor before it that falls by most of a pixel a row, over half of the picture: looked at once, more
/// than a fifth of the floor is lost between steps of whole pixels; looked at along its slant next to nothing is, and
/// the wall stays what it was.
#[test]
fn a_steep_floor_is_found() {
    let size = Size {
        width: 192,
        height: 120,
    };
    let mut gone = Vec::new();
    for (seed, down) in [
        (3, 0.7),
        (11, 0.7),
        (12, 0.7),
        (13, 0.7),
        (14, 0.6),
        (15, 0.8),
    ] {
        let texture = Texture::new(seed);
        let shift = |y: usize| 6.0 + down * y.saturating_sub(60) as f64;
        let eyes = Binocular {
            left: image(size, |x, y| texture.at(x as f64, y as f64)),
            right: image(size, |x, y| texture.at(x as f64 + shift(y), y as f64)),
        };
        let lost = |slants: usize, rows: std::ops::Range<usize>| {
            let params = DenseParams {
                slants,
                ..DenseParams::best()
            };
            let field = look(params, &eyes, (-63, 0));
            let seen =
                rows.flat_map(|y| (shift(y) as usize + 8..size.width - 8).map(move |x| (x, y)));
            let wrong =
                |&(x, y): &(usize, usize)| (f64::from(field.guess(x, y).dx) + shift(y)).abs() > 1.0;
            (seen.clone().filter(wrong).count(), seen.count())
        };
        let floor = 64..size.height - 4;
        let ((once, all), (again, _)) = (lost(0, floor.clone()), lost(8, floor));
        assert!(5 * once > all, "{once} of {all} are lost");
        // Where phases tell nothing steep, the first look's answers stay: seldom, and never on most of the floor.
        assert!(3 * again < once, "{once}, then {again} of {all}");
        let wall = 4..56;
        assert!(lost(8, wall.clone()).0 <= lost(0, wall).0);
        gone.push(again);
    }
    gone.sort_unstable();
    assert!(gone[gone.len() / 2] < 20, "{gone:?} pixels are still lost");
}

/// The same bits for one, two and three threads, with every ingredient in both its forms.
#[test]
fn threads_change_nothing() {
    let texture = Texture::new(5);
    let eyes = Binocular {
        left: image(SIZE, |x, y| texture.at(x as f64, y as f64)),
        right: image(SIZE, |x, y| {
            let step = if y > 30 { 7.3 } else { 3.0 };
            texture.at(x as f64 + step, y as f64)
        }),
    };
    for params in presets() {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads")
                .install(|| look(params, &eyes, (-20, 3)))
        };
        let one = with(1);
        assert!(one == with(2) && one == with(3));
    }
}

/// Where both answer, a search that a look at half the size narrows says what the full one says, all
/// but 1 pixel in 50, and it answers nearly as often: beside a step of depth its paths may not go
/// where those of the full one go. What neither sees from both eyes may be chance in either.
#[test]
fn a_narrowed_search_finds_the_same() {
    let texture = Texture::new(11);
    let size = Size {
        width: 240,
        height: 120,
    };
    let eyes = Binocular {
        left: image(size, |x, y| texture.at(x as f64, y as f64)),
        // A panel before a slanted wall.
        right: image(size, |x, y| {
            let panel = (70..130).contains(&x) && (30..90).contains(&y);
            let shift = if panel { 61.4 } else { 12.0 + 0.04 * y as f64 };
            texture.at(x as f64 + shift, y as f64)
        }),
    };
    let narrow = DenseParams::fast();
    assert!(narrow.narrow_px.is_some());
    let full = DenseParams {
        narrow_px: None,
        ..narrow
    };
    for range in [(-79, 0), (-300, 20)] {
        let (narrow, full) = (look(narrow, &eyes, range), look(full, &eyes, range));
        let (mut both, mut same) = (0, 0);
        for y in 0..size.height {
            for x in 0..size.width {
                if let (Some(one), Some(other)) = (narrow.at(x, y), full.at(x, y)) {
                    both += 1;
                    same += usize::from((one.dx - other.dx).abs() < 0.1);
                }
            }
        }
        assert!(same * 50 >= both * 49, "{same} of {both}");
        let answered = |field: &DisparityField| field.density() * size.area() as f64;
        let least = answered(&narrow).min(answered(&full));
        assert!(least > 0.75 * size.area() as f64, "{least} answers");
        assert!(both as f64 > 0.97 * least, "{both} of {least}");
    }
}

/// A constant image holds no answer, and the guess is the shift that says least.
#[test]
fn constant_images_hold_no_answer() {
    let eyes = Binocular {
        left: image(SIZE, |_, _| 0.4),
        right: image(SIZE, |_, _| 0.4),
    };
    for params in presets() {
        for (range, guess) in [((-16, 4), 0.0), ((-16, -5), -5.0)] {
            let field = look(params, &eyes, range);
            assert!(field.validity().iter().all(|v| *v != Validity::Valid));
            assert!(field.dx().iter().all(|dx| *dx == guess));
            assert!(field.confidence().iter().all(|c| (0.0..=1.0).contains(c)));
        }
    }
}

/// Identical images lie at no disparity, to the last bit, everywhere.
#[test]
fn identical_images_are_far_away() {
    let eyes = dots(SIZE, 3, 0);
    for params in presets() {
        let field = look(params, &eyes, (-16, 16));
        assert_eq!(field.density(), 1.0);
        let most = field
            .dx()
            .iter()
            .fold(0.0f32, |most, dx| most.max(dx.abs()));
        assert!(most < 0.01, "{most} px");
    }
}

/// Images of any size are looked at, however wide the search.
#[test]
fn small_images_and_wide_searches() {
    for (width, height) in [(1, 1), (1, 9), (10, 1), (10, 7), (10, 40), (70, 18)] {
        let size = Size { width, height };
        let eyes = dots(size, 1, -2);
        for params in presets() {
            for range in [(-64, 0), (-3, 200), (40, 90), (-90, -40), (0, 0)] {
                let field = look(params, &eyes, range);
                assert_eq!(field.size(), size);
                // A search wholly outside becomes its nearest shift within.
                let reach = width as f32 - 1.0;
                let least = (range.0 as f32).clamp(-reach, reach) - 0.5;
                let most = (range.1 as f32).clamp(-reach, reach) + 0.5;
                for dx in field.dx() {
                    assert!((least..=most).contains(dx), "{dx} px at a width of {width}");
                }
            }
        }
    }
}

/// Every ingredient can be left out.
#[test]
fn each_ingredient_may_be_missing() {
    let eyes = dots(SIZE, 9, -6);
    let best = DenseParams::best();
    for params in [
        DenseParams {
            cost: Cost::PhaseQuadrants,
            ..best
        },
        DenseParams {
            look_back: LookBack::SamePaths,
            ..best
        },
        DenseParams {
            least_patch: 0,
            ..best
        },
        DenseParams { votes: 0, ..best },
        DenseParams {
            median: false,
            ..best
        },
        DenseParams {
            acuity: Acuity::Parabola,
            ..best
        },
        DenseParams {
            surface_radius: 0,
            ..best
        },
        DenseParams {
            choice_radius: 0,
            ..best
        },
        DenseParams {
            acuity: Acuity::CostBank,
            ..best
        },
        DenseParams { slants: 0, ..best },
        DenseParams {
            small_step: 0.0,
            large_step: 0.0,
            ..best
        },
    ] {
        let field = look(params, &eyes, (-16, 0));
        let found = field
            .dx()
            .iter()
            .filter(|dx| (**dx + 6.0).abs() < 0.5)
            .count();
        assert!(
            found as f64 > 0.9 * SIZE.area() as f64,
            "{params:?}: {found}"
        );
    }
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let refused = |params| {
        DenseMatcher::plan(params, SIZE)
            .expect_err("it cannot be")
            .to_string()
    };
    let best = DenseParams::best();
    assert!(
        refused(DenseParams {
            large_step: 99.0,
            ..best
        })
        .contains("large_step = 99")
    );
    assert!(
        refused(DenseParams {
            edge_softness: 0.0,
            ..best
        })
        .contains("edge_softness")
    );
    assert!(
        refused(DenseParams {
            silent_energy: f32::NAN,
            ..best
        })
        .contains("silent_energy")
    );

    let matcher = DenseMatcher::plan(best, SIZE).expect("a plan");
    let other = image(
        Size {
            width: 9,
            height: 9,
        },
        |_, _| 0.0,
    );
    let own = image(SIZE, |_, _| 0.0);
    let eyes = Binocular {
        left: EyeView::grey(&own),
        right: EyeView::grey(&other),
    };
    let search = SearchRange::new(0, 0).expect("a range");
    let refused = matcher
        .estimate(&eyes, search)
        .expect_err("another size")
        .to_string();
    assert!(refused.contains("the right luma has 9 x 9"), "{refused}");
}
