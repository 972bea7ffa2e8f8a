use std::io::Write;
use std::path::Path;

use dorsal::allocentric_qsr::QualifyParams;
use dorsal::disparity_pyramid::{DenseParams, MatchParams, SearchRange};
use dorsal::egocentric_depth::{LocateParams, SegmentParams, StereoRig};
use dorsal::v1_gabor::{Binocular, GaborParams, Size};
use dorsal::{DenseLook, Range, Rows, Search};
use stereo_formats::picture;

use crate::console::Console;
use crate::drift_record::DriftRecord;
use crate::look_arguments::{Estimator, LookArguments, MostDisparity, Preset, Rectify};
use crate::look_files::look_files;
use crate::look_record::{Inputs, LookRecord};
use crate::object_table::object_table;
use crate::objects::Objects;
use crate::outputs::ensure_folder;
use crate::plan::Plan;
use crate::reference_system::reference_system;
use crate::relation_table::relation_table;
use crate::report::look_page;
use crate::rig_file::read_rig;
use crate::times::Times;

/// Below this part of valid pixels a disparity field deserves a word.
const SPARSE: f64 = 0.2;

/// Vertical disparity that a rig may leave before it should be corrected, in pixels.
const MOST_VERTICAL_PX: f64 = 0.2;

/// `dorsal look`: looks at a pair of files and writes what is seen.
pub(crate) fn look(arguments: &LookArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    ensure_folder(&arguments.out)?;
    let console = Console::new(arguments.quiet);
    let mut times = Times::default();

    console.step("reading the pictures");
    let eyes = times.measure("reading", || {
        picture::read_pair(Binocular {
            left: &arguments.left,
            right: &arguments.right,
        })
    })?;
    let plan = plan(arguments, eyes.left.size())?;
    if let Some(scales) = arguments.scales
        && plan.gabor.scales < scales
    {
        console.note(&format!(
            "pictures of {} pixels carry {} scales, not {scales}",
            eyes.left.size(),
            plan.gabor.scales
        ));
    }

    let sight = plan.look(&eyes, &mut times, &console)?;
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

    if arguments.recalibrate && sight.drift.as_ref().is_none_or(Result::is_err) {
        console.note("the rig is not recalibrated: the look does not tell where the right eye is");
    }

    if let Some(Err(reason)) = &sight.segmented {
        console.note(&format!("no objects: {reason}"));
    }

    console.step("writing");
    let record = LookRecord::new(&plan, &sight, &times, inputs(arguments), arguments.dense);
    let median_px = record.median_disparity_px();
    let mut files = look_files(&plan, &sight, &eyes, record);
    files.add("index.html", || {
        look_page("What two eyes see", &plan, &sight, &eyes, &times)
    });
    let names = files.names();
    let mut writing = Times::default();
    writing.measure("writing", || files.write(&arguments.out))?;
    let times = times.and(writing);
    console.clear();

    if let (Some(scene), Some(rig), Some(objects)) = (&sight.scene, &sight.rig, &sight.objects) {
        writeln!(out, "{}", object_table(scene, rig, &objects.names))?;
        writeln!(out, "{}", relation_table(&scene.qualitative))?;
    }
    writeln!(out, "size      {} pixels", eyes.left.size())?;
    writeln!(out, "valid     {:.1} %", 100.0 * density)?;
    if arguments.estimator == Estimator::Vector {
        writeln!(out, "search    {}", sight.searched.sentence())?;
    }
    if let Some(median_px) = median_px {
        writeln!(out, "disparity {median_px:.2} px in the median")?;
    }
    if let Some(drift) = &sight.drift {
        let applied = match drift {
            Ok(_) if arguments.recalibrate => " (corrected)",
            // Beyond it depth is taken from other pixels than those that belong together.
            Ok(found) if found.vertical_rms_before_px > MOST_VERTICAL_PX => {
                " (--recalibrate takes depth without it)"
            }
            _ => "",
        };
        let drift = DriftRecord::of(drift);
        writeln!(out, "drift     {}{applied}", drift.sentence())?;
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

fn plan(arguments: &LookArguments, size: Size) -> anyhow::Result<Plan> {
    let rig = arguments.rig.as_deref().map(read_rig).transpose()?;
    let objects = arguments
        .labels
        .as_deref()
        .map(|labels| Objects::read(labels, arguments.names.as_deref(), size))
        .transpose()?;
    let gabor = GaborParams::default();
    let scales = match arguments.range() {
        Range::Given => arguments.scales.unwrap_or(gabor.scales),
        // A coarse look reads the coarsest; the search takes no more than it needs.
        Range::Auto | Range::Wide => gabor.most_scales(size),
    };
    let gabor = GaborParams { scales, ..gabor };
    let steps = if arguments.published {
        MatchParams::as_published()
    } else if arguments.labels.is_some() || arguments.segment {
        MatchParams::for_objects()
    } else {
        MatchParams::default()
    };
    Ok(Plan {
        estimator: estimator(arguments, rig.as_ref())?,
        gabor: gabor.fitted_to(size),
        matching: MatchParams {
            energy_threshold: arguments.energy_threshold.unwrap_or(steps.energy_threshold),
            // The command line speaks the sign of files.
            zero_disparity_px: (0.0 - arguments.zero_disparity.unwrap_or(0.0), 0.0),
            rows_only: arguments.rows_only,
            slanted_scales: if arguments.slants {
                scales
            } else {
                steps.slanted_scales
            },
            singularity_tau: arguments.singularity_tau,
            // The look writes it.
            covariance: true,
            ..steps
        },
        rig,
        recalibrate: arguments.recalibrate,
        objects,
        segmenting: arguments.segment.then(SegmentParams::default),
        locating: LocateParams::default(),
        reference: reference_system(&arguments.system)?,
        qualifying: QualifyParams::default(),
    })
}

/// The estimator that is asked for; the command line speaks the sign of files.
fn estimator(
    arguments: &LookArguments,
    rig: Option<&StereoRig>,
) -> anyhow::Result<dorsal::Estimator> {
    if arguments.estimator == Estimator::Vector {
        return Ok(dorsal::Estimator::Vector(arguments.range()));
    }
    let search = match (arguments.max_disparity, arguments.min_disparity) {
        (MostDisparity::Auto, least) => Search::Found {
            most_dx: least.map(|least| -least),
        },
        (MostDisparity::Px(most), least) => {
            Search::Given(SearchRange::new(-most, -least.unwrap_or(most.min(0)))?)
        }
    };
    Ok(dorsal::Estimator::Dense(DenseLook {
        params: match arguments.preset {
            Preset::Fast => DenseParams::fast(),
            Preset::Best => DenseParams::best(),
        },
        search,
        rows: match arguments.rectify {
            Some(Rectify::None) => Rows::AsTaken,
            Some(Rectify::Auto) => Rows::Aligned,
            Some(Rectify::Rig) => Rows::Rectified,
            None if rig.is_some_and(|rig| !rig.is_rectified()) => Rows::Rectified,
            None => Rows::AsTaken,
        },
    }))
}

fn inputs(arguments: &LookArguments) -> Inputs {
    let text = |path: &Path| path.display().to_string();
    Inputs {
        left: text(&arguments.left),
        right: text(&arguments.right),
        rig: arguments.rig.as_deref().map(text),
        labels: arguments.labels.as_deref().map(text),
        names: arguments.names.as_deref().map(text),
    }
}
