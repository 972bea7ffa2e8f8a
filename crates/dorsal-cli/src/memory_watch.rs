use std::io::{BufRead, Write};
use std::path::Path;

use anyhow::Context as _;
use dorsal::allocentric_qsr::MemoryReply;

use crate::memory_file::MemoryFile;

/// `dorsal memory watch`: one answer for every line. What a line changes is in the file before it
/// is answered.
pub(crate) fn watch(file: &Path, out: &mut dyn Write) -> anyhow::Result<()> {
    let file = MemoryFile::hold(file)?;
    let mut memory = file.read()?;
    let mut lines = std::io::stdin().lock();
    let mut line = Vec::new();
    loop {
        line.clear();
        let read = lines.read_until(b'\n', &mut line);
        if read.context("standard input cannot be read")? == 0 {
            return Ok(());
        }
        let reply = match std::str::from_utf8(&line).map(str::trim) {
            Ok("") => continue,
            Ok(text) => memory.take_line(text),
            Err(error) => MemoryReply::Refused(format!("the line is not UTF-8: {error}")),
        };
        if matches!(reply, MemoryReply::Changes(_)) {
            file.write(&memory)?;
        }
        writeln!(out, "{}", serde_json::to_string(&reply)?)?;
        out.flush()?;
    }
}
