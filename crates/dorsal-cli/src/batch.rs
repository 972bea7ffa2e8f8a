use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, bail};
use dorsal::v1_gabor::Binocular;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;
use serde::Serialize;
use stereo_formats::picture;

use crate::batch_page::batch_page;
use crate::console::Console;
use crate::look_arguments::LookArguments;
use crate::look_files::look_files;
use crate::look_record::{Inputs, LookRecord};
use crate::look_room::LookRoom;
use crate::pair_list::{NamedPair, pairs};
use crate::report::look_page;
use crate::text_table::TextTable;
use crate::times::Times;

/// What `summary.json` says of a batch: schema `dorsal-batch/1`.
#[derive(Debug, Serialize)]
struct BatchRecord<'a> {
    schema: &'static str,
    version: &'static str,
    pairs: &'a [PairRecord],
}

/// One pair of a batch.
#[derive(Debug, Serialize)]
pub(crate) struct PairRecord {
    pub(crate) name: String,
    left: String,
    right: String,
    pub(crate) state: State,
    /// The part of the pixels that are valid.
    pub(crate) density: Option<f64>,
    /// The median disparity in the sign of files.
    pub(crate) median_px: Option<f64>,
    pub(crate) seconds: Option<f64>,
    /// Why it failed.
    pub(crate) error: Option<String>,
}

/// What became of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum State {
    /// It was looked at.
    Done,
    /// What an earlier batch had finished is kept.
    Kept,
    /// It was not looked at to the end.
    Failed,
}

impl State {
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Kept => "kept",
            Self::Failed => "FAILED",
        }
    }
}

/// `dorsal look` on a folder or a list: every pair in a folder of its own, which appears when all of it is
/// written. A pair that fails does not stop the others.
pub(crate) fn batch(arguments: &LookArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let pairs = pairs(&arguments.left)?;
    fs::create_dir_all(&arguments.out).with_context(|| {
        format!(
            "the folder {} cannot be made; choose another --out",
            arguments.out.display()
        )
    })?;
    let _held = hold(&arguments.out)?;
    keep_options(arguments)?;

    let progress = progress(pairs.len(), arguments.quiet);
    let start = Instant::now();
    let records: Vec<PairRecord> = pairs
        .par_iter()
        .map(|pair| {
            let record = look_or_keep(arguments, pair);
            progress.inc(1);
            if let Some(error) = &record.error {
                progress.suspend(|| {
                    // Standard error that is closed is no reason to fail.
                    let _ = writeln!(std::io::stderr(), "failed: {}: {error}", record.name);
                });
            }
            record
        })
        .collect();
    progress.finish_and_clear();

    let record = BatchRecord {
        schema: "dorsal-batch/1",
        version: env!("CARGO_PKG_VERSION"),
        pairs: &records,
    };
    write(
        &arguments.out,
        "summary.json",
        &serde_json::to_vec_pretty(&record)?,
    )?;
    write(
        &arguments.out,
        "index.html",
        batch_page(&records).as_bytes(),
    )?;

    let mut table = TextTable::new(["pair", "state", ">valid %", ">median px", ">s"]);
    let number = |number: Option<f64>, digits: usize| {
        number.map_or_else(String::new, |number| format!("{number:.digits$}"))
    };
    for record in &records {
        table.line([
            record.name.clone(),
            record.state.word().to_owned(),
            number(record.density.map(|density| 100.0 * density), 1),
            number(record.median_px, 2),
            number(record.seconds, 2),
        ]);
    }
    writeln!(out, "{table}")?;
    let count = |state| {
        records
            .iter()
            .filter(|record| record.state == state)
            .count()
    };
    writeln!(
        out,
        "{} pairs: {} done, {} kept, {} failed, in {:.1} s",
        records.len(),
        count(State::Done),
        count(State::Kept),
        count(State::Failed),
        start.elapsed().as_secs_f64()
    )?;
    writeln!(out, "written   {}/index.html", arguments.out.display())?;
    let failures: Vec<&PairRecord> = records
        .iter()
        .filter(|record| record.state == State::Failed)
        .collect();
    if failures.is_empty() {
        return Ok(());
    }
    writeln!(out, "\nfailures:")?;
    for failure in &failures {
        let error = failure.error.as_deref().unwrap_or_default();
        writeln!(out, "  {}: {error}", failure.name)?;
    }
    out.flush()?;
    bail!(
        "{} of {} pairs failed, see above; the same command looks at them again and keeps the others",
        failures.len(),
        records.len()
    )
}

/// Takes hold of a folder of results, so that two batches do not write the same folders.
fn hold(folder: &Path) -> anyhow::Result<File> {
    let path = folder.join(".batch.lock");
    let lock = File::options().create(true).append(true).open(&path);
    let lock = lock.with_context(|| format!("{} cannot be made", path.display()))?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => bail!(
            "another dorsal writes its looks to {}; wait for it or choose another --out",
            folder.display()
        ),
        Err(TryLockError::Error(error)) => {
            Err(error).with_context(|| format!("{} cannot be locked", path.display()))
        }
    }
}

/// Refuses to mix looks of different options in one folder, unless all are to be done again.
fn keep_options(arguments: &LookArguments) -> anyhow::Result<()> {
    let path = arguments.out.join(".batch.options");
    let options = format!("{} {:?}\n", env!("CARGO_PKG_VERSION"), arguments.options);
    match fs::read_to_string(&path) {
        Ok(before) if before != options && !arguments.again => bail!(
            "{} holds looks that were taken with other options; choose another --out, or look at all \
             pairs again with --again",
            arguments.out.display()
        ),
        Ok(before) if before == options => Ok(()),
        _ => write(&arguments.out, ".batch.options", options.as_bytes()),
    }
}

fn progress(pairs: usize, quiet: bool) -> ProgressBar {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let style =
        ProgressStyle::with_template("{bar:30} {pos}/{len} pairs, {elapsed} gone, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(pairs as u64), target).with_style(style)
}

fn look_or_keep(arguments: &LookArguments, pair: &NamedPair) -> PairRecord {
    let inputs = inputs(arguments, pair);
    let folder = arguments.out.join(&pair.name);
    let record = |state| PairRecord {
        name: pair.name.clone(),
        left: inputs.left.clone(),
        right: inputs.right.clone(),
        state,
        density: None,
        median_px: None,
        seconds: None,
        error: None,
    };
    if !arguments.again
        && let Some((density, median_px)) = finished(&folder, &inputs)
    {
        return PairRecord {
            density,
            median_px,
            ..record(State::Kept)
        };
    }
    let start = Instant::now();
    match look_into(arguments, pair, &folder) {
        Ok((density, median_px)) => PairRecord {
            density: Some(density),
            median_px: median_px.map(f64::from),
            seconds: Some(start.elapsed().as_secs_f64()),
            ..record(State::Done)
        },
        Err(error) => PairRecord {
            error: Some(format!("{error:#}")),
            ..record(State::Failed)
        },
    }
}

/// What a finished look at the same files found; nothing if there is none.
fn finished(folder: &Path, inputs: &Inputs) -> Option<(Option<f64>, Option<f64>)> {
    let text = fs::read(folder.join("look.json")).ok()?;
    let look: serde_json::Value = serde_json::from_slice(&text).ok()?;
    let same = look["inputs"]["left"] == *inputs.left && look["inputs"]["right"] == *inputs.right;
    let numbers = (
        look["density"].as_f64(),
        look["disparity_px"]["median"].as_f64(),
    );
    same.then_some(numbers)
}

/// Looks at a pair and writes its folder beside its name; the name is given when everything is there.
fn look_into(
    arguments: &LookArguments,
    pair: &NamedPair,
    folder: &Path,
) -> anyhow::Result<(f64, Option<f32>)> {
    // What many looks have to say is in their files.
    let console = Console::new(true);
    let options = &arguments.options;
    let mut times = Times::default();
    let eyes = times.measure("reading", || {
        picture::read_pair(Binocular {
            left: &pair.files.left,
            right: &pair.files.right,
        })
    })?;
    let plan = options.plan(eyes.left.size(), options.rig()?, None)?;
    let sight = plan.look(&eyes, &mut LookRoom::default(), &mut times, &console)?;
    let record = LookRecord::new(
        &plan,
        &sight,
        &times,
        inputs(arguments, pair),
        options.dense,
    );
    let (density, median_px) = (sight.disparity.density(), record.median_disparity_px());
    let mut files = look_files(&plan, &sight, &eyes, record);
    files.add("index.html", || {
        look_page(&pair.name, &plan, &sight, &eyes, &times)
    });
    let part = hidden(folder, "part");
    clear(&part)?;
    files.write(&part)?;
    give_name(&part, folder)
        .with_context(|| format!("{} cannot take its name", folder.display()))?;
    Ok((density, median_px))
}

/// Gives a whole folder its name. What had the name before goes away first, and is whole until then.
fn give_name(part: &Path, folder: &Path) -> std::io::Result<()> {
    if folder.exists() {
        let old = hidden(folder, "old");
        if old.exists() {
            fs::remove_dir_all(&old)?;
        }
        fs::rename(folder, &old)?;
        fs::rename(part, folder)?;
        fs::remove_dir_all(&old)?;
    } else {
        fs::rename(part, folder)?;
    }
    // The names are on disk before anyone is told.
    for path in [Some(folder), folder.parent()].into_iter().flatten() {
        File::open(path)?.sync_all()?;
    }
    Ok(())
}

/// A folder beside another, of a name that nobody takes for a result.
fn hidden(folder: &Path, ending: &str) -> PathBuf {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    folder.with_file_name(format!(".{name}.{ending}"))
}

/// Takes away what a batch that was cut off has left.
fn clear(part: &Path) -> anyhow::Result<()> {
    if part.exists() {
        fs::remove_dir_all(part)
            .with_context(|| format!("{} cannot be removed", part.display()))?;
    }
    Ok(())
}

fn inputs(arguments: &LookArguments, pair: &NamedPair) -> Inputs {
    let text = |path: &Path| path.display().to_string();
    Inputs {
        left: text(&pair.files.left),
        right: text(&pair.files.right),
        rig: arguments.options.rig.as_deref().map(text),
        labels: None,
        names: None,
    }
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let path = folder.join(name);
    stereo_formats::replace(&path, bytes)
        .with_context(|| format!("{} cannot be written", path.display()))
}
