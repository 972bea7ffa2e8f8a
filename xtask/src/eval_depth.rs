use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{DisparityField, EyeView, MatchParams, estimate, estimate_near_first};
use dorsal::DenseLook;
use egocentric_depth::{
    Attitude, CameraIntrinsics, DepthMap, DriftBelief, Lens, OrientationParams, RigDrift,
    StereoRig, relative_orientation, triangulate, triangulate_guesses,
};
use ndarray::Array2;
use stereo_scenes::{Exposure, Gaze, Head, Room, View, render};
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, V1Responses};

use crate::camera_noise::CameraNoise;
use crate::data_folder;
use crate::date;
use crate::depth_run::{Condition, DepthErrors, DepthRun, RealDepth, Recalibrated, Viewed};
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;

/// The paper's depth experiment: objects from 0.4 to 2.5 m before its head, whose eyes are apart along
/// the rows, along the columns, or verge; with the true rig and with one that is out by a degree about
/// each axis and recalibrated.
///
/// Prints errors by distance and condition and whether the marks hold; writes docs/depth.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-depth
  cargo xtask eval-depth --data ~/data --json out/depth.json --check")]
pub(crate) struct Options {
    /// The data folder, for the depth of the metric pair; without it, the one that the variable
    /// DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/depth.md
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Distances of the objects, metres.
const DISTANCES_M: [f64; 8] = [0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 2.0, 2.5];

/// By how much the rig is out about each axis, degrees.
const OUT_DEG: f64 = 1.0;

/// One standard deviation of what the encoders read of the vergence, degrees; the reading is off by as
/// much.
const ENCODER_DEG: f64 = 0.2;

/// How well a machined bar holds the centres, baselines.
const PLACED: f64 = 1e-3;

/// A lens of the usual barrel: some 15 px in the corners.
const LENS: Lens = Lens::BrownConrady([-0.06, 0.01, 0.0005, -0.0005, 0.0, 0.0, 0.0, 0.0]);

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let progress = progress(options.quiet);
    progress.set_length((DISTANCES_M.len() * Condition::ALL.len()) as u64);
    let mut run = DepthRun::new(date::today(), Machine::this());
    for condition in Condition::ALL {
        for distance_m in DISTANCES_M {
            progress.set_message(format!("{}, {distance_m} m", condition.name()));
            let viewed = view(condition, distance_m)
                .with_context(|| format!("{} at {distance_m} m", condition.name()))?;
            run.viewed.push(viewed);
            progress.inc(1);
        }
    }
    if let Ok(data) = data_folder::required(options.data.as_deref()) {
        run.real = real(&data)?;
    }
    progress.finish_and_clear();
    println!("{run}");
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || docs_folder().map(|docs| docs.join("depth.md"));
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, run.page().as_bytes())?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// Three objects at a distance before the paper's head, and a wall far behind them.
fn room(distance_m: f64) -> anyhow::Result<Room> {
    // The head's middle is at (3, 0.5, 1.5) and looks along the room's y.
    let (away, size, side) = (0.5 + distance_m, 0.2 * distance_m, 0.22 * distance_m);
    let patch = 0.05 * distance_m;
    let text = format!(
        "size_m = [6.0, 6.0, 3.0]\nlamp_m = [2.0, 0.3, 2.8]\n\
         [head]\nposition_m = [3.0, 0.5, 1.5]\nfixation_m = [3.0, {away}, 1.5]\n\
         [walls]\nfar = {{ colour = [0.75, 0.72, 0.65], patch_m = 0.3 }}\n\
         [[object]]\nname = \"panel\"\n\
         shape.rectangle = {{ centre_m = [3.0, {away}, 1.5], size_m = [{size}, {size}], turn_deg = 20 }}\n\
         texture = {{ colour = [0.9, 0.8, 0.6], patch_m = {patch} }}\n\
         [[object]]\nname = \"ball\"\n\
         shape.sphere = {{ centre_m = [{}, {away}, 1.5], radius_m = {} }}\n\
         texture = {{ colour = [0.5, 0.6, 0.9], patch_m = {patch} }}\n\
         [[object]]\nname = \"can\"\n\
         shape.cylinder = {{ base_m = [{}, {away}, {}], radius_m = {}, height_m = {size} }}\n\
         texture = {{ colour = [0.9, 0.6, 0.5], patch_m = {patch} }}\n",
        3.0 - side,
        size / 2.0,
        3.0 + side,
        1.5 - size / 2.0,
        size / 2.0,
    );
    Ok(Room::from_toml(&text)?)
}

/// The paper's head in one condition, fixating at a distance.
fn rig(condition: Condition, distance_m: f64) -> anyhow::Result<StereoRig> {
    let head = Head::default();
    let camera = head.intrinsics();
    let both = Binocular {
        left: camera,
        right: camera,
    };
    let half_px = head.focal_px * head.baseline_m / 2.0 / distance_m;
    let (cx, cy) = camera.principal_point_px;
    let centred = |principal_point_px| CameraIntrinsics {
        principal_point_px,
        ..camera
    };
    let rig = match condition {
        // Parallel eyes whose sensors are shifted, so that what is fixated has no disparity.
        Condition::Horizontal => StereoRig::parallel(
            Binocular {
                left: centred((cx - half_px, cy)),
                right: centred((cx + half_px, cy)),
            },
            head.baseline_m,
        )?,
        // The same eyes, lying on their sides: the baseline runs along the columns.
        Condition::Vertical => {
            let lying = Attitude {
                torsion_rad: std::f64::consts::FRAC_PI_2,
                ..Attitude::default()
            };
            StereoRig::aimed(
                Binocular {
                    left: centred((cx, cy + half_px)),
                    right: centred((cx, cy - half_px)),
                },
                head.baseline_m,
                Binocular {
                    left: lying,
                    right: lying,
                },
            )?
        }
        Condition::Both => {
            let pan = (head.baseline_m / 2.0 / distance_m).atan();
            StereoRig::vergent(
                both,
                head.baseline_m,
                Binocular {
                    left: pan,
                    right: -pan,
                },
            )?
        }
    };
    Ok(rig.with_lenses(Binocular {
        left: LENS,
        right: LENS,
    })?)
}

fn view(condition: Condition, distance_m: f64) -> anyhow::Result<Viewed> {
    let nominal = rig(condition, distance_m)?;
    let Looked { seen, field, .. } = look(&nominal, distance_m, 1)?;
    let exact = DepthErrors::of(&triangulate(&field, &nominal), &seen.truth);
    // The head believes in the nominal rig; its right eye is a degree out about each axis.
    let out = RigDrift {
        pitch_rad: OUT_DEG.to_radians(),
        yaw_rad: OUT_DEG.to_radians(),
        roll_rad: OUT_DEG.to_radians(),
        ..RigDrift::default()
    };
    let looked = look(&nominal.drifted(&out)?, distance_m, 2)?;
    let Looked { seen, field, .. } = &looked;
    let uncorrected = DepthErrors::of(&triangulate(field, &nominal), &seen.truth);
    let params = OrientationParams {
        matches: 20_000,
        ..OrientationParams::expecting(encoders(condition, &out)?)
    };
    let vertical = estimate(&looked.responses, OrientationParams::matching())?;
    let recalibrated = match relative_orientation(&vertical, &nominal, &params) {
        Err(reason) => Recalibrated::Refused(reason.to_string()),
        Ok(found) => {
            let off: Vec<f64> = found
                .drift
                .to_array()
                .iter()
                .zip(out.to_array())
                .map(|(found, out)| (found - out).to_degrees())
                .collect();
            let fixed = nominal.drifted(&found.drift)?;
            Recalibrated::Found {
                off_deg: [off[0], off[1], off[2]],
                errors: DepthErrors::of(&triangulate(field, &fixed), &seen.truth),
            }
        }
    };
    Ok(Viewed {
        condition,
        distance_m,
        mm_per_px: 1000.0
            * nominal.depth_per_px(egocentric_depth::Position::new(0.0, 0.0, distance_m)),
        exact,
        uncorrected,
        recalibrated,
    })
}

/// What encoders tell of the right eye before the images: the turn that makes vergence, to their error
/// and off by it, and that the centres are where the bar holds them.
fn encoders(condition: Condition, out: &RigDrift) -> anyhow::Result<DriftBelief> {
    let error_rad = ENCODER_DEG.to_radians();
    let mut expected = RigDrift::default();
    let mut sigma = RigDrift {
        pitch_rad: f64::INFINITY,
        yaw_rad: f64::INFINITY,
        roll_rad: f64::INFINITY,
        down: PLACED,
        forward: PLACED,
    };
    // An eye that lies on its side verges about its own x axis.
    if condition == Condition::Vertical {
        expected.pitch_rad = out.pitch_rad + error_rad;
        sigma.pitch_rad = error_rad;
    } else {
        expected.yaw_rad = out.yaw_rad + error_rad;
        sigma.yaw_rad = error_rad;
    }
    Ok(DriftBelief::new(expected, &sigma)?)
}

/// The objects as they are, and what the eyes see of them.
struct Looked {
    seen: View,
    responses: Binocular<V1Responses>,
    field: DisparityField,
}

/// Renders the objects as a camera takes them, and matches the eyes.
fn look(rig: &StereoRig, distance_m: f64, seed: u64) -> anyhow::Result<Looked> {
    let room = room(distance_m)?;
    let head = Head::default();
    let gaze = Gaze::new([3.0, 0.5, 1.5], 0.0, head.size, *rig)?;
    let seen = render(&room, &gaze, Exposure::default())?;
    let taken = Binocular {
        left: taken(&seen.images.left, 2 * seed)?,
        right: taken(&seen.images.right, 2 * seed + 1)?,
    };
    let gabor = GaborParams::default();
    let bank = FilterBank::plan(gabor, head.size)?;
    let responses = taken.as_ref().try_map(|eye| bank.respond(eye))?;
    // What the head fixates has no disparity, so the search is about zero.
    let field = estimate(&responses, MatchParams::default())?;
    Ok(Looked {
        seen,
        responses,
        field,
    })
}

/// A picture as a camera takes it.
fn taken(light: &LumaImage, seed: u64) -> anyhow::Result<LumaImage> {
    let codes: Array2<u8> = CameraNoise::default().take(light.plane(), seed);
    Ok(LumaImage::new(codes.mapv(|code| f32::from(code) / 255.0))?)
}

/// The metric pair of the data: depth by either estimator against the truth.
fn real(data: &std::path::Path) -> anyhow::Result<Vec<RealDepth>> {
    let mut rows = Vec::new();
    for scene in stereo_formats::scene_folder::stereo_scenes(data)? {
        let (Some(rig), true) = (
            scene.description.rig,
            scene.description.name == "motorcycle",
        ) else {
            continue;
        };
        let truth = scene.truth()?.context("it has no truth")?;
        let eyes = scene.pair()?;
        let gabor = GaborParams::default();
        let gabor = GaborParams {
            scales: gabor.most_scales(eyes.left.size()),
            ..gabor
        };
        let bank = FilterBank::plan(gabor, eyes.left.size())?;
        let responses = eyes.as_ref().try_map(|eye| bank.respond(eye.luma()))?;
        let matching = MatchParams::default();
        let vector = estimate_near_first(&responses, matching)?.field;
        drop(responses);
        let views = eyes.as_ref().map(|eye| EyeView {
            luma: eye.luma(),
            rgb: Some(eye.rgb()),
        });
        let dense = DenseLook::default().disparity(&views, &rig, &bank, matching)?;
        let shift = Array2::zeros(truth.dim());
        let valid = truth.mapv(|d| {
            if d.is_finite() {
                disparity_pyramid::Validity::Valid
            } else {
                disparity_pyramid::Validity::NoEnergy
            }
        });
        let dx = truth.mapv(|d| if d.is_finite() { -d } else { 0.0 });
        let sure = Array2::ones(truth.dim());
        let true_field = DisparityField::new(dx, shift, sure, valid)?;
        let true_depth = triangulate(&true_field, &rig);
        let depths: [(&'static str, DepthMap); 3] = [
            ("vector, valid", triangulate(&vector, &rig)),
            ("dense, valid", triangulate(&dense, &rig)),
            ("dense, everywhere", triangulate_guesses(&dense, &rig)),
        ];
        for (by, depth) in depths {
            let scene = &scene.description.name;
            rows.extend(RealDepth::by_distance(scene, by, &depth, &true_depth));
        }
    }
    Ok(rows)
}
