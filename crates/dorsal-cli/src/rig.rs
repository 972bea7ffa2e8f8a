use std::io::Write;

use anyhow::ensure;
use dorsal::egocentric_depth::{
    Head, Lens, Position, Rectification, RigDrift, StereoRig, midpoint, resampled_rgb,
};
use dorsal::v1_gabor::{Binocular, Size};
use serde::Serialize;
use stereo_formats::rig_toml::{self, SizedRig};
use stereo_formats::{kalibr, middlebury_calib, npy, opencv_storage, picture, ros_camera_info};

use crate::console::Console;
use crate::outputs::{Outputs, ensure_folder};
use crate::rig_arguments::{
    CheckArguments, ConvertArguments, RectifyArguments, RigArguments, RigFiles, RigFormat, RigTask,
};
use crate::rig_file::{read_rig, read_rigs, rig_of_pictures};
use crate::text_table::TextTable;

/// `dorsal rig`: rigs in other formats, and what they can see.
pub(crate) fn rig(arguments: &RigArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    match &arguments.task {
        RigTask::Convert(convert) => self::convert(convert, out),
        RigTask::Check(check) => self::check(check, out),
        RigTask::Rectify(rectify) => self::rectify(rectify, out),
    }
}

/// A baseline that only a length in other units than metres explains, in metres: no head is as wide.
const MOST_BASELINE_M: f64 = 1.0;

/// The rig and the size of its pictures, which the call may say where the files do not.
fn read(files: &RigFiles, console: &Console) -> anyhow::Result<SizedRig> {
    let mut sized = read_rigs(&files.rig, files.unit_m)?;
    if let (Some(said), Some(size)) = (sized.size, files.size) {
        ensure!(
            said == size,
            "the rig is one of pictures of {said} pixels, not of {size}"
        );
    }
    sized.size = sized.size.or(files.size);
    let baseline_m = sized.rig.baseline_m();
    if baseline_m > MOST_BASELINE_M {
        console.note(&format!(
            "the eyes stand {baseline_m:.2} m apart; if the file counts something else than metres, such as \
             squares of a chessboard, --unit-m says how long one is"
        ));
    }
    Ok(sized)
}

fn convert(arguments: &ConvertArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let console = Console::new(false);
    let sized = read(&arguments.files, &console)?;
    let to = &arguments.out;
    match arguments.to {
        RigFormat::Rig => rig_toml::write_sized(to, &sized)?,
        RigFormat::Kalibr => kalibr::write(to, &sized)?,
        RigFormat::Middlebury => middlebury_calib::write(to, &sized.rig, sized.size)?,
        RigFormat::OpencvYaml => opencv_storage::write(to, &sized, opencv_storage::Form::Yaml)?,
        RigFormat::OpencvXml => opencv_storage::write(to, &sized, opencv_storage::Form::Xml)?,
        RigFormat::Ros => {
            ensure_folder(to)?;
            let pair = ros_camera_info::of_rig(&sized)?;
            let mut files = Outputs::default();
            files.add("left.yaml", || {
                anyhow::Ok(ros_camera_info::encode(&pair.left))
            });
            files.add("right.yaml", || {
                anyhow::Ok(ros_camera_info::encode(&pair.right))
            });
            files.write(to)?;
        }
    }
    if arguments.to != RigFormat::Rig
        && let Some(lost) = known_to_toml_alone(&sized.rig)
    {
        console.note(&format!(
            "{lost} has no place in this format and is left out; rig.toml holds it"
        ));
    }
    writeln!(out, "written   {}", to.display())?;
    Ok(())
}

/// What the rig knows that only a `rig.toml` holds.
fn known_to_toml_alone(rig: &StereoRig) -> Option<&'static str> {
    match (rig.tilt_rad() != 0.0, rig.sigma() != RigDrift::default()) {
        (true, true) => Some("the tilt of the head, and what is uncertain of the right eye,"),
        (true, false) => Some("the tilt of the head"),
        (false, true) => Some("what is uncertain of the right eye"),
        (false, false) => None,
    }
}

/// How far a depth may come back from its pixels and be the same, as a part of it: a folded lens is off by
/// far more, rounding by far less.
const SAME_DEPTH: f64 = 1e-6;

/// Depths at which errors are told, in metres.
const DEPTHS_M: [f64; 4] = [0.5, 1.0, 2.0, 5.0];

#[derive(Serialize)]
struct Check {
    baseline_m: f64,
    vergence_deg: f64,
    /// Where the lines of sight meet on the midline; nothing if they do not.
    fixation_m: Option<f64>,
    size: Option<[usize; 2]>,
    reaches: Vec<ScalesReach>,
    errors: Vec<DepthError>,
}

#[derive(Serialize)]
struct ScalesReach {
    scales: usize,
    nearest_m: Option<f64>,
    /// Nothing if there is no limit.
    farthest_m: Option<f64>,
}

#[derive(Serialize)]
struct DepthError {
    depth_m: f64,
    /// For an error of the disparity of one pixel.
    per_px_m: Option<f64>,
    /// For the error that the call names.
    of_disparity_m: Option<f64>,
    /// Of what is uncertain of the rig.
    of_pose_m: Option<f64>,
}

fn check(arguments: &CheckArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let console = Console::new(false);
    let sized = read(&arguments.files, &console)?;
    if sized.size.is_none() {
        console.note(
            "the rig does not say how large its pictures are, so a depth counts as seen wherever it \
             appears: give --size, or size_px in rig.toml",
        );
    }
    let rig = &sized.rig;
    let check = Check::of(rig, sized.size, arguments);
    if arguments.json {
        serde_json::to_writer_pretty(&mut *out, &check)?;
        writeln!(out)?;
        return Ok(());
    }
    cameras(rig, out)?;
    let metres = |m: Option<f64>| m.map_or_else(|| "-".to_owned(), |m| format!("{m:.2}"));
    if let Some(fixation_m) = check.fixation_m {
        writeln!(out, "fixates   {fixation_m:.3} m ahead")?;
    }
    writeln!(out)?;
    let mut table = TextTable::new([">scales", ">nearest m", ">farthest m"]);
    for reach in &check.reaches {
        let farthest = match (reach.nearest_m, reach.farthest_m) {
            (Some(_), None) => "any".to_owned(),
            (_, farthest) => metres(farthest),
        };
        table.line([reach.scales.to_string(), metres(reach.nearest_m), farthest]);
    }
    writeln!(out, "{table}")?;
    let mut table = TextTable::new([">depth m", ">mm a pixel", ">mm of disparity", ">mm of pose"]);
    let mm = |m: Option<f64>| m.map_or_else(|| "-".to_owned(), |m| format!("{:.1}", 1000.0 * m));
    for error in &check.errors {
        table.line([
            format!("{:.1}", error.depth_m),
            mm(error.per_px_m),
            mm(error.of_disparity_m),
            mm(error.of_pose_m),
        ]);
    }
    write!(out, "{table}")?;
    Ok(())
}

impl Check {
    fn of(rig: &StereoRig, size: Option<Size>, arguments: &CheckArguments) -> Self {
        let scales = match arguments.scales {
            Some(scales) => scales..=scales,
            None => 3..=8,
        };
        let reaches = scales.map(|scales| {
            let reach = u32::try_from(scales)
                .ok()
                .and_then(|scales| rig.reach(scales, 0.0 - arguments.zero_disparity));
            ScalesReach {
                scales,
                nearest_m: reach.map(|reach| reach.nearest_m),
                farthest_m: reach
                    .map(|reach| reach.farthest_m)
                    .filter(|m| m.is_finite()),
            }
        });
        let errors = DEPTHS_M.map(|depth_m| {
            let ahead = Position::<Head>::new(0.0, 0.0, depth_m);
            // A depth that an eye cannot see has no error.
            let seen = shown(rig, size, ahead).then(|| rig.depth_per_px(ahead));
            let per_px_m = seen.filter(|m| m.is_finite());
            DepthError {
                depth_m,
                per_px_m,
                of_disparity_m: per_px_m.map(|m| m * arguments.disparity_sigma),
                of_pose_m: per_px_m.map(|m| m * rig.pose_sigma_px(ahead)),
            }
        });
        let half = rig.vergence_rad() / 2.0;
        Self {
            baseline_m: rig.baseline_m(),
            vergence_deg: rig.vergence_rad().to_degrees(),
            fixation_m: (half > 0.0).then(|| rig.baseline_m() / 2.0 / half.tan()),
            size: size.map(|size| [size.width, size.height]),
            reaches: reaches.collect(),
            errors: errors.into(),
        }
    }
}

/// Whether both pictures show a point, as far as their size is known.
///
/// Beyond the part of a picture that a lens was measured in, its polynomial folds back and puts a point
/// where another is seen: the lines of sight of such pixels do not meet in the point.
fn shown(rig: &StereoRig, size: Option<Size>, point: Position<Head>) -> bool {
    let Some(pixels) = rig.project(point) else {
        return false;
    };
    let inside = |at: f64, length: usize| (-0.5..=length as f64 - 0.5).contains(&at);
    let shows = |(x, y): (f64, f64)| {
        size.is_none_or(|size| inside(x, size.width) && inside(y, size.height))
    };
    let eyes = rig.eyes();
    let rays = eyes.left.ray(pixels.left).zip(eyes.right.ray(pixels.right));
    let back = rays.and_then(|(left, right)| midpoint(Binocular { left, right }));
    let meets = |back: Position<Head>| (back.z_m - point.z_m).abs() < SAME_DEPTH * point.z_m;
    shows(pixels.left) && shows(pixels.right) && back.is_some_and(|back| meets(back.position))
}

/// The two cameras and how they stand, for a person.
fn cameras(rig: &StereoRig, out: &mut dyn Write) -> anyhow::Result<()> {
    let (eyes, lenses, attitude) = (rig.intrinsics(), rig.lenses(), rig.attitude());
    writeln!(
        out,
        "baseline  {:.4} m, vergence {:.3} deg, tilt {:.3} deg",
        rig.baseline_m(),
        rig.vergence_rad().to_degrees(),
        rig.tilt_rad().to_degrees()
    )?;
    let sides = [
        ("left ", eyes.left, lenses.left, attitude.left),
        ("right", eyes.right, lenses.right, attitude.right),
    ];
    for (side, eye, lens, attitude) in sides {
        let ((fx, fy), (cx, cy)) = (eye.focal_px, eye.principal_point_px);
        let [pan, tilt, torsion] = attitude.to_array().map(f64::to_degrees);
        let lens = match lens {
            Lens::Pinhole => "a pinhole".to_owned(),
            Lens::BrownConrady(terms) => format!("distorted {terms:?}"),
            Lens::Fisheye(terms) => format!("a fisheye {terms:?}"),
        };
        writeln!(
            out,
            "{side}     f {fx:.2}, {fy:.2} px, centre {cx:.2}, {cy:.2}; pan {pan:.3}, tilt {tilt:.3}, \
             torsion {torsion:.3} deg; {lens}"
        )?;
    }
    Ok(())
}

fn rectify(arguments: &RectifyArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    ensure_folder(&arguments.out)?;
    let sized = read_rig(&arguments.rig)?;
    let eyes = picture::read_pair(Binocular {
        left: &arguments.left,
        right: &arguments.right,
    })?;
    let size = eyes.left.size();
    let rig = rig_of_pictures(&sized, size)?;
    let plan = Rectification::plan(&rig, size)?;
    let maps = plan.maps();
    let mut files = Outputs::default();
    let sides = [
        ("left.png", &eyes.left, &maps.left),
        ("right.png", &eyes.right, &maps.right),
    ];
    for (name, eye, map) in sides {
        files.add(name, move || {
            picture::encode_rgb(resampled_rgb(eye.rgb(), map).view())
        });
    }
    let coordinates = [
        ("map_left_x.npy", maps.left.mapv(|(u, _)| u)),
        ("map_left_y.npy", maps.left.mapv(|(_, v)| v)),
        ("map_right_x.npy", maps.right.mapv(|(u, _)| u)),
        ("map_right_y.npy", maps.right.mapv(|(_, v)| v)),
    ];
    for (name, plane) in coordinates {
        files.add(name, move || anyhow::Ok(npy::encode(plane.view())));
    }
    files.add("rig.toml", || {
        rig_toml::encode_sized(&SizedRig {
            rig: plan.rig(),
            size: Some(size),
        })
    });
    let names = files.names();
    files.write(&arguments.out)?;
    let doffs = plan.rig().intrinsics();
    writeln!(
        out,
        "focal     {:.2} px, principal points {:.2} px apart",
        doffs.left.focal_px.0,
        doffs.right.principal_point_px.0 - doffs.left.principal_point_px.0
    )?;
    writeln!(
        out,
        "written   {} in {}",
        names.join(", "),
        arguments.out.display()
    )?;
    Ok(())
}
