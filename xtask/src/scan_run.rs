use std::fmt;

use dorsal_scan::{LAST_LOOKS, Pairs, ScanParams, Score, Ways};
use serde::Serialize;

use crate::clocked::Clocked;
use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;

/// The command that gives a page again.
const COMMAND: &str = "cargo xtask eval-scan";

/// Scans of random rooms.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ScanRun {
    schema: &'static str,
    date: String,
    machine: Machine,
    fixations: usize,
    pub(crate) rooms: Vec<Scanned>,
}

/// One room.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Scanned {
    room: u64,
    objects: usize,
    missed: Vec<String>,
    ghosts: Vec<String>,
    moved: Option<String>,
    /// The largest error of a place, in metres and in standard errors.
    worst_m: f64,
    worst_sigmas: f64,
    /// Places that are off by more than three standard errors along an axis.
    beyond: usize,
    sound: Counts,
    published: Counts,
    clear: usize,
    clear_wrongly: usize,
    blocked: usize,
    unknown: usize,
    refused: usize,
    /// A look of the robot, from two pictures to the memory: processor and wall, in milliseconds.
    look_cpu_ms: f64,
    look_wall_ms: f64,
}

/// Counts of answers.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Counts {
    asked: usize,
    depth_right: usize,
    orientation_right: usize,
    depths: usize,
    orientations: usize,
}

impl From<&Pairs> for Counts {
    fn from(pairs: &Pairs) -> Self {
        Self {
            asked: pairs.asked,
            depth_right: pairs.depth_right,
            orientation_right: pairs.orientation_right,
            depths: pairs.depths,
            orientations: pairs.orientations,
        }
    }
}

impl From<Counts> for Pairs {
    fn from(counts: Counts) -> Self {
        Self {
            asked: counts.asked,
            depth_right: counts.depth_right,
            orientation_right: counts.orientation_right,
            depths: counts.depths,
            orientations: counts.orientations,
        }
    }
}

impl Scanned {
    pub(crate) fn new(
        room: u64,
        score: &Score,
        times: &[Clocked],
        refused: usize,
        moved: Option<String>,
    ) -> Self {
        let looks = times.len().max(1) as f64;
        let mean_ms = |of: fn(&Clocked) -> f64| times.iter().map(of).sum::<f64>() * 1e3 / looks;
        let Ways {
            clear,
            blocked,
            unknown,
            wrong,
        } = score.ways;
        Self {
            room,
            objects: score.objects,
            missed: score.missed.iter().map(ToString::to_string).collect(),
            ghosts: score.ghosts.iter().map(ToString::to_string).collect(),
            moved,
            worst_m: score.off.iter().map(|off| off.metres).fold(0.0, f64::max),
            worst_sigmas: score.off.iter().map(|off| off.sigmas).fold(0.0, f64::max),
            beyond: score.off.iter().filter(|off| off.sigmas > 3.0).count(),
            sound: (&score.sound).into(),
            published: (&score.published).into(),
            clear,
            clear_wrongly: wrong,
            blocked,
            unknown,
            refused,
            look_cpu_ms: mean_ms(|clocked| clocked.cpu.as_secs_f64()),
            look_wall_ms: mean_ms(|clocked| clocked.wall.as_secs_f64()),
        }
    }
}

impl ScanRun {
    pub(crate) const fn new(date: String, machine: Machine, fixations: usize) -> Self {
        Self {
            schema: "dorsal-scan-run/1",
            date,
            machine,
            fixations,
            rooms: Vec::new(),
        }
    }

    fn pairs(&self, of: fn(&Scanned) -> Counts) -> Pairs {
        let mut all = Pairs::default();
        for room in &self.rooms {
            all.add(&of(room).into());
        }
        all
    }

    fn sum(&self, of: fn(&Scanned) -> usize) -> usize {
        self.rooms.iter().map(of).sum()
    }

    fn summary(&self) -> MarkdownTable {
        type Of = fn(&Scanned) -> Counts;
        let mut table = MarkdownTable::new([
            "calculus",
            "pairs",
            "true class in the answer, %",
            "true orientation in the answer, %",
            "classes left of 5",
            "labels left of 9",
        ]);
        let both: [(&str, Of); 2] = [
            ("`Sound`, from the map's places", |room| room.sound),
            ("`Published`, composed from the same places", |room| {
                room.published
            }),
        ];
        for (name, of) in both {
            let pairs = self.pairs(of);
            let ((depth, orientation), (classes, labels)) = (pairs.right(), pairs.left());
            table.push([
                name.to_owned(),
                pairs.asked.to_string(),
                format!("{:.2}", 100.0 * depth),
                format!("{:.2}", 100.0 * orientation),
                format!("{classes:.2}"),
                format!("{labels:.2}"),
            ]);
        }
        table
    }

    fn table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "room",
            "objects",
            "missed",
            "ghosts",
            "worst place, cm",
            "in σ",
            "class %",
            "orientation %",
            "classes left",
            "clear",
            "wrongly",
            "blocked",
            "unknown",
            "look, CPU ms",
        ]);
        for room in &self.rooms {
            let sound = Pairs::from(room.sound);
            let ((depth, orientation), (classes, _)) = (sound.right(), sound.left());
            table.push([
                room.room.to_string(),
                room.objects.to_string(),
                room.missed.len().to_string(),
                room.ghosts.len().to_string(),
                format!("{:.1}", 100.0 * room.worst_m),
                format!("{:.1}", room.worst_sigmas),
                format!("{:.1}", 100.0 * depth),
                format!("{:.1}", 100.0 * orientation),
                format!("{classes:.2}"),
                room.clear.to_string(),
                room.clear_wrongly.to_string(),
                room.blocked.to_string(),
                room.unknown.to_string(),
                format!("{:.0}", room.look_cpu_ms),
            ]);
        }
        table
    }

    /// The marks that are missed, in a sentence; `None` if all hold.
    pub(crate) fn missed(&self) -> Option<String> {
        let mut missed = Vec::new();
        let (depth, orientation) = self.pairs(|room| room.sound).right();
        for (what, right) in [("class", depth), ("orientation", orientation)] {
            if right < 1.0 - Score::MISCOVERAGE {
                missed.push(format!(
                    "the true {what} is in {:.2} % of the sound answers",
                    100.0 * right
                ));
            }
        }
        let below: Vec<String> = self
            .rooms
            .iter()
            .filter(|room| {
                let (depth, orientation) = Pairs::from(room.sound).right();
                room.sound.asked > 0 && depth.min(orientation) < 1.0 - Score::MISCOVERAGE
            })
            .map(|room| room.room.to_string())
            .collect();
        if !below.is_empty() {
            missed.push(format!(
                "more answers lack the truth than may in room {}",
                below.join(", ")
            ));
        }
        let wrong = self.sum(|room| room.clear_wrongly);
        if wrong > 0 {
            missed.push(format!("{wrong} ways are called clear that are not"));
        }
        (!missed.is_empty()).then(|| format!("missed: {}", missed.join("; ")))
    }

    /// The page for the documentation.
    pub(crate) fn page(&self) -> String {
        let machine = &self.machine;
        format!(
            "# A head that scans rooms\n\nWritten by `{COMMAND}`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n\n{self}",
            self.date, machine.cpu, machine.cores, machine.rustc, machine.build
        )
    }
}

impl fmt::Display for ScanRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rooms = self.rooms.len().max(1) as f64;
        let mean = |of: fn(&Scanned) -> f64| self.rooms.iter().map(of).sum::<f64>() / rooms;
        let objects = self.sum(|room| room.objects);
        let found = objects - self.sum(|room| room.missed.len());
        write!(
            f,
            "{} random rooms, {} fixations in each, pictures of 480 x 360. Seven to ten boxes, balls and \
             cylinders on a table too long for one look; the head looks at what is least known, then at \
             what is least sure (`crates/dorsal-scan`). Noise of a hundredth of white and eight bits; \
             encoders of 0.05 degrees, a right eye that has slipped by half a degree about two axes, lenses \
             that differ from their calibration: all of it found out by every look from its own two \
             pictures. Half way one thing is moved by 30 cm. After the fixations {} more go where things were \
             not seen for longest; then the way of a hand to a thing is asked for, and at most three more \
             looks, by the dense estimator too, go where it is not known to be free. The map vouches for what \
             the last {} looks and this one have shown: objects not seen since are stale, and count as missed, ground is not free. \
             Labels are the room's own, for the *what* stream is not ours.\n\n\
             The map at the end is held against the room. **True** is where a perfect observer at the \
             head's place sees the middle of a thing's surface; an answer about an ordered pair is right \
             if the true class, or label, is among those it leaves. Intervals of three standard errors may \
             lack the truth in {:.1} % of the answers.\n\n{}\n\
             - objects: {objects} to be seen, {found} in the map ({} missed), {} believed more than 10 cm \
             from where they are\n\
             - places: {} of {found} off by more than three standard errors along an axis; the worst by \
             {:.1} cm\n\
             - straight ways for a hand of 3 cm radius: {} clear, **{} of them wrongly**, {} blocked, {} \
             not known\n\
             - looks that the memory refused: {}\n\
             - time of a look, from two pictures to the memory: {:.0} ms of processor, {:.0} ms of wall on \
             a busy machine\n\n\
             ## Rooms\n\n{}",
            self.rooms.len(),
            self.fixations,
            LAST_LOOKS,
            ScanParams::default().memory.trusted_looks,
            100.0 * Score::MISCOVERAGE,
            self.summary(),
            objects - found,
            self.sum(|room| room.ghosts.len()),
            self.sum(|room| room.beyond),
            100.0
                * self
                    .rooms
                    .iter()
                    .map(|room| room.worst_m)
                    .fold(0.0, f64::max),
            self.sum(|room| room.clear),
            self.sum(|room| room.clear_wrongly),
            self.sum(|room| room.blocked),
            self.sum(|room| room.unknown),
            self.sum(|room| room.refused),
            mean(|room| room.look_cpu_ms),
            mean(|room| room.look_wall_ms),
            self.table(),
        )
    }
}
