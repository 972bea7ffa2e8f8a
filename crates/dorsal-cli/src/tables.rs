use std::io::Write;

use dorsal::allocentric_qsr::{CompositionTable, Mode, omissions};

use crate::reference_system::reference_system;
use crate::tables_arguments::{Calculus, Format, TablesArguments};

/// `dorsal tables`: prints one composition table, or where the two calculi part.
pub(crate) fn tables(arguments: &TablesArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let mode = match arguments.mode {
        Calculus::Published => Mode::Published,
        Calculus::Sound => Mode::Sound,
        Calculus::Diff => return diff(arguments, out),
    };
    let reference = reference_system(&arguments.system)?;
    let table = CompositionTable::new(&reference, arguments.case, mode);
    match arguments.format {
        Format::Text => write!(out, "{table}")?,
        Format::Markdown => write!(out, "{}", table.to_markdown())?,
        Format::Json => writeln!(out, "{}", serde_json::to_string(&table)?)?,
    }
    Ok(())
}

/// Every cell where the published answer excludes a real configuration, with numbers that show it.
fn diff(arguments: &TablesArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let reference = reference_system(&arguments.system)?;
    let omissions = omissions(&reference, arguments.case);
    let cells = reference.classes().len().pow(2);
    match arguments.format {
        Format::Json => writeln!(out, "{}", serde_json::to_string(&omissions)?)?,
        Format::Text => {
            writeln!(
                out,
                "{}, {}: the published answer excludes a real configuration in {} of {cells} cells",
                reference.name(),
                arguments.case,
                omissions.len()
            )?;
            for omission in &omissions {
                writeln!(out, "{omission}")?;
            }
        }
        Format::Markdown => {
            writeln!(
                out,
                "| first | second | published | sound | witness |\n|---|---|---|---|---|"
            )?;
            for omission in &omissions {
                let metres = |um: u64| um as f64 / 1e6;
                for witness in &omission.witnesses {
                    writeln!(
                        out,
                        "| {} | {} | {{{}}} | {{{}}} | {} m and {} m leave {} m ({}) |",
                        omission.first,
                        omission.second,
                        omission.published.join(", "),
                        omission.sound.join(", "),
                        metres(witness.first_um),
                        metres(witness.second_um),
                        metres(witness.third_um),
                        witness.class,
                    )?;
                }
            }
        }
    }
    Ok(())
}
