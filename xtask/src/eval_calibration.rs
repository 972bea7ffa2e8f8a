use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{DisparityField, estimate_from_votes};
use egocentric_depth::{
    Attitude, CameraIntrinsics, DriftBelief, Lens, OrientationParams, RelativeOrientation,
    RelativePose, RigDrift, Rotation, StereoRig, midpoint, relative_orientation,
};
use ndarray::Array2;
use stereo_formats::points::PointPair;
use stereo_formats::scene_folder::{self, StereoScene};
use stereo_formats::scene_toml::Pose;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

use crate::alteration::Alteration;
use crate::calibration_run::{CalibrationRun, Depths, Injected, PointRig};
use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;

/// Calibrates rigs from their own images and compares with what is known: turns put into a rectified
/// pair, verged cameras put out of their published pose, a raw and distorted pair nobody aligned.
///
/// Prints what was found and whether the marks hold; writes docs/calibration.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-calibration --data ~/data
  cargo xtask eval-calibration --json out/calibration.json --check")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/calibration.md
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Pairs without vertical disparity into which turns are put.
const RECTIFIED: [&str; 3] = ["venus", "sawtooth", "teddy"];

/// What is put in, in degrees: pitch and roll.
const INJECTED_DEG: [(f64, f64); 2] = [(1.0, 1.0), (0.0, 0.0)];

/// By how much the published pose of verged eyes is put out, about each axis.
const PUT_OUT_DEG: f64 = 0.5;

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder::required(options.data.as_deref())?;
    let scenes = scene_folder::stereo_scenes(&data)?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut run = CalibrationRun::new(date::today(), Machine::this());
    for scene in &scenes {
        let name = &scene.description.name;
        progress.set_message(name.clone());
        let context = || format!("scene {name}");
        if RECTIFIED.contains(&&**name) {
            for injected in INJECTED_DEG {
                let found = inject(scene, injected).with_context(context)?;
                run.injected.push(found);
            }
        }
        if let (Some(points), Some(pose)) = (scene.points()?, scene.description.pose) {
            let found = at_points(scene, &points, &pose).with_context(context)?;
            run.points.push(found);
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("{run}");
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || docs_folder().map(|docs| docs.join("calibration.md"));
    if let Some(path) = options.results.clone().or_else(docs) {
        write_page(&path, &run)?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

fn write_page(path: &Path, run: &CalibrationRun) -> anyhow::Result<()> {
    write_file(path, run.page().as_bytes())
}

/// A camera of a picture whose focal length nobody published: as wide as the picture.
fn assumed_camera(size: Size) -> CameraIntrinsics {
    let middle = |side: usize| (side as f64 - 1.0) / 2.0;
    CameraIntrinsics {
        focal_px: (size.width as f64, size.width as f64),
        principal_point_px: (middle(size.width), middle(size.height)),
    }
}

fn inject(scene: &StereoScene, (pitch_deg, roll_deg): (f64, f64)) -> anyhow::Result<Injected> {
    let eyes = scene.pair()?;
    let size = eyes.left.size();
    let alteration = Alteration {
        pitch_deg,
        roll_deg,
        ..Alteration::NONE
    };
    let luma = |codes: Array2<u8>| LumaImage::new(codes.mapv(|grey| f32::from(grey) / 255.0));
    let pair = Binocular {
        left: luma(alteration.of_left(eyes.left.luma().plane()))?,
        right: luma(alteration.of_right(eyes.right.luma().plane()))?,
    };
    let camera = assumed_camera(size);
    let both = Binocular {
        left: camera,
        right: camera,
    };
    let rig = StereoRig::parallel(both, 0.1)?;
    let field = look(&pair.as_ref())?;
    let found = relative_orientation(&field, &rig, &OrientationParams::of(&rig))?;
    Ok(Injected {
        scene: scene.description.name.clone(),
        pitch_deg,
        roll_deg,
        found: found.into(),
    })
}

/// The vector disparity of a pair of which nothing is known.
fn look(eyes: &Binocular<&LumaImage>) -> anyhow::Result<DisparityField> {
    let gabor = GaborParams::default();
    let size = eyes.left.size();
    let gabor = GaborParams {
        scales: gabor.most_scales(size),
        ..gabor
    };
    let bank = FilterBank::plan(gabor, size)?;
    let responses = eyes.try_map(|eye| bank.respond(eye))?;
    Ok(estimate_from_votes(&responses, OrientationParams::matching())?.field)
}

fn at_points(scene: &StereoScene, points: &[PointPair], pose: &Pose) -> anyhow::Result<PointRig> {
    let published = published(pose)?;
    let eyes = scene.pair()?;
    let field = look(&eyes.as_ref().map(|eye| eye.luma()))?;
    let start = if pose.metric {
        let turn = PUT_OUT_DEG.to_radians();
        published.drifted(&RigDrift {
            pitch_rad: turn,
            yaw_rad: turn,
            roll_rad: turn,
            ..RigDrift::default()
        })?
    } else {
        as_mounted(&published)?
    };
    let orient = |params: &OrientationParams| relative_orientation(&field, &start, params);
    let found: RelativeOrientation = orient(&OrientationParams::of(&start))?;
    let fixed = start.drifted(&found.drift)?;
    // The same eyes expected to have turned where they sit.
    let turned = DriftBelief::new(RigDrift::default(), &OrientationParams::TURNED)?;
    let turned = orient(&OrientationParams::expecting(turned))?;
    let depths = |rig: &StereoRig| {
        pose.metric
            .then(|| Depths::of(depth_errors_m(&field, points, rig)))
            .flatten()
    };
    Ok(PointRig {
        scene: scene.description.name.clone(),
        start: if pose.metric {
            format!("turned by {PUT_OUT_DEG} deg about each axis, in its place")
        } else {
            "parallel, nothing known but the cameras".to_owned()
        },
        apart: apart(&fixed, &published).map(f64::to_degrees),
        misaligned_published_px: misaligned(points, &published),
        misaligned_before_px: misaligned(points, &start),
        misaligned_after_px: misaligned(points, &fixed),
        published: depths(&published),
        before: depths(&start),
        after: depths(&fixed),
        after_turned: depths(&start.drifted(&turned.drift)?),
        found: found.into(),
    })
}

fn published(pose: &Pose) -> anyhow::Result<StereoRig> {
    let rig = StereoRig::from_pose(
        pose.intrinsics,
        &RelativePose {
            rotation: Rotation::from_matrix(pose.rotation)?,
            translation_m: pose.translation,
        },
    )?;
    let lens = |[k1, k2, p1, p2, k3]: [f64; 5]| {
        if [k1, k2, p1, p2, k3] == [0.0; 5] {
            Lens::Pinhole
        } else {
            Lens::BrownConrady([k1, k2, p1, p2, k3, 0.0, 0.0, 0.0])
        }
    };
    Ok(rig.with_lenses(pose.distortion.map(lens))?)
}

/// The cameras as someone screws them to a bar: side by side, looking straight on.
fn as_mounted(rig: &StereoRig) -> anyhow::Result<StereoRig> {
    let straight = Binocular {
        left: Attitude::default(),
        right: Attitude::default(),
    };
    let parallel = StereoRig::aimed(rig.intrinsics(), rig.baseline_m(), straight)?;
    Ok(parallel.with_lenses(rig.lenses())?)
}

/// How two rigs differ in the turn of the right camera to the left one: pitch, yaw and roll, rad.
fn apart(rig: &StereoRig, published: &StereoRig) -> [f64; 3] {
    let (ours, theirs) = (
        rig.relative_pose().rotation,
        published.relative_pose().rotation,
    );
    theirs.after(&ours.inverse()).to_vector()
}

/// The median distance of the right pixels from their epipolar lines, px.
fn misaligned(points: &[PointPair], rig: &StereoRig) -> Option<f64> {
    let mut misses: Vec<f64> = points
        .iter()
        .filter_map(|point| {
            rig.misalignment_px(Binocular {
                left: point.left_px,
                right: point.right_px,
            })
        })
        .map(f64::abs)
        .collect();
    misses.sort_unstable_by(f64::total_cmp);
    misses.get(misses.len() / 2).copied()
}

/// The errors of depth along the left optical axis at the points whose pixel has a valid disparity.
fn depth_errors_m(field: &DisparityField, points: &[PointPair], rig: &StereoRig) -> Vec<f64> {
    let eyes = rig.eyes();
    points
        .iter()
        .filter_map(|point| {
            let (x, y) = point.left_px;
            // The disparity of the nearest pixel: it changes by hundredths of a pixel within half a one.
            let seen = field.at(x.round() as usize, y.round() as usize)?;
            let right = (x + f64::from(seen.dx), y + f64::from(seen.dy));
            let rays = Binocular {
                left: eyes.left.ray((x, y))?,
                right: eyes.right.ray(right)?,
            };
            let at = midpoint(rays)?.position.to_array();
            let from = eyes.left.centre.to_array();
            let forward = eyes.left.rotation.apply([0.0, 0.0, 1.0]);
            let depth_m: f64 = (0..3).map(|i| (at[i] - from[i]) * forward[i]).sum();
            Some((depth_m - point.depth_m?).abs())
        })
        .collect()
}
