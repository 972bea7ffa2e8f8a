use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};
use dorsal::v1_gabor::Binocular;

use crate::wrong_call::WrongCall;

/// A pair of pictures and what it is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NamedPair {
    pub(crate) name: String,
    pub(crate) files: Binocular<PathBuf>,
}

/// The pairs that a folder or a list names, in the order of their names or of the list.
pub(crate) fn pairs(path: &Path) -> anyhow::Result<Vec<NamedPair>> {
    let found = if path.is_dir() {
        of_folder(path)?
    } else {
        let extension = path.extension().and_then(|extension| extension.to_str());
        if extension.is_none_or(|extension| !["txt", "csv", "tsv"].contains(&extension)) {
            return Err(WrongCall(format!(
                "{} is no folder and no list (.txt, .csv, .tsv); a single picture needs the right eye's \
                 after it",
                path.display()
            ))
            .into());
        }
        let text = fs::read_to_string(path)
            .with_context(|| format!("{} cannot be read", path.display()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        of_list(&text, folder).with_context(|| format!("{}", path.display()))?
    };
    let mut met = BTreeMap::new();
    for pair in &found {
        if let Some(other) = met.insert(&pair.name, &pair.files.left) {
            bail!(
                "two pairs are called {}: that of {} and that of {}; give one another name in the list",
                pair.name,
                other.display(),
                pair.files.left.display()
            );
        }
    }
    ensure!(
        !found.is_empty(),
        "{} names no pair; see dorsal look --help for how pairs are named",
        path.display()
    );
    Ok(found)
}

/// A pair a line.
fn of_list(text: &str, folder: &Path) -> anyhow::Result<Vec<NamedPair>> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let number = number + 1;
        // A separator that the line has; names of files may hold the weaker ones.
        let words: Vec<&str> = if line.contains('\t') {
            line.split('\t').map(str::trim).collect()
        } else if line.contains(',') {
            line.split(',').map(str::trim).collect()
        } else {
            line.split_whitespace().collect()
        };
        let (left, right, name) = match words[..] {
            [left, right] => (
                left,
                right,
                format!("{:04}_{}", found.len() + 1, stem(Path::new(left))),
            ),
            [left, right, name] => (left, right, name.to_owned()),
            _ => bail!(
                "line {number} has {} words and needs LEFT, RIGHT and perhaps a NAME, split by tabs, \
                 commas or spaces",
                words.len()
            ),
        };
        let plain = !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\']);
        ensure!(
            plain,
            "line {number}: '{name}' cannot be the name of a folder"
        );
        found.push(NamedPair {
            name,
            files: Binocular {
                left: folder.join(left),
                right: folder.join(right),
            },
        });
    }
    Ok(found)
}

/// Pairs in left/ and right/, pairs side by side, or folders with one pair each.
fn of_folder(folder: &Path) -> anyhow::Result<Vec<NamedPair>> {
    let (left, right) = (folder.join("left"), folder.join("right"));
    if left.is_dir() && right.is_dir() {
        let others = pictures(&right)?;
        let mut found = Vec::new();
        for file in pictures(&left)? {
            let same = others.iter().find(|other| stem(other) == stem(&file));
            let partner = same.with_context(|| {
                format!(
                    "{} has no picture of its name in {}",
                    file.display(),
                    right.display()
                )
            })?;
            found.push(NamedPair {
                name: stem(&file),
                files: Binocular {
                    right: partner.clone(),
                    left: file,
                },
            });
        }
        return Ok(found);
    }
    let mut found = beside(folder)?;
    if found.is_empty() {
        for inner in sorted(folder)?.into_iter().filter(|inner| inner.is_dir()) {
            let mut pairs = beside(&inner)?;
            if pairs.len() == 1
                && let Some(pair) = pairs.pop()
            {
                let name = stem(&inner);
                found.push(NamedPair { name, ..pair });
            }
        }
    }
    Ok(found)
}

/// What the names of two eyes' pictures differ in.
const SIDES: [(&str, &str); 5] = [
    ("left", "right"),
    ("Left", "Right"),
    ("im0", "im1"),
    ("view1", "view5"),
    ("_l", "_r"),
];

/// The pairs of one folder whose names differ in the eye alone.
fn beside(folder: &Path) -> anyhow::Result<Vec<NamedPair>> {
    let files = pictures(folder)?;
    let mut found = Vec::new();
    for file in &files {
        let own = stem(file);
        let partner = SIDES.iter().find_map(|(left, right)| {
            // The last one in the name: `left_shelf_left` is a left picture of the left shelf.
            let at = own.rfind(left)?;
            let other = format!("{}{right}{}", &own[..at], &own[at + left.len()..]);
            let partner = files.iter().find(|file| stem(file) == other)?;
            let bare = format!("{}{}", &own[..at], &own[at + left.len()..]);
            let bare = bare.trim_matches(['_', '-', '.']).replace("__", "_");
            Some((
                if bare.is_empty() {
                    "pair".to_owned()
                } else {
                    bare
                },
                partner,
            ))
        });
        if let Some((name, partner)) = partner {
            found.push(NamedPair {
                name,
                files: Binocular {
                    left: file.clone(),
                    right: partner.clone(),
                },
            });
        }
    }
    Ok(found)
}

fn pictures(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    const KINDS: [&str; 8] = ["png", "jpg", "jpeg", "ppm", "pgm", "pnm", "tif", "tiff"];
    let is_picture = |path: &PathBuf| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        extension.is_some_and(|extension| KINDS.contains(&&*extension.to_ascii_lowercase()))
    };
    Ok(sorted(folder)?.into_iter().filter(is_picture).collect())
}

fn sorted(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).and_then(|entries| {
        entries
            .map(|entry| Ok(entry?.path()))
            .collect::<std::io::Result<Vec<PathBuf>>>()
    });
    let mut entries = entries.with_context(|| format!("{} cannot be read", folder.display()))?;
    entries.sort();
    Ok(entries)
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_line_by_line() {
        let text = "# pairs\na/l.png a/r.png\n\nb l.png, b r.png, b\nc.png\td.png\n";
        let found = of_list(text, Path::new("top")).expect("a list");
        let names: Vec<&str> = found.iter().map(|pair| &*pair.name).collect();
        assert_eq!(names, ["0001_l", "b", "0003_c"]);
        assert_eq!(found[1].files.right, Path::new("top/b r.png"));
        for wrong in ["alone.png", "a b c d", "a b ../c", "a,b,.hidden"] {
            assert!(of_list(wrong, Path::new("")).is_err(), "{wrong}");
        }
    }

    #[test]
    fn pairs_of_a_folder_are_found_by_their_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let touch = |name: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, "").expect("a file");
        };
        touch("walk/shelf_left_01.png");
        touch("walk/shelf_right_01.jpg");
        touch("walk/shelf_left_02.png");
        touch("walk/notes.txt");
        let found = of_folder(&folder.path().join("walk")).expect("pairs");
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].name, "shelf_01");

        touch("scenes/teddy/im0.png");
        touch("scenes/teddy/im1.png");
        touch("scenes/venus/im0.png");
        touch("scenes/venus/im1.png");
        let found = of_folder(&folder.path().join("scenes")).expect("pairs");
        let names: Vec<&str> = found.iter().map(|pair| &*pair.name).collect();
        assert_eq!(names, ["teddy", "venus"]);

        touch("two/left/a.png");
        touch("two/right/a.png");
        assert_eq!(
            of_folder(&folder.path().join("two")).expect("pairs").len(),
            1
        );
        touch("two/left/b.png");
        assert!(of_folder(&folder.path().join("two")).is_err());
    }
}
