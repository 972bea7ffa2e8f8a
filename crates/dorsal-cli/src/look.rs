use std::io::Write;
use std::path::Path;

use dorsal::egocentric_depth::RelativeOrientation;
use dorsal::v1_gabor::Binocular;
use stereo_formats::picture;

use crate::batch::batch;
use crate::console::Console;
use crate::drift_record::DriftRecord;
use crate::look_arguments::LookArguments;
use crate::look_files::look_files;
use crate::look_options::Estimator;
use crate::look_record::{Inputs, LookRecord};
use crate::look_room::LookRoom;
use crate::object_table::object_table;
use crate::objects::Objects;
use crate::outputs::ensure_folder;
use crate::relation_table::relation_table;
use crate::report::look_page;
use crate::sight_log::log_of_one;
use crate::times::Times;

/// Below this part of valid pixels a disparity field deserves a word.
const SPARSE: f64 = 0.2;

/// Vertical disparity that a correction would take away before it is worth the asking, in pixels.
const MOST_VERTICAL_PX: f64 = 0.2;

/// `dorsal look`: looks at a pair of files, or at all pairs of a folder or a list, and writes what is seen.
pub(crate) fn look(arguments: &LookArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    ensure_folder(&arguments.out)?;
    match &arguments.right {
        Some(right) => look_once(arguments, right, out),
        None => batch(arguments, out),
    }
}

fn look_once(arguments: &LookArguments, right: &Path, out: &mut dyn Write) -> anyhow::Result<()> {
    let options = &arguments.options;
    let console = Console::new(arguments.quiet);
    let mut times = Times::default();

    console.step("reading the pictures");
    let eyes = times.measure("reading", || {
        picture::read_pair(Binocular {
            left: &arguments.left,
            right,
        })
    })?;
    let objects = arguments
        .labels
        .as_deref()
        .map(|labels| Objects::read(labels, arguments.names.as_deref(), eyes.left.size()))
        .transpose()?;
    let plan = options.plan(eyes.left.size(), options.rig()?, objects)?;
    if let Some(scales) = options.scales
        && plan.gabor.scales < scales
    {
        console.note(&format!(
            "pictures of {} pixels carry {} scales, not {scales}",
            eyes.left.size(),
            plan.gabor.scales
        ));
    }

    let sight = plan.look(&eyes, &mut LookRoom::default(), &mut times, &console)?;
    if let (dorsal::Estimator::Vector(_), Some(rig)) = (plan.estimator, &plan.rig) {
        console.note(&sight.searched.reach_sentence(rig));
    }
    let density = sight.disparity.density();
    if density < SPARSE {
        console.note(&format!(
            "only {:.1} % of the pixels are valid; are the pictures a pair, left before right, \
             and does the search (--scales, --zero-disparity) reach their disparities?",
            100.0 * density
        ));
    }

    if options.recalibrate && sight.drift.as_ref().is_none_or(Result::is_err) {
        console.note("the rig is not recalibrated: the look does not tell where the right eye is");
    }

    if let Some(Err(reason)) = &sight.segmented {
        console.note(&format!("no objects: {reason}"));
    }

    console.step("writing");
    let record = LookRecord::new(
        &plan,
        &sight,
        &times,
        inputs(arguments, right),
        options.dense,
    );
    let median_px = record.median_disparity_px();
    let mut files = look_files(&plan, &sight, &eyes, record);
    files.add("index.html", || {
        look_page("What two eyes see", &plan, &sight, &eyes, &times)
    });
    let names = files.names();
    let mut writing = Times::default();
    writing.measure("writing", || files.write(&arguments.out))?;
    let times = times.and(writing);
    if let Some(path) = &arguments.mcap {
        log_of_one(path, &sight, &eyes)?;
    }
    console.clear();

    if let (Some(scene), Some(rig), Some(objects)) = (&sight.scene, &sight.rig, &sight.objects) {
        writeln!(out, "{}", object_table(scene, rig, &objects.names))?;
        writeln!(out, "{}", relation_table(&scene.qualitative))?;
    }
    writeln!(out, "size      {} pixels", eyes.left.size())?;
    writeln!(out, "valid     {:.1} %", 100.0 * density)?;
    if options.estimator == Estimator::Vector {
        writeln!(out, "search    {}", sight.searched.sentence())?;
    }
    if let Some(median_px) = median_px {
        writeln!(out, "disparity {median_px:.2} px in the median")?;
    }
    if let Some(drift) = &sight.drift {
        let applied = match drift {
            Ok(_) if options.recalibrate => " (corrected)",
            // Beyond it depth is taken from other pixels than those that belong together.
            Ok(found) if vertical_told_px(found) > MOST_VERTICAL_PX => {
                " (--recalibrate takes depth without it)"
            }
            _ => "",
        };
        let drift = DriftRecord::of(drift);
        writeln!(out, "drift     {}{applied}", drift.sentence())?;
    } else if plan.rig.is_some() {
        writeln!(
            out,
            "drift     unknown: who searches along the rows sees no vertical disparity; dorsal calibrate tells it"
        )?;
    }
    if let Some(segments) = sight.segments() {
        writeln!(out, "objects   {}", segments.sentence())?;
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

/// The vertical disparity that the drift explains, root mean square in pixels: what it leaves is noise and
/// false matches, which no correction takes away.
fn vertical_told_px(found: &RelativeOrientation) -> f64 {
    let [before, after] = [found.vertical_rms_before_px, found.vertical_rms_after_px];
    (before * before - after * after).max(0.0).sqrt()
}

fn inputs(arguments: &LookArguments, right: &Path) -> Inputs {
    let text = |path: &Path| path.display().to_string();
    Inputs {
        left: text(&arguments.left),
        right: text(right),
        rig: arguments.options.rig.as_deref().map(text),
        labels: arguments.labels.as_deref().map(text),
        names: arguments.names.as_deref().map(text),
    }
}
