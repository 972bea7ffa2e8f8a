use std::io::Write;

use anyhow::Context as _;
use dorsal::egocentric_depth::{
    DriftBelief, OrientationParams, RigDrift, StereoRig, relative_orientation,
};
use dorsal::v1_gabor::{Binocular, FilterBank, GaborParams};
use stereo_formats::picture;
use stereo_formats::rig_toml::{self, SizedRig};

use crate::calibrate_arguments::CalibrateArguments;
use crate::console::Console;
use crate::drift_record::FoundDrift;
use crate::rig_file::{read_rig, rig_of_pictures};

/// How many matches a calibration uses: more than a look, which also has other things to do.
const MATCHES: usize = 20_000;

/// `dorsal calibrate`: corrects a rig by what its own eyes see.
pub(crate) fn calibrate(arguments: &CalibrateArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    let console = Console::new(arguments.quiet);
    let sized = read_rig(&arguments.rig)?;
    console.step("reading the pictures");
    let eyes = picture::read_pair(Binocular {
        left: &arguments.left,
        right: &arguments.right,
    })?;
    let size = eyes.left.size();
    let rig = expecting(rig_of_pictures(&sized, size)?, arguments)?;

    console.step("filtering what the eyes see");
    let gabor = GaborParams::default();
    let gabor = GaborParams {
        scales: gabor.most_scales(size),
        ..gabor
    };
    let bank = FilterBank::plan(gabor, size)?;
    let responses = eyes.as_ref().try_map(|eye| bank.respond(eye.luma()))?;
    console.step("matching the eyes");
    let found = arguments
        .range
        .range()
        .disparity(&responses, OrientationParams::matching())
        .context("the eyes cannot be matched")?;
    drop(responses);

    console.step("orienting the right eye");
    let expected = if arguments.turned {
        let turned = DriftBelief::new(RigDrift::default(), &OrientationParams::TURNED)?;
        OrientationParams::expecting(turned)
    } else {
        OrientationParams::of(&rig)
    };
    let params = OrientationParams {
        matches: MATCHES,
        ..expected
    };
    let orientation = relative_orientation(&found.field, &rig, &params).context(
        "the scene is degenerate: it does not tell where the right eye is, and the rig stays as it is",
    )?;
    let fixed = rig
        .drifted(&orientation.drift)?
        .with_sigma(orientation.standard_error)?;
    rig_toml::write_sized(
        &arguments.out,
        &SizedRig {
            rig: fixed,
            size: Some(size),
        },
    )?;
    console.clear();

    let drift = FoundDrift::of(&orientation);
    for warning in drift.warnings() {
        console.note(&warning);
    }
    if arguments.json {
        serde_json::to_writer_pretty(&mut *out, &drift)?;
        writeln!(out)?;
        return Ok(());
    }
    writeln!(out, "{}", drift.table())?;
    writeln!(
        out,
        "vertical  {:.3} px before, {:.3} px after (RMS)",
        orientation.vertical_rms_before_px, orientation.vertical_rms_after_px
    )?;
    writeln!(
        out,
        "matches   {}, {:.0} % of them off one plane",
        orientation.matches,
        100.0 * orientation.relief
    )?;
    writeln!(out, "written   {}", arguments.out.display())?;
    Ok(())
}

/// The rig with what the call says of how well it is known.
fn expecting(rig: StereoRig, arguments: &CalibrateArguments) -> anyhow::Result<StereoRig> {
    let own = rig.sigma();
    let slip = |own: f64| arguments.slip_sigma.unwrap_or(own);
    let yaw_rad = arguments.yaw_sigma.map(f64::to_radians);
    Ok(rig.with_sigma(RigDrift {
        yaw_rad: yaw_rad.unwrap_or(own.yaw_rad),
        down: slip(own.down),
        forward: slip(own.forward),
        ..own
    })?)
}
