use std::fmt;

/// Lines of cells in aligned columns, two spaces apart: the first line is the header, the first
/// column stands left, those that are marked as numbers right.
#[derive(Debug)]
pub(crate) struct TextTable {
    numbers: Vec<bool>,
    lines: Vec<Vec<String>>,
}

impl TextTable {
    /// A table with this header; a title that begins with `>` heads a column of numbers.
    pub(crate) fn new<'t>(titles: impl IntoIterator<Item = &'t str>) -> Self {
        let titles: Vec<&str> = titles.into_iter().collect();
        Self {
            numbers: titles.iter().map(|title| title.starts_with('>')).collect(),
            lines: vec![
                titles
                    .iter()
                    .map(|title| title.trim_start_matches('>').to_owned())
                    .collect(),
            ],
        }
    }

    /// Adds a line.
    pub(crate) fn line(&mut self, cells: impl IntoIterator<Item = String>) {
        self.lines.push(cells.into_iter().collect());
    }
}

impl fmt::Display for TextTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| {
            let cells = self.lines.iter().filter_map(|line| line.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        for line in &self.lines {
            let cells = line.iter().enumerate().map(|(column, cell)| {
                let width = width(column);
                if self.numbers.get(column) == Some(&true) {
                    format!("{cell:>width$}")
                } else {
                    format!("{cell:<width$}")
                }
            });
            let cells: Vec<String> = cells.collect();
            writeln!(f, "{}", cells.join("  ").trim_end())?;
        }
        Ok(())
    }
}
