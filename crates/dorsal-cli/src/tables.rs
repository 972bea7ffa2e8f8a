use std::io::Write;

use dorsal::allocentric_qsr::CompositionTable;

use crate::reference_system::reference_system;
use crate::tables_arguments::{Format, TablesArguments};

/// `dorsal tables`: prints one composition table.
pub(crate) fn tables(arguments: &TablesArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let reference = reference_system(&arguments.system)?;
    let table = CompositionTable::new(&reference, arguments.case, arguments.mode.mode());
    match arguments.format {
        Format::Text => write!(out, "{table}")?,
        Format::Markdown => write!(out, "{}", table.to_markdown())?,
        Format::Json => writeln!(out, "{}", serde_json::to_string(&table)?)?,
    }
    Ok(())
}
