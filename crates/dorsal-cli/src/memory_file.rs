use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use dorsal::allocentric_qsr::SceneMemory;

/// The file of a memory, held by one command that changes it.
///
/// A second command that would change it is refused, for it would overwrite what the first has
/// acknowledged. The lock is on a file beside the memory, because the memory itself is replaced;
/// the system frees it when its holder ends, however that ends.
#[derive(Debug)]
pub(crate) struct MemoryFile {
    path: PathBuf,
    _lock: File,
}

impl MemoryFile {
    /// Takes hold of the file, whether it exists or not.
    pub(crate) fn hold(path: &Path) -> anyhow::Result<Self> {
        let mut beside = path.as_os_str().to_owned();
        beside.push(".lock");
        let beside = PathBuf::from(beside);
        let lock = File::options()
            .create(true)
            .append(true)
            .open(&beside)
            .with_context(|| {
                format!(
                    "{} cannot be made; the folder of the memory must exist and allow writing",
                    beside.display()
                )
            })?;
        match lock.try_lock() {
            Ok(()) => Ok(Self {
                path: path.to_owned(),
                _lock: lock,
            }),
            Err(TryLockError::WouldBlock) => bail!(
                "{} is held by another dorsal that changes it; wait for that one or end it",
                path.display()
            ),
            Err(TryLockError::Error(error)) => {
                Err(error).with_context(|| format!("{} cannot be locked", beside.display()))
            }
        }
    }

    /// Reads the memory.
    pub(crate) fn read(&self) -> anyhow::Result<SceneMemory> {
        read(&self.path)
    }

    /// Writes the memory, whole or not at all.
    pub(crate) fn write(&self, memory: &SceneMemory) -> anyhow::Result<()> {
        let text = memory.to_json() + "\n";
        stereo_formats::replace(&self.path, text.as_bytes()).with_context(|| {
            format!(
                "{} cannot be written, so nothing has changed; its folder must allow writing and \
                 have room",
                self.path.display()
            )
        })
    }
}

/// Reads a memory that is not going to be changed.
pub(crate) fn read(path: &Path) -> anyhow::Result<SceneMemory> {
    if !path.exists() {
        bail!(
            "there is no memory {}; make one with `dorsal memory init`, or name yours with --memory",
            path.display()
        );
    }
    let text = fs::read_to_string(path)
        .with_context(|| format!("{} cannot be read as a memory", path.display()))?;
    SceneMemory::from_json(&text)
        .with_context(|| format!("{} is no memory of this command", path.display()))
}
