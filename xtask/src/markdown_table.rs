use std::fmt;

/// A table in Markdown whose columns also line up in a terminal.
///
/// The first column stands left, the others right. Every row has as many cells as the head.
#[derive(Clone, Debug)]
pub(crate) struct MarkdownTable {
    /// The head and the rows below it.
    rows: Vec<Vec<String>>,
}

impl MarkdownTable {
    /// A table with these heads over its columns, and no row yet.
    pub(crate) fn new<const COLUMNS: usize>(head: [&str; COLUMNS]) -> Self {
        Self {
            rows: vec![head.map(str::to_owned).to_vec()],
        }
    }

    /// A table with as many columns as there are heads, and no row yet.
    pub(crate) fn with_head(head: impl IntoIterator<Item = String>) -> Self {
        Self {
            rows: vec![head.into_iter().collect()],
        }
    }

    /// Adds a row; cells that it lacks stay empty, and cells beyond the head are left out.
    pub(crate) fn push(&mut self, row: impl IntoIterator<Item = String>) {
        let columns = self.rows[0].len();
        let cells = row.into_iter().chain(std::iter::repeat(String::new()));
        self.rows.push(cells.take(columns).collect());
    }
}

impl fmt::Display for MarkdownTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows[0].len();
        let widths: Vec<usize> = (0..columns)
            .map(|column| {
                let cells = self.rows.iter().map(|row| row[column].chars().count());
                cells.max().unwrap_or(0).max(2)
            })
            .collect();
        for (place, row) in self.rows.iter().enumerate() {
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                if column == 0 {
                    write!(f, "| {cell:<width$} ")?;
                } else {
                    write!(f, "| {cell:>width$} ")?;
                }
            }
            writeln!(f, "|")?;
            if place == 0 {
                for (column, &width) in widths.iter().enumerate() {
                    let colon = if column == 0 { '-' } else { ':' };
                    write!(f, "| {}{colon} ", "-".repeat(width - 1))?;
                }
                writeln!(f, "|")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let mut table = MarkdownTable::new(["scene", "px"]);
        table.push(["a".to_owned(), "0.125".to_owned()]);
        table.push(["longer name".to_owned()]);
        let want = "\
| scene       |    px |\n\
| ----------- | ----: |\n\
| a           | 0.125 |\n\
| longer name |       |\n";
        assert_eq!(table.to_string(), want);
    }
}
