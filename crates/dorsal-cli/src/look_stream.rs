use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use dorsal::allocentric_qsr::RelationRecord;
use dorsal::v1_gabor::{Binocular, Size};
use dorsal::{Names, object_id};
use serde::Serialize;
use stereo_formats::picture::Picture;
use stereo_formats::rig_toml::SizedRig;

use crate::console::Console;
use crate::drift_record::DriftRecord;
use crate::look_files::look_files;
use crate::look_options::LookOptions;
use crate::look_record::{Inputs, LookRecord};
use crate::look_room::LookRoom;
use crate::outputs::ensure_folder;
use crate::plan::Plan;
use crate::report::look_page;
use crate::sight::Sight;
use crate::sight_log::LogFile;
use crate::stream_arguments::StreamArguments;
use crate::times::Times;

/// Pairs that come one after another, looked at and written as they come.
pub(crate) struct LookStream<'a> {
    options: &'a LookOptions,
    rig: Option<SizedRig>,
    plan: Option<(Size, Plan)>,
    room: LookRoom,
    log: Option<LogFile>,
    lines: Option<Lines<'a>>,
    folder: Option<&'a Path>,
    most: Option<u64>,
    looks: u64,
    /// Where the pairs come from, for the record of a look.
    source: Inputs,
}

/// Where lines of JSON go, and what that is called.
struct Lines<'a> {
    out: Box<dyn Write + 'a>,
    name: PathBuf,
}

/// One line of JSON: schema `dorsal-look-line/1`.
#[derive(Debug, Serialize)]
struct LookLine {
    schema: &'static str,
    look: u64,
    /// When the pair was taken, in nanoseconds of its clock.
    time_ns: u64,
    /// Pictures that stayed without a look so far.
    dropped: u64,
    /// The part of the pixels that are valid.
    density: f64,
    /// In the sign of files.
    median_disparity_px: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    median_depth_m: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    drift: Option<DriftRecord>,
    objects: Vec<ObjectOnLine>,
    relations: Vec<RelationRecord>,
    time_ms: Times,
}

#[derive(Debug, Serialize)]
struct ObjectOnLine {
    name: String,
    /// Right, down, forward of the observer.
    position_m: [f64; 3],
    pixels: usize,
}

impl<'a> LookStream<'a> {
    /// A stream whose lines go to `out` if that is said, or if nothing is.
    pub(crate) fn begin(
        options: &'a LookOptions,
        rig: Option<SizedRig>,
        into: &'a StreamArguments,
        source: Inputs,
        out: &'a mut dyn Write,
    ) -> anyhow::Result<Self> {
        let folder = into.out.as_deref();
        folder.map_or(Ok(()), ensure_folder)?;
        let nothing_said = into.mcap.is_none() && into.jsonl.is_none() && folder.is_none();
        let lines: Option<Lines<'a>> = match &into.jsonl {
            Some(path) if path.as_os_str() != "-" => {
                let file = File::create(path).with_context(|| {
                    format!(
                        "{} cannot be written; its folder must exist",
                        path.display()
                    )
                })?;
                Some(Lines {
                    out: Box::new(BufWriter::new(file)),
                    name: path.clone(),
                })
            }
            None if !nothing_said => None,
            _ => Some(Lines {
                out: Box::new(out),
                name: "standard output".into(),
            }),
        };
        Ok(Self {
            options,
            rig,
            plan: None,
            room: LookRoom::default(),
            log: into.mcap.as_deref().map(LogFile::begin).transpose()?,
            lines,
            folder,
            most: into.looks,
            looks: 0,
            source,
        })
    }

    /// How many pairs were looked at.
    pub(crate) const fn looks(&self) -> u64 {
        self.looks
    }

    /// Whether as many looks were taken as were asked for.
    pub(crate) fn is_done(&self) -> bool {
        self.most.is_some_and(|most| self.looks >= most)
    }

    /// Looks at a pair; when it returns, the look is written. Says in a sentence what was seen.
    pub(crate) fn look(
        &mut self,
        eyes: &Binocular<Picture>,
        time_ns: u64,
        dropped: u64,
    ) -> anyhow::Result<String> {
        let size = eyes.left.size();
        if self
            .plan
            .as_ref()
            .is_none_or(|(planned, _)| *planned != size)
        {
            self.plan = Some((size, self.options.plan(size, self.rig, None)?));
        }
        let (_, plan) = self.plan.as_ref().context("it was planned")?;
        let mut times = Times::default();
        // Steps and notes of each of many looks would bury what matters.
        let sight = plan.look(eyes, &mut self.room, &mut times, &Console::new(true))?;
        self.looks += 1;
        let record = LookRecord::new(
            plan,
            &sight,
            &times,
            self.source.clone(),
            self.options.dense,
        );
        let median_px = record.median_disparity_px();
        if let Some(folder) = self.folder {
            let folder = folder.join(format!("{:06}", self.looks));
            let title = format!("Look {}", self.looks);
            let mut files = look_files(plan, &sight, eyes, record);
            files.add("index.html", || {
                look_page(&title, plan, &sight, eyes, &times)
            });
            files.write(&folder)?;
        }
        if let Some(log) = &self.log {
            log.look(time_ns, &sight, eyes)?;
        }
        let density = sight.disparity.density();
        let sentence = format!(
            "look {}: {:.1} % valid, {} objects, {:.0} ms",
            self.looks,
            100.0 * density,
            sight
                .scene
                .as_ref()
                .map_or(0, |scene| scene.egocentric.objects.len()),
            times.milliseconds().iter().map(|(_, ms)| ms).sum::<f64>(),
        );
        if let Some(lines) = &mut self.lines {
            let line = line(self.looks, time_ns, dropped, median_px, &sight, times);
            let mut text = serde_json::to_vec(&line)?;
            text.push(b'\n');
            // A line that was acknowledged is out of this process.
            lines
                .out
                .write_all(&text)
                .and_then(|()| lines.out.flush())
                .with_context(|| format!("{} takes no more", lines.name.display()))?;
        }
        self.room.take_back(sight);
        Ok(sentence)
    }

    /// Ends what was written; the log takes its name.
    pub(crate) fn finish(self) -> anyhow::Result<()> {
        self.log.map_or(Ok(()), LogFile::finish)
    }
}

fn line(
    look: u64,
    time_ns: u64,
    dropped: u64,
    median_px: Option<f32>,
    sight: &Sight,
    time_ms: Times,
) -> LookLine {
    let none = Names::new();
    let names = sight
        .objects
        .as_ref()
        .map_or(&none, |objects| &objects.names);
    let scene = sight.scene.as_ref();
    let median_depth_m = sight.depth.as_ref().and_then(|depth| {
        let mut known: Vec<f32> = depth
            .metres()
            .iter()
            .copied()
            .filter(|m| m.is_finite())
            .collect();
        let middle = known.len() / 2;
        (!known.is_empty()).then(|| *known.select_nth_unstable_by(middle, f32::total_cmp).1)
    });
    LookLine {
        schema: "dorsal-look-line/1",
        look,
        time_ns,
        dropped,
        density: sight.disparity.density(),
        median_disparity_px: median_px,
        median_depth_m,
        drift: sight.drift.as_ref().map(DriftRecord::of),
        objects: scene.map_or_else(Vec::new, |scene| {
            let objects = scene.egocentric.objects.iter();
            objects
                .map(|object| ObjectOnLine {
                    name: object_id(object.label, names).to_string(),
                    position_m: object.position.to_array(),
                    pixels: object.pixels,
                })
                .collect()
        }),
        relations: scene.map_or_else(Vec::new, |scene| {
            let reference = scene.qualitative.reference();
            let relations = scene.qualitative.relations();
            relations.iter().map(|r| r.record(reference)).collect()
        }),
        time_ms,
    }
}
