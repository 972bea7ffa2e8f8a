use std::borrow::Cow;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, ensure};
use rayon::prelude::*;

type Encode<'a> = Box<dyn FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'a>;

/// Files to be: their names, and how their bytes come about.
///
/// Every file is encoded before the first is written, so that nothing in the folder is touched
/// unless everything is there to be written.
#[derive(Default)]
pub(crate) struct Outputs<'a>(Vec<(FileName, Encode<'a>)>);

/// The plain name of a file.
pub(crate) type FileName = Cow<'static, str>;

impl<'a> Outputs<'a> {
    /// Adds a file.
    pub(crate) fn add<E>(
        &mut self,
        name: impl Into<FileName>,
        encode: impl FnOnce() -> Result<Vec<u8>, E> + Send + 'a,
    ) where
        E: Into<anyhow::Error>,
    {
        self.0
            .push((name.into(), Box::new(|| encode().map_err(Into::into))));
    }

    /// The names of the files, in the order they were added.
    pub(crate) fn names(&self) -> Vec<FileName> {
        self.0.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Writes every file into a folder, each whole or not at all; the folder is made if need be.
    pub(crate) fn write(self, folder: &Path) -> anyhow::Result<()> {
        let encoded: Vec<(FileName, Vec<u8>)> = self
            .0
            .into_par_iter()
            .map(|(name, encode)| {
                let bytes = encode().with_context(|| {
                    format!("{} has no bytes to write", folder.join(&*name).display())
                })?;
                Ok((name, bytes))
            })
            .collect::<anyhow::Result<_>>()?;
        fs::create_dir_all(folder).with_context(|| {
            format!(
                "the folder {} cannot be made; choose another --out",
                folder.display()
            )
        })?;
        encoded.into_par_iter().try_for_each(|(name, bytes)| {
            let path = folder.join(&*name);
            stereo_formats::replace(&path, &bytes).with_context(|| {
                format!(
                    "{} cannot be written; its folder must allow writing and have room",
                    path.display()
                )
            })
        })
    }
}

/// Whether a folder can be one for results, before any work is done for it: whatever stands at
/// the path, or at the nearest parent that exists, must be a folder.
pub(crate) fn ensure_folder(path: &Path) -> anyhow::Result<()> {
    let existing = path.ancestors().find(|ancestor| ancestor.exists());
    if let Some(existing) = existing {
        ensure!(
            existing.is_dir(),
            "--out {} cannot be a folder, because {} is a file",
            path.display(),
            existing.display()
        );
    }
    Ok(())
}
