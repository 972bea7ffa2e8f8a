use std::fs;
use std::io::Write;

use anyhow::{Context as _, bail};
use dorsal::Names;
use dorsal::allocentric_qsr::SceneMemory;
use dorsal_scan::{
    Asked, Fixation, HeadErrors, LAST_LOOKS, Scan, ScanParams, TruePlaces, ask_all, figure_12,
    knows_figure_12,
};
use stereo_formats::{picture, rig_toml};
use stereo_scenes::Room;
use stereo_streams::LoggedLook;

use crate::console::Console;
use crate::memory_file::MemoryFile;
use crate::outputs::{Outputs, ensure_folder};
use crate::report::{Frame, scan_page};
use crate::scan_arguments::ScanArguments;
use crate::scan_record::{LookOfScan, ScanRecord};
use crate::scan_step::ScanStep;
use crate::sight_log::LogFile;
use crate::times::Times;

/// How many looks a question may cost.
const MOST_LOOKS_ALONG: usize = 3;

/// `dorsal demo scan`: lets a head scan a room, writes what it saw and remembers, and holds the map
/// against the room.
pub(crate) fn demo_scan(arguments: &ScanArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    ensure_folder(&arguments.out)?;
    let console = Console::new(arguments.quiet);
    let mut scanned = Scanned::begin(arguments)?;
    while let Some(fixation) = scanned.scan.next() {
        scanned.look(&fixation, &console, out)?;
    }
    // A scan ends by making sure of what it has not seen for long.
    for _ in 0..LAST_LOOKS {
        let Some(fixation) = scanned.scan.make_sure() else {
            break;
        };
        scanned.look(&fixation, &console, out)?;
    }
    // The looks of Figure 12 come on top: along the way that is asked for, as long as the map has no answer,
    // and at one object without the other.
    let pair = figure_12(scanned.scan.memory());
    for _ in 0..MOST_LOOKS_ALONG {
        let grasped = pair.as_ref().map(|[grasped, _]| grasped);
        let Some(fixation) = grasped.and_then(|grasped| scanned.scan.on_the_way(grasped)) else {
            break;
        };
        scanned.look(&fixation, &console, out)?;
    }
    let hidden = pair.as_ref().and_then(|[a, b]| scanned.scan.without(a, b));
    if let Some(fixation) = &hidden {
        scanned.look(fixation, &console, out)?;
    }

    console.step("comparing with the room");
    let (score, truth) = (scanned.scan.score()?, scanned.truth);
    let memory = scanned.scan.memory().clone();
    let pair = pair.filter(|_| hidden.is_some());
    let way_is_free = pair
        .as_ref()
        .is_some_and(|[grasped, _]| scanned.scan.way_is_free(grasped));
    let moved = scanned.moved.as_deref();
    let asked = ask_all(&memory, &truth, pair.as_ref(), way_is_free, moved);
    let knows = pair
        .as_ref()
        .is_none_or(|pair| knows_figure_12(&memory, &truth, pair, way_is_free));

    console.step("writing");
    let record = ScanRecord::new(scanned.looks, &memory, &truth, &score, &asked);
    let page = scan_page(
        scanned.frames,
        &scanned.names,
        memory.reference(),
        &score,
        &asked,
    )?;
    scanned.log.map_or(Ok(()), LogFile::finish)?;
    let mut files = scanned.files;
    files.add("index.html", move || anyhow::Ok(page));
    files.add("scan.json", || serde_json::to_vec_pretty(&record));
    files.add("memory.json", || {
        anyhow::Ok((memory.to_json() + "\n").into_bytes())
    });
    files.add("memory.dot", || anyhow::Ok(memory.to_dot().into_bytes()));
    files.write(&arguments.out)?;
    console.clear();

    writeln!(out, "\n{score}\n")?;
    for asked in &asked {
        write_asked(asked, out)?;
    }
    writeln!(out, "\nwritten   {}/index.html", arguments.out.display())?;
    if !score.holds() {
        out.flush()?;
        bail!("the map does not keep its promises; see the lines above");
    }
    if !knows {
        out.flush()?;
        bail!("Figure 12's question is not answered rightly; see the lines above");
    }
    Ok(())
}

fn write_asked(asked: &Asked, out: &mut dyn Write) -> std::io::Result<()> {
    let mark = match asked.right {
        Some(true) => "✓ ",
        Some(false) => "✗ ",
        None => "",
    };
    writeln!(out, "? {}", asked.question)?;
    for line in asked.answer.lines() {
        writeln!(out, "    {line}")?;
    }
    if let Some(truth) = &asked.truth {
        writeln!(out, "    {mark}truly {truth}")?;
    }
    Ok(())
}

/// A scan under way, and what it has left so far.
struct Scanned {
    scan: Scan,
    names: Names,
    file: Option<MemoryFile>,
    files: Outputs<'static>,
    looks: Vec<LookOfScan>,
    frames: Vec<Frame>,
    moved: Option<String>,
    /// Where everything truly is now.
    truth: TruePlaces,
    log: Option<LogFile>,
}

impl Scanned {
    fn begin(arguments: &ScanArguments) -> anyhow::Result<Self> {
        let room = match &arguments.room {
            None => Room::scan(),
            Some(path) => {
                let text = fs::read_to_string(path)
                    .with_context(|| format!("{} cannot be read", path.display()))?;
                Room::from_toml(&text).with_context(|| format!("{}", path.display()))?
            }
        };
        let defaults = ScanParams::default();
        let params = ScanParams {
            fixations: usize::from(arguments.fixations),
            seed: arguments.seed,
            moves: !arguments.still,
            errors: if arguments.exact {
                HeadErrors::none()
            } else {
                defaults.errors
            },
            ..defaults
        };
        let names = room.names();
        let names = names.map(|(label, name)| (label, name.to_owned()));
        let names = names.collect();
        let file = arguments.memory.as_deref().map(MemoryFile::hold);
        let file = file.transpose()?;
        let memory = match (&file, &arguments.memory) {
            (Some(file), Some(path)) if path.exists() => file.read()?,
            _ => SceneMemory::new(&params.reference, params.memory)?,
        };
        let scan = Scan::resume(room, params, memory)?;
        Ok(Self {
            truth: scan.truth()?,
            log: arguments.mcap.as_deref().map(LogFile::begin).transpose()?,
            scan,
            names,
            file,
            files: Outputs::default(),
            looks: Vec::new(),
            frames: Vec::new(),
            moved: None,
        })
    }

    /// Looks once; the memory is on disk before the line that says so.
    fn look(
        &mut self,
        fixation: &Fixation,
        console: &Console,
        out: &mut dyn Write,
    ) -> anyhow::Result<()> {
        let mut times = Times::default();
        let moved = self.scan.stir();
        console.step(format!("rendering: {}", fixation.why));
        let shown = times.measure("rendering the room", || self.scan.show(fixation))?;
        console.step(format!("looking: {}", fixation.why));
        let look = times.measure("looking and remembering", || {
            self.scan.perceive(shown, moved)
        })?;
        if let Some(file) = &self.file {
            file.write(&look.memory)?;
        }
        if look.moved.is_some() {
            self.truth = self.scan.truth()?;
        }
        if let Some(log) = &self.log {
            let scene = &look.percept.qualitative;
            let relations = scene.relations();
            let relations = relations.iter().map(|r| r.record(scene.reference()));
            log.add(&LoggedLook {
                time_ns: look.memory.time_ms() * 1_000_000,
                pictures: look.shown.pictures.as_ref().map(|picture| picture.view()),
                rig: Some(&look.rig),
                depth: Some(&look.percept.depth),
                objects: &look.percept.egocentric.objects,
                names: &self.names,
                relations: relations.collect(),
            })?;
        }
        let step = ScanStep { look, times };
        self.frames
            .push(Frame::of_scan(&step, &self.truth, &self.names)?);
        self.looks.push(LookOfScan::of(&step));
        console.clear();
        let look = step.look;
        if let Some(object) = &look.moved {
            writeln!(out, "        somebody moves {object}")?;
            self.moved = Some(object.clone());
        }
        let refused = look.refused.as_ref();
        let refused = refused.map_or_else(String::new, |why| format!("; not remembered: {why}"));
        writeln!(
            out,
            "look {:>2}  {}; {} objects placed, {} known{refused}",
            look.number,
            look.shown.fixation.why,
            look.percept.egocentric.objects.len(),
            look.memory.objects().count(),
        )?;
        out.flush()?;
        let (pictures, rig, number) = (look.shown.pictures, look.rig, look.number);
        let (left, right) = (pictures.left, pictures.right);
        self.files
            .add(format!("look_{number:02}_left.png"), move || {
                picture::encode_rgb(left.view())
            });
        self.files
            .add(format!("look_{number:02}_right.png"), move || {
                picture::encode_rgb(right.view())
            });
        self.files
            .add(format!("look_{number:02}_rig.toml"), move || {
                rig_toml::encode(&rig)
            });
        Ok(())
    }
}
