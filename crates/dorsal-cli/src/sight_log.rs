use std::fs::{self, File};
use std::io::{BufWriter, Cursor, Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use dorsal::Names;
use dorsal::v1_gabor::Binocular;
use stereo_formats::picture::Picture;
use stereo_streams::{LoggedLook, LookLog};

use crate::sight::Sight;

/// Adds what one look gave to a log.
fn log_sight<W: Write + Seek + Send + 'static>(
    log: &LookLog<W>,
    time_ns: u64,
    sight: &Sight,
    eyes: &Binocular<Picture>,
) -> anyhow::Result<()> {
    let none = Names::new();
    let objects = sight.objects.as_ref();
    let scene = sight.scene.as_ref();
    let relations = scene.map_or_else(Vec::new, |scene| {
        let relations = scene.qualitative.relations();
        let reference = scene.qualitative.reference();
        relations.iter().map(|r| r.record(reference)).collect()
    });
    log.look(&LoggedLook {
        time_ns,
        pictures: eyes.as_ref().map(Picture::rgb),
        rig: sight.rig.as_ref(),
        depth: sight.depth.as_ref(),
        objects: scene.map_or(&[], |scene| &scene.egocentric.objects),
        names: objects.map_or(&none, |objects| &objects.names),
        relations,
    })?;
    Ok(())
}

/// Writes the log of a single look, at time 0, whole or not at all.
pub(crate) fn log_of_one(
    path: &Path,
    sight: &Sight,
    eyes: &Binocular<Picture>,
) -> anyhow::Result<()> {
    let log = LookLog::begin(Cursor::new(Vec::new()))?;
    log_sight(&log, 0, sight, eyes)?;
    let bytes = log.finish()?.into_inner();
    stereo_formats::replace(path, &bytes).with_context(|| no_place(path))
}

/// A log that grows in a file beside its name, and takes the name when it is whole. What a power cut
/// leaves beside the name holds every look that was acknowledged; `mcap recover` reads it.
#[derive(Debug)]
pub(crate) struct LogFile {
    path: PathBuf,
    part: PathBuf,
    log: LookLog<BufWriter<File>>,
}

impl LogFile {
    pub(crate) fn begin(path: &Path) -> anyhow::Result<Self> {
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        let file = File::create(&part).with_context(|| no_place(path))?;
        Ok(Self {
            path: path.to_owned(),
            log: LookLog::begin(BufWriter::new(file)).with_context(|| no_place(path))?,
            part,
        })
    }

    pub(crate) fn look(
        &self,
        time_ns: u64,
        sight: &Sight,
        eyes: &Binocular<Picture>,
    ) -> anyhow::Result<()> {
        log_sight(&self.log, time_ns, sight, eyes).with_context(|| no_place(&self.path))
    }

    pub(crate) fn add(&self, look: &LoggedLook<'_>) -> anyhow::Result<()> {
        self.log.look(look).with_context(|| no_place(&self.path))
    }

    /// Ends the log and gives it its name.
    pub(crate) fn finish(self) -> anyhow::Result<()> {
        let written = self.log.finish().with_context(|| no_place(&self.path))?;
        written
            .into_inner()
            .map_err(std::io::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .and_then(|()| fs::rename(&self.part, &self.path))
            .with_context(|| no_place(&self.path))
    }
}

fn no_place(path: &Path) -> String {
    format!(
        "{} cannot be written; its folder must exist, allow writing and have room",
        path.display()
    )
}
