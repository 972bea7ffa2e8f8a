use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use disparity_pyramid::{Population, binocular_energy};
use ndarray::Array2;
use num_complex::Complex32;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Responses, Size};

use crate::curve_svg::{self, Diagram, Sheet};
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::write_file;

/// Draws the tuning curves of binocular energy cells and their population for docs/level-2.md.
///
/// The curves are measured, not drawn: random textures are shifted, filtered by level 1, and the
/// cells of `disparity_pyramid` are asked at every pixel.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  cargo xtask population-pictures --out out")]
pub(crate) struct Options {
    /// Folder for the pictures; without it, docs/pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The picture's name.
const FILE: &str = "population-tuning.svg";

const SIZE: Size = Size {
    width: 160,
    height: 128,
};

/// Pixels that are asked: away from the border, a few apart, as neighbours say nearly the same.
const MARGIN: usize = 16;
const STEP: usize = 3;

/// Shifts that the three cells of each diagram prefer, px; the period of the filters is 4 px.
const PREFERRED_PX: [f32; 3] = [0.0, 1.0, 2.0];

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let folder = options
        .out
        .clone()
        .or_else(|| Some(docs_folder()?.join("pictures")))
        .context("no docs folder: name one with --out DIR")?;
    let sheet = sheet()?;
    let path = folder.join(FILE);
    write_file(&path, curve_svg::encode(&sheet).as_bytes())?;
    println!("written   {}", path.display());
    Ok(())
}

/// What the three diagrams show at one shift of the picture.
struct Asked {
    shift_px: f64,
    /// Response of each cell of one orientation, over the mean of all phase shifts.
    single: [f64; 3],
    /// Pooled response of each cell of the population.
    pooled: [f64; 3],
    /// Centre of mass along x, px.
    centre_px: f64,
}

fn sheet() -> anyhow::Result<Sheet> {
    let params = GaborParams {
        scales: 1,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(params, SIZE)?;
    let population = Population::tuned_to(&params.wave_vectors());
    let omega = params.peak_frequency;
    let steps = -24..=24i32;
    let asked: anyhow::Result<Vec<Asked>> = steps
        .map(|step| {
            let shift_px = f64::from(step) / 4.0;
            // A point at x is seen at x + dx by the right eye.
            let eyes = Binocular {
                left: texture(0.0)?,
                right: texture(shift_px)?,
            };
            let responses = eyes.try_map(|eye| bank.respond(&eye))?;
            let eyes = responses.as_ref().map(|eye| &eye.scales()[0]);
            Ok(ask(&eyes, &population, omega, shift_px))
        })
        .collect();
    let asked = asked?;
    let curve = |of: &dyn Fn(&Asked) -> f64, within_px: f64| {
        let points = asked.iter().filter(|a| a.shift_px.abs() <= within_px);
        points.map(|a| (a.shift_px, of(a))).collect::<Vec<_>>()
    };
    Ok(Sheet {
        title: "binocular energy cells, answers to random textures shifted by dx (px)".to_owned(),
        names: PREFERRED_PX.map(|px| format!("prefers {px} px")).to_vec(),
        diagrams: vec![
            Diagram {
                title: "one orientation, energy / mean".to_owned(),
                curves: [0, 1, 2]
                    .map(|cell| curve(&|a| a.single[cell], 6.0))
                    .to_vec(),
            },
            Diagram {
                title: "pooled over eight orientations".to_owned(),
                curves: [0, 1, 2]
                    .map(|cell| curve(&|a| a.pooled[cell], 6.0))
                    .to_vec(),
            },
            Diagram {
                title: "centre of mass of 289 cells, px".to_owned(),
                curves: vec![curve(&|a| a.centre_px, 3.0)],
            },
        ],
    })
}

/// Means over the asked pixels.
fn ask(eyes: &Binocular<&Responses>, population: &Population, omega: f32, shift_px: f64) -> Asked {
    let place = |px: f32| {
        let near = population
            .preferred_px()
            .map(|preferred| (preferred - px).abs());
        near.enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(place, _)| place)
    };
    let (row, cells) = (place(0.0), PREFERRED_PX.map(place));
    let mut asked = Asked {
        shift_px,
        single: [0.0; 3],
        pooled: [0.0; 3],
        centre_px: 0.0,
    };
    let (mut energy, mut pixels) = (0.0, 0.0);
    for y in (MARGIN..SIZE.height - MARGIN).step_by(STEP) {
        for x in (MARGIN..SIZE.width - MARGIN).step_by(STEP) {
            let pair = |q: usize| (eyes.left.at(q, x, y), eyes.right.at(q, x, y));
            let (left, right) = pair(0);
            energy += f64::from(left.norm_sqr() + right.norm_sqr());
            for (sum, px) in asked.single.iter_mut().zip(PREFERRED_PX) {
                *sum += f64::from(binocular_energy(left, right, omega * px));
            }
            let products: Vec<Complex32> = (0..eyes.left.orientations())
                .map(|q| {
                    let (left, right) = pair(q);
                    let energies = 0.5 * (left.norm_sqr() + right.norm_sqr());
                    left * right.conj() / energies.max(f32::MIN_POSITIVE)
                })
                .collect();
            let responses = population.respond(&products);
            for (sum, cell) in asked.pooled.iter_mut().zip(cells) {
                *sum += f64::from(responses[[row, cell]]);
            }
            let centre = population.centre_of_mass(responses.view());
            asked.centre_px += centre.map_or(0.0, |((dx, _), _)| f64::from(dx));
            pixels += 1.0;
        }
    }
    asked.single = asked.single.map(|sum| sum / energy);
    asked.pooled = asked.pooled.map(|sum| sum / pixels);
    asked.centre_px /= pixels;
    asked
}

/// Waves of all directions and lengths, moved right by `shift_px`.
fn texture(shift_px: f64) -> anyhow::Result<LumaImage> {
    let waves = (0..160u32).map(|wave| {
        // Steps of the golden section fill an interval evenly, in no order.
        let spread = |start: f64| (start + f64::from(wave) * 0.618_033_988_75).fract();
        let frequency = 0.15 * 18f64.powf(spread(0.3));
        let direction = std::f64::consts::TAU * spread(0.1) * 7.0;
        let phase = std::f64::consts::TAU * (f64::from(wave * wave) * 0.414_213_562).fract();
        (
            frequency * direction.cos(),
            frequency * direction.sin(),
            phase,
            0.02 / frequency.sqrt(),
        )
    });
    let waves: Vec<_> = waves.collect();
    let plane = Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
        let sum = waves.iter().map(|&(u, v, phase, amplitude)| {
            amplitude * (u * (x as f64 - shift_px) + v * y as f64 + phase).sin()
        });
        (0.5 + sum.sum::<f64>()) as f32
    });
    Ok(LumaImage::new(plane)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_prefer_what_they_say() {
        let sheet = sheet().unwrap();
        for diagram in &sheet.diagrams[..2] {
            for (curve, preferred) in diagram.curves.iter().zip(PREFERRED_PX) {
                let best = curve.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
                let apart = (best.0 - f64::from(preferred)).abs();
                // One orientation does not tell shifts apart that differ by its period of 4 px. A broad
                // band may move a peak by two steps of a quarter of a pixel.
                assert!(apart.min((4.0 - apart).abs()) <= 0.51, "{best:?}");
            }
        }
        let centre = &sheet.diagrams[2].curves[0];
        let at = |shift: f64| centre.iter().find(|p| p.0 == shift).unwrap().1;
        assert!(at(0.0).abs() < 0.01 && (at(0.5) - 0.5).abs() < 0.1);
    }
}
