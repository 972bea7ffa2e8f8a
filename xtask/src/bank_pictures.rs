use std::f32::consts::PI;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use ndarray::{Array2, ArrayView2, s};
use num_complex::Complex32;
use stereo_formats::colour::{self, ColourRange};
use stereo_formats::contact_sheet::{Tile, sheet};
use stereo_formats::{hue, picture, v1_picture};
use v1_gabor::{
    FilterBank, GaborParams, LumaImage, MonogenicBank, MonogenicParams, Size, SteerableOrder,
    SteerableParams,
};

use crate::docs_folder::docs_folder;

/// Draws the filters of every family, and what they find in a picture, for the documents.
///
/// Writes into docs/pictures: bank-gabor, -s4, -s2 (for each orientation the even and the odd filter
/// in space and the gain in frequency), bank-sqf, bank-half-gain (where each family's gain is one
/// half), and v1-*.png, each feature of the left picture of fixtures/motorcycle.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  cargo xtask bank-pictures")]
pub(crate) struct Options {
    /// The folder for the pictures; without it, docs/pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Half a side of a drawn spectrum, in pixels; frequencies run from -pi to pi.
const BINS: usize = 44;
/// Screen pixels to one tap.
const ZOOM: usize = 8;
/// A picture of the project's own, no evaluation data.
const MOTORCYCLE: &[u8] = include_bytes!("../../fixtures/motorcycle/left.png");
/// Fleet and Jepson's bound of what is no singularity.
const TAU: f32 = 1.25;

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let docs = || Some(docs_folder()?.join("pictures"));
    let folder = options.out.clone().or_else(docs);
    let folder = folder.context("no folder for the pictures: name it with --out DIR")?;
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    banks(&folder)?;
    features(&folder)?;
    println!("The pictures are in {}.", folder.display());
    Ok(())
}

fn write(folder: &Path, name: &str, rgb: ArrayView2<'_, [u8; 3]>) -> anyhow::Result<()> {
    picture::write_rgb(folder.join(format!("{name}.png")), rgb)?;
    Ok(())
}

fn banks(folder: &Path) -> anyhow::Result<()> {
    let size = Size {
        width: 64,
        height: 64,
    };
    let steerable = |order| SteerableParams {
        order,
        scales: 1,
        ..SteerableParams::default()
    };
    let gabor = GaborParams {
        scales: 1,
        ..GaborParams::default()
    };
    let oriented = [
        ("gabor", FilterBank::plan(gabor, size)?),
        (
            "s4",
            FilterBank::plan(steerable(SteerableOrder::Fourth), size)?,
        ),
        (
            "s2",
            FilterBank::plan(steerable(SteerableOrder::Second), size)?,
        ),
    ];
    let mut rosettes = Vec::new();
    for (name, bank) in &oriented {
        let drawn = oriented_bank(bank);
        write(folder, &format!("bank-{name}"), drawn.view())?;
        let filters: Vec<_> = (0..bank.params().orientations)
            .map(|q| bank.filter(q))
            .collect();
        rosettes.push(rosette(filters.len(), |q, wave| gain(&filters[q], wave)));
    }
    let spherical = MonogenicParams {
        scales: 1,
        ..MonogenicParams::default()
    };
    write(folder, "bank-sqf", spherical_bank(spherical)?.view())?;
    // The spherical filter's largest gain is one half.
    rosettes.push(rosette(1, |_, wave| {
        2.0 * spherical.radial_gain(wave.0.hypot(wave.1))
    }));
    let tiles: Vec<Tile> = rosettes.into_iter().zip(1..).map(numbered).collect();
    write(folder, "bank-half-gain", sheet(&tiles, 4, 640).view())
}

fn numbered((picture, number): (Array2<[u8; 3]>, usize)) -> Tile {
    Tile {
        number: number.to_string(),
        picture,
    }
}

/// Even filters, odd filters and gains, a row each, over the angles of their wave vectors.
fn oriented_bank(bank: &FilterBank) -> Array2<[u8; 3]> {
    let orientations = bank.params().orientations;
    let filters: Vec<_> = (0..orientations).map(|q| bank.filter(q)).collect();
    let loudest = filters
        .iter()
        .flatten()
        .map(|tap| tap.re.abs().max(tap.im.abs()));
    let loudest = loudest.fold(0.0, f32::max);
    let angle = |q: usize| format!("{}", q as f64 * 180.0 / orientations as f64);
    let even = filters
        .iter()
        .map(|filter| grey(&filter.mapv(|tap| tap.re), loudest));
    let odd = filters
        .iter()
        .map(|filter| grey(&filter.mapv(|tap| tap.im), loudest));
    let gains = filters
        .iter()
        .map(|filter| spectrum(|wave| gain(filter, wave)));
    let pictures: Vec<_> = even.chain(odd).chain(gains).collect();
    let tiles = pictures
        .into_iter()
        .enumerate()
        .map(|(place, picture)| Tile {
            number: angle(place % orientations),
            picture,
        });
    sheet(&tiles.collect::<Vec<_>>(), orientations, 640)
}

/// The even filter and the two of the Riesz transform in space, and their gains below.
fn spherical_bank(params: MonogenicParams) -> anyhow::Result<Array2<[u8; 3]>> {
    let size = Size {
        width: 63,
        height: 63,
    };
    let bank = MonogenicBank::plan(params, size)?;
    let mut point = Array2::zeros(size.dim());
    point[[31, 31]] = 1.0;
    let seen = bank.respond(&LumaImage::new(point)?)?;
    let planes = &seen.scales()[0];
    // What a point answers with is the filter in a mirror; correlation mirrors it again.
    let filter = |plane: ArrayView2<'_, f32>| plane.slice(s![26..=36;-1, 26..=36;-1]).to_owned();
    let filters = [planes.even(), planes.along_x(), planes.along_y()].map(filter);
    let loudest = filters
        .iter()
        .flatten()
        .fold(0.0f32, |most, tap| most.max(tap.abs()));
    let gain = |wave: (f32, f32)| 2.0 * params.radial_gain(wave.0.hypot(wave.1));
    let share = |along: f32, wave: (f32, f32)| {
        let omega = wave.0.hypot(wave.1);
        if omega > 0.0 {
            along.abs() / omega
        } else {
            0.0
        }
    };
    let gains = [
        spectrum(gain),
        spectrum(|wave| gain(wave) * share(wave.0, wave)),
        spectrum(|wave| gain(wave) * share(wave.1, wave)),
    ];
    let filters = filters.iter().map(|filter| grey(filter, loudest));
    let tiles = filters.chain(gains).zip((0..3).cycle()).map(numbered);
    Ok(sheet(&tiles.collect::<Vec<_>>(), 3, 640))
}

/// Taps as squares: grey is 0, white the largest, black its negative.
fn grey(taps: &Array2<f32>, loudest: f32) -> Array2<[u8; 3]> {
    let (height, width) = taps.dim();
    Array2::from_shape_fn((height * ZOOM, width * ZOOM), |(y, x)| {
        let tap = taps[[y / ZOOM, x / ZOOM]] / loudest;
        [(127.5 + 127.5 * tap).round() as u8; 3]
    })
}

/// A gain over the frequencies from -pi to pi, standstill in the middle, y down, with a white line
/// where it is one half.
fn spectrum(gain: impl Fn((f32, f32)) -> f32) -> Array2<[u8; 3]> {
    let gains = plane_of(BINS, PI, gain);
    let range = ColourRange::covering(ndarray::aview2(&[[0.0, 1.0]]));
    let mut drawn = colour::paint(gains.view(), range);
    for place in half_gain(&gains) {
        drawn[place] = [255; 3];
    }
    drawn
}

/// Where each filter's gain is one half at three scales, in the hue of its orientation.
fn rosette(filters: usize, gain: impl Fn(usize, (f32, f32)) -> f32) -> Array2<[u8; 3]> {
    const HALF: usize = 110;
    let mut drawn = Array2::from_elem((2 * HALF + 1, 2 * HALF + 1), [255; 3]);
    for scale in [1.0f32, 2.0, 4.0] {
        for q in 0..filters {
            let gains = plane_of(HALF, PI, |wave| {
                let wave = (scale * wave.0, scale * wave.1);
                // A coarser scale has no frequencies beyond its own Nyquist frequency.
                let has = wave.0.abs().max(wave.1.abs()) <= PI;
                if has { gain(q, wave) } else { 0.0 }
            });
            let angle = 2.0 * PI * q as f32 / filters as f32;
            for place in half_gain(&gains) {
                drawn[place] = hue::of(Complex32::from_polar(0.8, angle), 1.0);
            }
        }
    }
    drawn
}

/// Numbers over the frequencies from `-reach` to `reach`.
fn plane_of(half: usize, reach: f32, of: impl Fn((f32, f32)) -> f32) -> Array2<f32> {
    let frequency = |place: usize| reach * (place as f32 - half as f32) / half as f32;
    let side = 2 * half + 1;
    Array2::from_shape_fn((side, side), |(y, x)| of((frequency(x), frequency(y))))
}

/// The pixels of at least half gain that have a neighbour of less.
fn half_gain(gains: &Array2<f32>) -> Vec<[usize; 2]> {
    let edge = |&((y, x), &gain): &((usize, usize), &f32)| {
        let neighbours = [
            (y, x + 1),
            (y + 1, x),
            (y, x.wrapping_sub(1)),
            (y.wrapping_sub(1), x),
        ];
        let less = |place| gains.get(place).is_some_and(|&gain| gain < 0.5);
        gain >= 0.5 && neighbours.into_iter().any(less)
    };
    gains
        .indexed_iter()
        .filter(edge)
        .map(|((y, x), _)| [y, x])
        .collect()
}

/// The gain of a filter at a frequency: the modulus of `sum_k h(k) exp(j w.k)`.
fn gain(filter: &Array2<Complex32>, wave: (f32, f32)) -> f32 {
    let radius = (filter.nrows() / 2) as f32;
    let terms = filter.indexed_iter().map(|((y, x), tap)| {
        tap * Complex32::cis(wave.0 * (x as f32 - radius) + wave.1 * (y as f32 - radius))
    });
    terms.sum::<Complex32>().norm()
}

/// Each feature of the motorcycle, at half its size; what has a picture for each orientation, at a
/// quarter.
fn features(folder: &Path) -> anyhow::Result<()> {
    let image = picture::decode(MOTORCYCLE)?.into_luma();
    let size = image.size();
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
    let seen = bank.respond(&image)?;
    let (half, quarter) = (&seen.scales()[1], &seen.scales()[2]);
    let energy = v1_picture::energy(&v1_picture::total_energy(half));
    let dominant = v1_picture::dominant_orientation(&half.dominant_orientation());
    let bank = MonogenicBank::plan(MonogenicParams::default().fitted_to(size), size)?;
    let monogenic = bank.respond(&image)?;
    let monogenic = &monogenic.scales()[1];
    for (name, drawn) in [
        (
            "v1-responses",
            v1_picture::by_orientation(v1_picture::responses(quarter)),
        ),
        ("v1-energy", energy),
        ("v1-dominant", dominant),
        (
            "v1-frequency",
            v1_picture::instantaneous_frequency(quarter, TAU),
        ),
        ("v1-singular", v1_picture::singularities(quarter, TAU)),
        (
            "v1-congruency",
            v1_picture::phase_congruency(&every_second(&seen.phase_congruency(0.01))),
        ),
        ("v1-monogenic-phase", v1_picture::monogenic_phase(monogenic)),
        (
            "v1-monogenic-orientation",
            v1_picture::monogenic_orientation(monogenic),
        ),
    ] {
        write(folder, name, drawn.view())?;
    }
    Ok(())
}

/// Means over squares of two pixels.
fn every_second(plane: &Array2<f32>) -> Array2<f32> {
    let (height, width) = plane.dim();
    Array2::from_shape_fn((height / 2, width / 2), |(y, x)| {
        plane.slice(s![2 * y..2 * y + 2, 2 * x..2 * x + 2]).sum() / 4.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_family_has_its_pictures() {
        let folder = tempfile::tempdir().unwrap();
        banks(folder.path()).unwrap();
        for name in [
            "bank-gabor",
            "bank-s4",
            "bank-s2",
            "bank-sqf",
            "bank-half-gain",
        ] {
            let drawn = picture::read(folder.path().join(format!("{name}.png"))).unwrap();
            assert!(drawn.size().width > 200, "{name}");
        }
    }

    /// The line of half gain crosses the axis at the frequencies that the bandwidth gives.
    #[test]
    fn the_line_is_where_the_gain_is_one_half() {
        let params = MonogenicParams::default();
        let gains = plane_of(200, PI, |wave| {
            2.0 * params.radial_gain(wave.0.hypot(wave.1))
        });
        let on_axis: Vec<f32> = half_gain(&gains)
            .into_iter()
            .filter(|&[y, x]| y == 200 && x > 200)
            .map(|[_, x]| PI * (x as f32 - 200.0) / 200.0)
            .collect();
        for edge in [0.5f32.exp2(), 0.5f32.exp2().recip()] {
            let want = params.peak_frequency * edge;
            // A pixel of the plane is 0.016 rad/px.
            assert!(
                on_axis.iter().any(|at| (at - want).abs() < 0.02),
                "{on_axis:?} {want}"
            );
        }
    }
}
