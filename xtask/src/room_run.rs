use std::fmt;

use serde::Serialize;

use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;
use crate::metrics::Metrics;

/// The command that gives a page again.
const COMMAND: &str = "cargo xtask eval-rooms";

/// Most mean absolute error of a component in a built-in room, in pixels.
const MOST_PX: f64 = 0.1;

/// One room, as the vector pyramid sees it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RoomSeen {
    pub(crate) name: String,
    /// Whether the mark is its, too.
    pub(crate) built_in: bool,
    pub(crate) scales: usize,
    pub(crate) dx: Metrics,
    pub(crate) dy: Metrics,
}

/// The errors in rendered rooms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RoomRun {
    schema: &'static str,
    date: String,
    machine: Machine,
    command: &'static str,
    pub(crate) rooms: Vec<RoomSeen>,
}

impl RoomRun {
    pub(crate) const fn new(date: String, machine: Machine) -> Self {
        Self {
            schema: "dorsal-rooms/1",
            date,
            machine,
            command: COMMAND,
            rooms: Vec::new(),
        }
    }

    fn table(&self) -> MarkdownTable {
        let measures = [
            "mean",
            "std",
            "signed",
            "RMS",
            "bad-0.5, %",
            "bad-1, %",
            "bad-2, %",
            "bad-4, %",
            "density, %",
            "pixels",
        ];
        let head = ["room", "scales", "component"].into_iter().chain(measures);
        let mut table = MarkdownTable::with_head(head.map(str::to_owned));
        for room in &self.rooms {
            for (component, errors) in [("dx", &room.dx), ("dy", &room.dy)] {
                let first = [
                    room.name.clone(),
                    room.scales.to_string(),
                    component.to_owned(),
                ];
                table.push(first.into_iter().chain(errors.cells()));
            }
        }
        table
    }

    /// The built-in rooms whose mark is missed, in a sentence; `None` if it holds in all.
    pub(crate) fn missed(&self) -> Option<String> {
        let missed: Vec<String> = self
            .rooms
            .iter()
            .filter(|room| room.built_in)
            .flat_map(|room| [("dx", &room.dx), ("dy", &room.dy)].map(|part| (room, part)))
            .filter(|(_, (_, errors))| errors.mean_absolute > MOST_PX)
            .map(|(room, (component, errors))| {
                format!("{} {component}: {:.3} px", room.name, errors.mean_absolute)
            })
            .collect();
        (!missed.is_empty()).then(|| format!("above {MOST_PX} px: {}", missed.join("; ")))
    }

    /// The page for the documentation.
    pub(crate) fn page(&self) -> String {
        let machine = &self.machine;
        format!(
            "# Rendered rooms\n\nWritten by `{COMMAND}`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n\n{self}",
            self.date, machine.cpu, machine.cores, machine.rustc, machine.build
        )
    }
}

impl fmt::Display for RoomRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = self.missed().map_or_else(
            || format!("It holds: the built-in rooms stay within {MOST_PX} px in each component."),
            |missed| format!("Missed: {missed}."),
        );
        write!(
            f,
            "The default vector pyramid in the rooms that are built in (`table` is the demo's) and in random ones, \
             before the paper's head, whose eyes converge: eight bits, no rectification; `noisy` ones with shot noise of \
             10,000 electrons and reading noise of 10. The \
             search starts in the middle of the true range, with the fewest scales that reach its ends. Errors in \
             px over **textured** pixels (both eyes see them, grey steps of two levels or more, nine pixels from \
             jumps of two pixels) whose answer is valid; density is the part of the textured ones that are.\n\n{}\n\
             The mark is a mean of {MOST_PX} px. {verdict} Tables take most of the density and make most of the \
             error: before so long a baseline they slant by half a pixel of disparity a row.\n",
            self.table()
        )
    }
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    fn seen(name: &str, built_in: bool, error_px: f32) -> RoomSeen {
        let (truth, mask) = (array![[1.0, 2.0]], array![[true, true]]);
        let errors = |error: f32| {
            let found = truth.mapv(|truth: f32| truth + error);
            Metrics::of(found.view(), truth.view(), mask.view()).unwrap()
        };
        RoomSeen {
            name: name.to_owned(),
            built_in,
            scales: 6,
            dx: errors(error_px),
            dy: errors(0.01),
        }
    }

    /// The mark is that of the built-in rooms, and of the component that misses it.
    #[test]
    fn a_built_in_room_off_by_more_than_a_tenth_is_named() {
        let mut run = RoomRun::new("today".to_owned(), Machine::this());
        run.rooms = vec![seen("table", true, 0.09), seen("random 1", false, 0.3)];
        assert_eq!(run.missed(), None);
        run.rooms.push(seen("shelf", true, -0.2));
        let missed = run.missed().unwrap();
        assert!(
            missed.contains("shelf dx: 0.200 px") && !missed.contains("table"),
            "{missed}"
        );
        assert!(!missed.contains("dy"), "{missed}");
    }
}
