use std::io::Write;

use dorsal::allocentric_qsr::{Change, MemoryReply};

use crate::memory_arguments::{Form, Format};

/// Writes what became different: a line for each change, or the reply of `dorsal memory watch`.
pub(crate) fn write_changes(
    changes: &[Change],
    form: Form,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    match form.format {
        Format::Json => {
            let reply = MemoryReply::Changes(changes.to_vec());
            writeln!(out, "{}", serde_json::to_string(&reply)?)?;
        }
        Format::Text if changes.is_empty() => writeln!(out, "nothing became different")?,
        Format::Text => {
            for change in changes {
                writeln!(out, "{change}")?;
            }
        }
    }
    Ok(())
}
