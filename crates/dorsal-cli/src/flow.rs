use std::io::Write;

use anyhow::{Context as _, ensure};
use dorsal::disparity_pyramid::{DisparityField, MatchParams, estimate};
use dorsal::v1_gabor::{Binocular, FilterBank, GaborParams};
use stereo_formats::colour::ColourRange;
use stereo_formats::{VectorPlanes, flo, flow_picture, pfm, picture, validity_png};

use crate::console::Console;
use crate::flow_arguments::FlowArguments;
use crate::flow_record::FlowRecord;
use crate::look_files::coloured_png;
use crate::outputs::{Outputs, ensure_folder};
use crate::report::flow_page;
use crate::times::Times;

/// Below this part of valid pixels a flow deserves a word.
const SPARSE: f64 = 0.2;

/// `dorsal flow`: how every point moves between two moments of one eye.
///
/// The estimator is that of two eyes; the earlier moment takes the left eye's place, so that
/// `(dx, dy)` of a point is where it has gone.
pub(crate) fn flow(arguments: &FlowArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    ensure_folder(&arguments.out)?;
    let console = Console::new(arguments.quiet);
    let mut times = Times::default();

    console.step("reading the frames");
    let (prev, next) = times.measure("reading", || {
        anyhow::Ok((
            picture::read(&arguments.prev)?,
            picture::read(&arguments.next)?,
        ))
    })?;
    let size = prev.size();
    ensure!(
        size == next.size(),
        "{} has {size} pixels and {} has {}; two frames of one eye have one size",
        arguments.prev.display(),
        arguments.next.display(),
        next.size()
    );
    let gabor = GaborParams {
        scales: arguments.scales,
        ..GaborParams::default()
    }
    .fitted_to(size);
    if gabor.scales < arguments.scales {
        console.note(&format!(
            "frames of {size} pixels carry {} scales, not {}",
            gabor.scales, arguments.scales
        ));
    }
    let matching = MatchParams::for_flow();
    let matching = MatchParams {
        energy_threshold: arguments
            .energy_threshold
            .unwrap_or(matching.energy_threshold),
        ..matching
    };

    console.step("filtering the frames");
    let responses = times.measure("responses", || {
        let bank = FilterBank::plan(gabor, size)?;
        let moments = Binocular {
            left: prev.luma(),
            right: next.luma(),
        };
        anyhow::Ok(moments.try_map(|moment| bank.respond(moment))?)
    });
    let responses = responses.context("the frames cannot be filtered")?;
    console.step("matching the frames");
    let field = times
        .measure("flow", || estimate(&responses, matching))
        .context("the frames cannot be matched")?;
    drop(responses);
    if field.density() < SPARSE {
        console.note(&format!(
            "only {:.1} % of the pixels are valid; are the frames of one eye, and does the search \
             (--scales) reach their motion?",
            100.0 * field.density()
        ));
    }

    console.step("writing");
    let record = FlowRecord::new(arguments, &gabor, &matching, &field, &times);
    let motion_px = record.motion_px;
    let page = || flow_page([&prev, &next], &field, &times);
    let files = files(&field, record, arguments.dense, page);
    let names = files.names();
    let mut writing = Times::default();
    writing.measure("writing", || files.write(&arguments.out))?;
    let times = times.and(writing);
    console.clear();

    writeln!(out, "size      {size} pixels")?;
    writeln!(out, "valid     {:.1} %", 100.0 * field.density())?;
    if let Some(motion_px) = motion_px {
        writeln!(
            out,
            "motion    u {:+.2}, v {:+.2} px in the median; speed {:.2} px, at most {:.2}",
            motion_px.median_u, motion_px.median_v, motion_px.median_speed, motion_px.most_speed
        )?;
    }
    writeln!(out, "time      {}", times.sentence())?;
    writeln!(
        out,
        "written   {} in {}",
        names.join(", "),
        arguments.out.display()
    )?;
    Ok(())
}

/// The files that a flow leaves.
fn files<'a>(
    field: &'a DisparityField,
    mut record: FlowRecord,
    dense: bool,
    page: impl FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'a,
) -> Outputs<'a> {
    let mut files = Outputs::default();
    files.add("flow.flo", move || flo::encode_disparity(field, dense));
    files.add("flow.png", move || {
        let vectors = if dense {
            VectorPlanes::new(field.dx().to_owned(), field.dy().to_owned())?
        } else {
            VectorPlanes::new(field.only_valid(field.dx()), field.only_valid(field.dy()))?
        };
        let full_px = flow_picture::full_speed_px(&vectors);
        let painted = flow_picture::paint(&vectors, full_px);
        let sheet = flow_picture::over_wheel(painted.view(), full_px);
        anyhow::Ok(picture::encode_rgb(sheet.view())?)
    });
    files.add("confidence.pfm", || pfm::encode(field.confidence()));
    files.add("confidence.png", || {
        let whole = ColourRange::new(0.0, 1.0)?;
        anyhow::Ok(coloured_png(field.confidence(), whole, "")?)
    });
    files.add("validity.png", || validity_png::encode(field.validity()));
    files.add("index.html", page);
    record.files = files.names();
    record.files.push("flow.json".into());
    files.add("flow.json", move || serde_json::to_vec_pretty(&record));
    files
}
