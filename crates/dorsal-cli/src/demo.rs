use std::io::Write;
use std::path::Path;

use anyhow::{Context as _, bail};
use dorsal::allocentric_qsr::{DepthReference, QualifyParams};
use dorsal::disparity_pyramid::MatchParams;
use dorsal::egocentric_depth::LocateParams;
use dorsal::v1_gabor::GaborParams;
use dorsal::{Estimator, Range};
use stereo_formats::colour::ColourRange;
use stereo_formats::{file_sign, label_png, names, pfm, picture, rig_toml};

use crate::console::Console;
use crate::demo_arguments::{DemoArguments, DemoKind};
use crate::demo_scan::demo_scan;
use crate::demo_scene::DemoScene;
use crate::label_picture::label_picture;
use crate::look_files::{coloured_png, look_files};
use crate::look_record::{Inputs, LookRecord};
use crate::look_room::LookRoom;
use crate::motorcycle::motorcycle;
use crate::objects::Objects;
use crate::outputs::{Outputs, ensure_folder};
use crate::plan::Plan;
use crate::relation_table::relation_table;
use crate::report::look_page;
use crate::room::room;
use crate::sight::Sight;
use crate::sight_log::LogFile;
use crate::times::Times;
use crate::verdict::Verdict;

/// Makes a scene; it is not made before its turn, so that the first results come early.
type Prepare = fn() -> anyhow::Result<DemoScene>;

/// `dorsal demo`: looks at the built-in scenes, writes what is seen and compares it with the truth.
pub(crate) fn demo(arguments: &DemoArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    if let Some(DemoKind::Scan(scan)) = &arguments.kind {
        return demo_scan(scan, out);
    }
    arguments.threads.install()?;
    let folder = arguments.out.as_deref().unwrap_or(Path::new("."));
    ensure_folder(folder)?;
    let console = Console::new(arguments.quiet);
    let scenes: [(&str, Prepare); 2] = [
        ("decoding the real pair", motorcycle),
        ("rendering the room", room),
    ];
    let log = arguments.mcap.as_deref().map(LogFile::begin).transpose()?;
    let mut verdicts = Vec::new();
    for (time_s, (step, scene)) in (0..).zip(scenes) {
        console.step(step);
        let scene = scene().with_context(|| format!("{step} failed, which is a fault of ours"))?;
        let (verdict, sight) = show(&scene, folder, &console, out)?;
        if let Some(log) = &log {
            // A second apart, so that a viewer shows one after the other.
            log.look(time_s * 1_000_000_000, &sight, &scene.eyes)?;
        }
        verdicts.push(verdict);
    }
    log.map_or(Ok(()), LogFile::finish)?;
    console.clear();
    for verdict in &verdicts {
        writeln!(out, "{verdict}")?;
    }
    if !verdicts.iter().all(Verdict::holds) {
        out.flush()?;
        bail!("the demo does not keep its promises; see the lines marked ✗ above");
    }
    Ok(())
}

/// Looks at one scene, prints the comparison and writes the files; gives what was seen.
fn show(
    scene: &DemoScene,
    out_folder: &Path,
    console: &Console,
    out: &mut dyn Write,
) -> anyhow::Result<(Verdict, Sight)> {
    let folder = out_folder.join(scene.name);
    let plan = plan(scene)?;
    let mut times = Times::default();
    let sight = plan.look(&scene.eyes, &mut LookRoom::default(), &mut times, console)?;
    let seen = sight.scene.as_ref().context("a demo has objects")?;
    let verdict = Verdict::new(scene, &plan, seen)?;

    console.step("writing");
    let record = LookRecord::new(&plan, &sight, &times, inputs(&folder), false);
    let mut files = look_files(&plan, &sight, &scene.eyes, record);
    add_scene_files(&mut files, scene, &sight);
    files.add("index.html", || {
        look_page(scene.title, &plan, &sight, &scene.eyes, &times)
    });
    let mut writing = Times::default();
    writing.measure("writing", || files.write(&folder))?;
    let times = times.and(writing);

    // The spinner stands on the line where the results begin.
    console.clear();
    writeln!(out, "{}: {}", scene.name, scene.title)?;
    writeln!(
        out,
        "{} pixels, {:.1} % valid; {}",
        scene.eyes.left.size(),
        100.0 * sight.disparity.density(),
        sight.searched.reach_sentence(&scene.rig)
    )?;
    writeln!(out, "{}\n", times.sentence())?;
    writeln!(out, "{}", verdict.comparison)?;
    writeln!(out, "{}", relation_table(&seen.qualitative))?;
    writeln!(out, "To look again: {}\n", command(&folder, &plan))?;
    out.flush()?;
    Ok((verdict, sight))
}

/// How to look at a scene: with the smallest search that reaches everything in it.
fn plan(scene: &DemoScene) -> anyhow::Result<Plan> {
    let (nearest_m, farthest_m) = scene.span_m;
    let search = scene
        .rig
        .search_for(nearest_m, farthest_m)
        .with_context(|| format!("no search reaches {nearest_m} to {farthest_m} m"))?;
    let gabor = GaborParams {
        scales: usize::try_from(search.scales)?,
        ..GaborParams::default()
    };
    Ok(Plan {
        estimator: Estimator::Vector(Range::Given),
        gabor: gabor.fitted_to(scene.eyes.left.size()),
        matching: MatchParams {
            // A tenth of a pixel is as fine as anyone repeats by hand.
            zero_disparity_px: ((10.0 * search.zero_disparity_px).round() as f32 / 10.0, 0.0),
            ..MatchParams::for_objects()
        },
        rig: Some(scene.rig),
        recalibrate: false,
        objects: Some(scene.objects.clone()),
        segmenting: None,
        locating: LocateParams::default(),
        reference: DepthReference::robot_120(),
        qualifying: QualifyParams::default(),
    })
}

/// Adds the files that belong to a scene, whoever looks at it.
fn add_scene_files<'a>(files: &mut Outputs<'a>, scene: &'a DemoScene, sight: &'a Sight) {
    let Objects { labels, names } = &scene.objects;
    files.add("left.png", || picture::encode_rgb(scene.eyes.left.rgb()));
    files.add("right.png", || picture::encode_rgb(scene.eyes.right.rgb()));
    files.add("rig.toml", || rig_toml::encode(&scene.rig));
    files.add("label_image.png", || label_png::encode(labels));
    files.add("names.toml", || names::encode(names));
    files.add("labels.png", || {
        picture::encode_rgb(label_picture(scene.eyes.left.rgb(), labels).view())
    });
    files.add("true_disparity.pfm", || pfm::encode(scene.true_d.view()));
    files.add("true_disparity.png", || {
        // One range for both pictures, so that equal colours are equal disparities.
        let seen = file_sign::d_of_field(&sight.disparity, false);
        coloured_png(
            scene.true_d.view(),
            ColourRange::covering(seen.view()),
            "px",
        )
    });
}

/// The inputs of a look at the files of a scene.
fn inputs(folder: &Path) -> Inputs {
    let text = |name| folder.join(name).display().to_string();
    Inputs {
        left: text("left.png"),
        right: text("right.png"),
        rig: Some(text("rig.toml")),
        labels: Some(text("label_image.png")),
        names: Some(text("names.toml")),
    }
}

/// The `dorsal look` that sees the same in the written files.
fn command(folder: &Path, plan: &Plan) -> String {
    let folder = folder.display();
    format!(
        "dorsal look {folder}/left.png {folder}/right.png --out {folder}/again \\\n    \
         --rig {folder}/rig.toml --labels {folder}/label_image.png --names {folder}/names.toml \\\n    \
         --scales {} --zero-disparity {:.1}",
        plan.gabor.scales,
        0.0 - plan.matching.zero_disparity_px.0
    )
}
