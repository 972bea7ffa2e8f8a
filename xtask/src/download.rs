use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use indicatif::ProgressBar;

use crate::manifest::{ListedFile, ListedScene};

/// Why a file of the data could not be had.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NotDownloaded {
    /// The program that fetches does not start.
    #[error("the program curl, which fetches files, does not start: {0}; install it")]
    NoCurl(io::Error),
    /// The file does not come.
    #[error("{url} does not come: {message}")]
    NotFetched {
        /// Where it was looked for.
        url: String,
        /// What the fetching program says.
        message: String,
    },
    /// Something else came.
    #[error(
        "{url} is not the file of the manifest: {size} bytes and SHA-256 {sha256} were expected, \
         and nothing was kept"
    )]
    OtherFile {
        /// Where it came from.
        url: String,
        /// The length in the manifest.
        size: u64,
        /// The checksum in the manifest.
        sha256: String,
    },
    /// The file cannot be kept.
    #[error("{} cannot be written: {cause}", path.display())]
    NotWritten {
        /// Its path.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

/// How many files a download fetched, and how many were there before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Downloaded {
    /// Fetched and verified.
    pub(crate) fetched: usize,
    /// In place before, and verified.
    pub(crate) kept: usize,
}

/// Brings every file of the scenes into the data folder, laid out as below the base address.
///
/// A file that is there with the right checksum is left alone, so a download that was cut off goes
/// on where it stopped; no file takes its name before its checksum is right.
///
/// `fetch` gets an address and the length that is expected, and gives the bytes.
pub(crate) fn download(
    scenes: &[&ListedScene],
    data: &Path,
    base: &str,
    progress: &ProgressBar,
    mut fetch: impl FnMut(&str, u64) -> Result<Vec<u8>, NotDownloaded>,
) -> Result<Downloaded, NotDownloaded> {
    let files = scenes.iter().map(|scene| scene.files.len()).sum::<usize>();
    progress.set_length(files as u64);
    let mut downloaded = Downloaded::default();
    for scene in scenes {
        let folder = data.join(&scene.folder);
        std::fs::create_dir_all(&folder).map_err(|cause| NotDownloaded::NotWritten {
            path: folder.clone(),
            cause,
        })?;
        for file in &scene.files {
            progress.set_message(format!("{} {}", scene.name, file.name));
            let path = folder.join(&file.name);
            if is_there(&path, file) {
                downloaded.kept += 1;
            } else {
                let base = base.trim_end_matches('/');
                let url = format!("{base}/{}/{}", scene.folder, file.name);
                let bytes = fetch(&url, file.size)?;
                if !file.is(&bytes) {
                    return Err(NotDownloaded::OtherFile {
                        url,
                        size: file.size,
                        sha256: file.sha256.to_string(),
                    });
                }
                stereo_formats::replace(&path, &bytes)
                    .map_err(|cause| NotDownloaded::NotWritten { path, cause })?;
                downloaded.fetched += 1;
            }
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    Ok(downloaded)
}

fn is_there(path: &Path, file: &ListedFile) -> bool {
    let length = std::fs::metadata(path).map(|found| found.len());
    length.is_ok_and(|length| length == file.size)
        && std::fs::read(path).is_ok_and(|bytes| file.is(&bytes))
}

/// Fetches an address (`http`, `https` or `file`) with the program curl, which every desktop
/// system brings and which knows the system's proxies and certificates.
///
/// No more than one byte beyond the expected length is taken: enough to see that it is too long.
pub(crate) fn with_curl(url: &str, expected: u64) -> Result<Vec<u8>, NotDownloaded> {
    let mut curl = Command::new("curl")
        .args([
            "--fail",
            "--silent",
            "--show-error",
            "--location",
            "--globoff",
        ])
        .args([
            "--proto",
            "=http,https,file",
            "--proto-redir",
            "=http,https",
        ])
        .args(["--connect-timeout", "30", "--retry", "2", "--url", url])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(NotDownloaded::NoCurl)?;
    let not_fetched = |message: String| NotDownloaded::NotFetched {
        url: url.to_owned(),
        message,
    };
    let mut bytes = Vec::new();
    let read = curl
        .stdout
        .take()
        .map(|stdout| stdout.take(expected + 1).read_to_end(&mut bytes));
    // The pipe is closed by now, so a longer answer ends the program too.
    let output = curl
        .wait_with_output()
        .map_err(|cause| not_fetched(cause.to_string()))?;
    if let Some(Err(cause)) = read {
        return Err(not_fetched(cause.to_string()));
    }
    if output.status.success() || bytes.len() as u64 > expected {
        Ok(bytes)
    } else {
        Err(not_fetched(
            String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        ))
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader, Write};
    use std::net::TcpListener;

    use super::*;
    use crate::sha256::Sha256;

    fn scene() -> ListedScene {
        let file = |name: &str, bytes: &[u8]| ListedFile {
            name: name.to_owned(),
            size: bytes.len() as u64,
            sha256: Sha256::of(bytes),
        };
        ListedScene {
            name: "small".to_owned(),
            folder: "stereo/made/small".to_owned(),
            files: vec![file("left.png", b"left"), file("right.png", b"right!")],
        }
    }

    fn answer(url: &str) -> Vec<u8> {
        let name = url
            .strip_prefix("http://there/base/stereo/made/small/")
            .unwrap();
        match name {
            "left.png" => b"left".to_vec(),
            "right.png" => b"right!".to_vec(),
            other => panic!("{other} is not listed"),
        }
    }

    #[test]
    fn a_cut_off_download_goes_on() {
        let data = tempfile::tempdir().unwrap();
        let quiet = ProgressBar::hidden();
        let (scene, base) = (scene(), "http://there/base/");
        let cut_off = download(&[&scene], data.path(), base, &quiet, |url, _| {
            if url.ends_with("right.png") {
                return Err(NotDownloaded::NotFetched {
                    url: url.to_owned(),
                    message: "gone".to_owned(),
                });
            }
            Ok(answer(url))
        });
        assert!(
            cut_off
                .unwrap_err()
                .to_string()
                .contains("right.png does not come: gone")
        );
        let folder = data.path().join("stereo/made/small");
        assert!(folder.join("left.png").is_file() && !folder.join("right.png").exists());

        // A file with other bytes is fetched again, one with the right bytes is not.
        std::fs::write(folder.join("right.png"), "wrong!").unwrap();
        let done = download(&[&scene], data.path(), base, &quiet, |url, _| {
            Ok(answer(url))
        });
        assert_eq!(
            done.unwrap(),
            Downloaded {
                fetched: 1,
                kept: 1
            }
        );
        assert_eq!(std::fs::read(folder.join("right.png")).unwrap(), b"right!");
        let again = download(&[&scene], data.path(), base, &quiet, |_, _| {
            panic!("all is there")
        });
        assert_eq!(
            again.unwrap(),
            Downloaded {
                fetched: 0,
                kept: 2
            }
        );
    }

    #[test]
    fn another_file_is_not_kept() {
        let data = tempfile::tempdir().unwrap();
        let refused = download(
            &[&scene()],
            data.path(),
            "http://there/base",
            &ProgressBar::hidden(),
            |_, _| Ok(b"evil".to_vec()),
        );
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("4 bytes and SHA-256"), "{refused}");
        let folder = data.path().join("stereo/made/small");
        assert_eq!(folder.read_dir().unwrap().count(), 0);
    }

    /// One answer of a server on this machine, as bytes of HTTP.
    fn serve_once(answer: &'static [u8]) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut lines = BufReader::new(stream.try_clone().unwrap()).lines();
            while lines
                .next()
                .is_some_and(|line| line.is_ok_and(|line| !line.is_empty()))
            {}
            stream.write_all(answer).unwrap();
        });
        format!("http://{address}/file")
    }

    #[test]
    fn curl_fetches_and_says_what_went_wrong() {
        if Command::new("curl").arg("--version").output().is_err() {
            return;
        }
        let url = serve_once(b"HTTP/1.1 200 OK\r\nContent-Length: 4\r\n\r\nleft");
        assert_eq!(with_curl(&url, 4).unwrap(), b"left");
        let url = serve_once(b"HTTP/1.1 404 Not Found\r\nContent-Length: 4\r\n\r\ngone");
        let gone = with_curl(&url, 4).unwrap_err().to_string();
        assert!(gone.contains("404"), "{gone}");
        // An answer that is too long is cut where it shows.
        let url = serve_once(b"HTTP/1.1 200 OK\r\nContent-Length: 6\r\n\r\nlonger");
        assert_eq!(with_curl(&url, 4).unwrap(), b"longe");

        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "local").unwrap();
        let url = format!("file://{}", file.path().display());
        assert_eq!(with_curl(&url, 5).unwrap(), b"local");
        assert!(with_curl("ftp://127.0.0.1/file", 5).is_err());
    }
}
