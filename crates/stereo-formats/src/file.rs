use std::fmt;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// The longest file that is read, in bytes: 1 GiB.
///
/// A plane of the largest picture read here takes a quarter of it. The bound is there for what
/// never ends, such as a device.
pub const LONGEST_FILE: u64 = 1 << 30;

/// Why a file could not be read: which file, and what is wrong with it.
#[derive(Debug, thiserror::Error)]
pub enum Unreadable<E> {
    /// The file does not open, or its bytes do not come.
    #[error("{} cannot be opened: {cause}; check the path and its permissions", path.display())]
    Closed {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// The file is longer than [`LONGEST_FILE`].
    #[error(
        "{} is longer than {LONGEST_FILE} bytes, the most that is read; is it the right file?",
        path.display()
    )]
    TooLong {
        /// The file.
        path: PathBuf,
    },
    /// The bytes are not what this reader reads.
    #[error("{}: {cause}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with its bytes.
        cause: E,
    },
}

/// Why a file could not be written: which file, and what stood in the way.
///
/// Whatever stood at the path before stands there still.
#[derive(Debug, thiserror::Error)]
pub enum Unwritable<E> {
    /// The value has no form in this format.
    #[error("{} is not written: {cause}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Why the value does not fit the format.
        cause: E,
    },
    /// The system did not take the bytes.
    #[error(
        "{} cannot be written: {cause}; its folder must exist, allow writing and have room",
        path.display()
    )]
    Disk {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

/// Reads a whole file and decodes it.
pub(crate) fn read<T, E>(
    path: &Path,
    decode: impl FnOnce(&[u8]) -> Result<T, E>,
) -> Result<T, Unreadable<E>> {
    let closed = |cause| Unreadable::Closed {
        path: path.to_owned(),
        cause,
    };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LONGEST_FILE + 1).read_to_end(&mut bytes))
        .map_err(closed)?;
    if bytes.len() as u64 > LONGEST_FILE {
        return Err(Unreadable::TooLong {
            path: path.to_owned(),
        });
    }
    decode(&bytes).map_err(|cause| Unreadable::Content {
        path: path.to_owned(),
        cause,
    })
}

/// Writes what `encoded` holds, whole or not at all.
pub(crate) fn write<E: fmt::Display>(
    path: &Path,
    encoded: Result<Vec<u8>, E>,
) -> Result<(), Unwritable<E>> {
    let bytes = encoded.map_err(|cause| Unwritable::Content {
        path: path.to_owned(),
        cause,
    })?;
    replace(path, &bytes).map_err(|cause| Unwritable::Disk {
        path: path.to_owned(),
        cause,
    })
}

/// Writes a file whole or not at all: a temporary file in the same folder is filled, brought to
/// the disk and renamed, so a reader sees the old bytes or the new ones and a full disk leaves
/// nothing half-written.
///
/// # Errors
/// What the system says. Whatever stood at `path` before stands there still.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    // A temporary file is its owner's alone by default; a result is for whoever may see the folder,
    // as far as the user's mask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|refused| refused.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_value_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plane");
        replace(&path, b"old").unwrap();
        let refused = write(&path, Err::<Vec<u8>, _>("too wide")).unwrap_err();
        assert!(refused.to_string().ends_with("too wide"), "{refused}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        replace(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        // No temporary file is left beside it.
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_rename_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        std::fs::create_dir(&path).unwrap();
        std::fs::write(path.join("inside"), b"").unwrap();
        assert!(replace(&path, b"bytes").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn errors_name_the_path() {
        let path = Path::new("no/such/folder/file.pfm");
        let unread = read(path, |_| Ok::<(), String>(()))
            .unwrap_err()
            .to_string();
        assert!(unread.contains("no/such/folder/file.pfm"), "{unread}");
        let unwritten = write(path, Ok::<_, String>(vec![1]))
            .unwrap_err()
            .to_string();
        assert!(unwritten.contains("no/such/folder/file.pfm"), "{unwritten}");
    }
}
