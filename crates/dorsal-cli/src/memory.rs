use std::io::Write;
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use dorsal::allocentric_qsr::{
    Answer, Change, MemoryParams, Query, Refused, SceneMemory, ToldFact,
};

use crate::memory_add::add;
use crate::memory_arguments::{
    AskArguments, DiffArguments, FactArguments, Form, Format, InitArguments, MemoryArguments,
    MemoryCommand,
};
use crate::memory_changes::write_changes;
use crate::memory_file::{self, MemoryFile};
use crate::memory_show::show;
use crate::memory_watch::watch;
use crate::reference_system::reference_system;
use crate::wrong_call::WrongCall;

/// `dorsal memory`: what the robot remembers, in a file.
pub(crate) fn memory(arguments: &MemoryArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let file = &arguments.memory;
    match &arguments.command {
        MemoryCommand::Init(init) => make(file, init, out),
        MemoryCommand::Add(look) => add(file, look, out),
        MemoryCommand::Ask(AskArguments { query, form }) => ask(file, query, *form, out),
        MemoryCommand::Explain(explain) => {
            let query = Query::Explain(explain.of.as_str().into(), explain.from.as_str().into());
            ask(file, &query, explain.form, out)
        }
        MemoryCommand::Tell(fact) => change(file, fact, out, SceneMemory::tell),
        MemoryCommand::Retract(fact) => {
            change(file, fact, out, |memory, fact| memory.retract(&fact))
        }
        MemoryCommand::Show(arguments) => show(&memory_file::read(file)?, arguments.format, out),
        MemoryCommand::Diff(arguments) => diff(file, arguments, out),
        MemoryCommand::Watch(_) => watch(file, out),
    }
}

fn make(path: &Path, arguments: &InitArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let reference = reference_system(&arguments.system)?;
    let file = MemoryFile::hold(path)?;
    ensure!(
        arguments.force || !path.exists(),
        "{} exists already; replace it with --force, or name another with --memory",
        path.display()
    );
    let params = MemoryParams {
        policy: arguments.policy.into(),
        ..MemoryParams::default()
    };
    file.write(&SceneMemory::new(&reference, params)?)?;
    writeln!(
        out,
        "{} remembers nothing yet, by {}",
        path.display(),
        reference.name()
    )?;
    Ok(())
}

fn ask(path: &Path, query: &Query, form: Form, out: &mut dyn Write) -> anyhow::Result<()> {
    let answer = memory_file::read(path)?.ask(query)?;
    match (form.format, &answer) {
        (Format::Json, _) => writeln!(out, "{}", serde_json::to_string(&answer)?)?,
        // A tree ends its own last line.
        (Format::Text, Answer::Explain(_)) => write!(out, "{answer}")?,
        (Format::Text, _) => writeln!(out, "{answer}")?,
    }
    Ok(())
}

/// Tells or retracts a fact.
fn change(
    path: &Path,
    arguments: &FactArguments,
    out: &mut dyn Write,
    by: impl FnOnce(&mut SceneMemory, ToldFact) -> Result<Vec<Change>, Refused>,
) -> anyhow::Result<()> {
    let file = MemoryFile::hold(path)?;
    let mut memory = file.read()?;
    let fact = memory.read_fact(&arguments.fact).map_err(|error| {
        WrongCall(format!(
            "\"{}\" is no fact of {}: {error}",
            arguments.fact,
            memory.reference().name()
        ))
    })?;
    let changes = by(&mut memory, fact).context("the memory stays as it was")?;
    file.write(&memory)?;
    write_changes(&changes, arguments.form, out)
}

fn diff(path: &Path, arguments: &DiffArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let memory = memory_file::read(path)?;
    if let Some(before) = &arguments.before {
        let before = memory_file::read(before)?;
        return write_changes(&before.diff(&memory), arguments.form, out);
    }
    let (from, to) = (
        arguments.from.unwrap_or(0),
        arguments.to.unwrap_or(u64::MAX),
    );
    let Some(changes) = memory.changes(from, to) else {
        bail!(
            "the memory no longer keeps all changes since {from} ms; it keeps the last {}",
            memory.params().most_changes
        );
    };
    if arguments.form.format == Format::Json {
        writeln!(out, "{}", serde_json::to_string(&changes)?)?;
        return Ok(());
    }
    for dated in changes {
        writeln!(
            out,
            "{} ms, look {}: {}",
            dated.time_ms, dated.look, dated.change
        )?;
    }
    Ok(())
}
