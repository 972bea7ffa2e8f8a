use std::fmt;

use serde::ser::{SerializeMap, SerializeStruct};
use serde::{Serialize, Serializer};

use crate::depth_reference::DepthReference;
use crate::{Case, Depth, DepthSet, Mode, compose};

/// A composition table of one reference system: Tables 2 and 3 of the paper in any mode.
///
/// Rows are the first distance of the case (`Dab` in the paper), columns the second (`Dbc`).
/// `Display` writes aligned text. Serialized it is
/// `{"system": "drs1", "case": 1, "mode": "published", "labels": ["c", "n", "f"],
/// "cells": {"c": {"n": ["c", "n", "f"], ..}, ..}}`: the first key of `cells` is the row, the
/// second the column, keys and labels nearest first.
#[derive(Clone, Debug)]
pub struct CompositionTable {
    reference: DepthReference,
    case: Case,
    mode: Mode,
}

impl CompositionTable {
    /// The table of this system, case and mode.
    #[must_use]
    pub fn new(reference: &DepthReference, case: Case, mode: Mode) -> Self {
        Self {
            reference: reference.clone(),
            case,
            mode,
        }
    }

    /// The cell of two classes.
    ///
    /// # Panics
    /// If a class is of a larger reference system.
    #[must_use]
    pub fn cell(&self, row: Depth, column: Depth) -> DepthSet {
        let (row, column) = (row.into(), column.into());
        compose(&self.reference, self.case, self.mode, row, column).depth
    }

    /// The table as GitHub-flavoured Markdown.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let mut text = String::new();
        for (at, line) in self.grid().iter().enumerate() {
            text += &format!("| {} |\n", line.join(" | "));
            if at == 0 {
                text += &format!("|{}\n", "---|".repeat(line.len()));
            }
        }
        text
    }

    /// Header and rows, each led by its label.
    fn grid(&self) -> Vec<Vec<String>> {
        let classes = || self.reference.all().iter();
        let label = |depth| self.reference.short(depth).to_owned();
        let header = std::iter::once("Dab/Dbc".to_owned()).chain(classes().map(label));
        let rows = classes().map(|row| {
            std::iter::once(label(row))
                .chain(classes().map(|column| self.cell_text(row, column)))
                .collect()
        });
        std::iter::once(header.collect()).chain(rows).collect()
    }

    fn cell_text(&self, row: Depth, column: Depth) -> String {
        let labels = self.reference.labels(self.cell(row, column));
        format!("{{{}}}", labels.join(", "))
    }
}

impl fmt::Display for CompositionTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.reference.name();
        writeln!(f, "{name}, {}, {}", self.case, self.mode)?;
        let grid = self.grid();
        let width = |column: usize| {
            let cells = grid.iter().map(|line| line[column].chars().count());
            cells.max().unwrap_or(0)
        };
        for line in &grid {
            let cells: Vec<String> = line
                .iter()
                .enumerate()
                .map(|(column, cell)| format!("{cell:<width$}", width = width(column)))
                .collect();
            writeln!(f, "{}", cells.join("  ").trim_end())?;
        }
        Ok(())
    }
}

impl Serialize for CompositionTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut table = serializer.serialize_struct("CompositionTable", 5)?;
        table.serialize_field("system", self.reference.name())?;
        table.serialize_field("case", &self.case.number())?;
        table.serialize_field("mode", &self.mode)?;
        table.serialize_field("labels", &self.reference.labels(self.reference.all()))?;
        table.serialize_field("cells", &Cells(self))?;
        table.end()
    }
}

/// The rows of a table as a map in the order of the classes.
struct Cells<'t>(&'t CompositionTable);

/// One row of a table as a map in the order of the classes.
struct Row<'t>(&'t CompositionTable, Depth);

impl Serialize for Cells<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let reference = &self.0.reference;
        let mut rows = serializer.serialize_map(Some(reference.classes().len()))?;
        for row in reference.all().iter() {
            rows.serialize_entry(reference.short(row), &Row(self.0, row))?;
        }
        rows.end()
    }
}

impl Serialize for Row<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Row(table, row) = self;
        let reference = &table.reference;
        let mut cells = serializer.serialize_map(Some(reference.classes().len()))?;
        for column in reference.all().iter() {
            let labels = reference.labels(table.cell(*row, column));
            cells.serialize_entry(reference.short(column), &labels)?;
        }
        cells.end()
    }
}
