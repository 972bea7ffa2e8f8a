use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use dorsal::v1_gabor::Binocular;
use numpy::PyArray3;
use pyo3::prelude::*;
use stereo_formats::picture::Picture;
use stereo_streams::{Bag, BagPairs, NoPair, decode_camera, decode_image, recorded_rig};

use crate::files::rgb_array;
use crate::refusal::value_error;
use crate::rig::Rig;

/// A pair of a recording: its stamp in nanoseconds, and what each eye saw.
type RecordedPair<'py> = (u64, Bound<'py, PyArray3<u8>>, Bound<'py, PyArray3<u8>>);

/// The stereo pairs of a rosbag2 file in MCAP, one after another; several Python threads may hold it, and each pair
/// goes to one of them.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Recording {
    path: PathBuf,
    pairs: Mutex<BagPairs<BufReader<File>>>,
}

#[pymethods]
impl Recording {
    #[new]
    fn new(path: PathBuf, left: &str, right: &str, tolerance_ns: u64) -> PyResult<Self> {
        if left == right {
            let why =
                format!("left and right are both {left}; the two eyes have topics of their own");
            return Err(value_error(why));
        }
        let pairs = BagPairs::new(opened(&path)?, Binocular { left, right }, tolerance_ns);
        Ok(Self {
            path,
            pairs: Mutex::new(pairs),
        })
    }

    fn __iter__(this: Py<Self>) -> Py<Self> {
        this
    }

    /// The next pair, `uint8` `(height, width, 3)` each.
    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<RecordedPair<'py>>> {
        let Some((time_ns, eyes)) = py.detach(|| self.next_pair())? else {
            return Ok(None);
        };
        let Binocular { left, right } = eyes;
        Ok(Some((
            time_ns,
            rgb_array(py, &left)?,
            rgb_array(py, &right)?,
        )))
    }

    /// How many pictures of each eye came so far, and how many of them stayed without a partner.
    fn counts(&self) -> ((u64, u64), (u64, u64)) {
        let pairs = self.pairs.lock().unwrap_or_else(PoisonError::into_inner);
        let (came, dropped) = (pairs.came(), pairs.dropped());
        ((came.left, came.right), (dropped.left, dropped.right))
    }

    /// The topics that were met so far, each with its type.
    fn topics(&self) -> Vec<(String, String)> {
        let pairs = self.pairs.lock().unwrap_or_else(PoisonError::into_inner);
        let topics = pairs.bag().topics();
        topics
            .map(|(topic, kind)| (topic.to_owned(), kind.to_owned()))
            .collect()
    }
}

impl Recording {
    fn next_pair(&self) -> PyResult<Option<(u64, Binocular<Picture>)>> {
        let mut pairs = self.pairs.lock().unwrap_or_else(PoisonError::into_inner);
        let named = |why: String| value_error(format!("{}: {why}", self.path.display()));
        let Some(next) = pairs.next() else {
            return Ok(None);
        };
        let (time_ns, pair) = next.map_err(|why| match why {
            NoPair::Stamp { ref cause, .. } => named(format!("{why}: {cause}")),
            NoPair::Bag(why) => named(why.to_string()),
        })?;
        let eyes = pair.as_ref().try_map(|message| {
            let picture = decode_image(&message.kind, &message.bytes);
            picture.map_err(|why| named(format!("{} at {time_ns} ns: {why}", message.topic)))
        })?;
        Ok(Some((time_ns, eyes)))
    }
}

/// The rig that a recording has of its cameras, from the first message on each of these topics.
#[pyfunction]
pub(crate) fn rig_of_recording(
    py: Python<'_>,
    path: PathBuf,
    left: &str,
    right: &str,
    rectified: bool,
) -> PyResult<Rig> {
    let named = |why: &dyn std::fmt::Display| value_error(format!("{}: {why}", path.display()));
    let mut bag = Bag::new(opened(&path)?, [left, right]);
    let (mut left_found, mut right_found) = (None, None);
    py.detach(|| {
        while left_found.is_none() || right_found.is_none() {
            let Some(message) = bag.next() else {
                let missing = if left_found.is_none() { left } else { right };
                return Err(named(&format!("it has no message on {missing}")));
            };
            let message = message.map_err(|why| named(&why))?;
            let camera = decode_camera(&message.bytes);
            let camera = camera.map_err(|why| named(&format!("{}: {why}", message.topic)))?;
            if *message.topic == *left {
                left_found = Some(camera);
            } else {
                right_found = Some(camera);
            }
        }
        Ok(())
    })?;
    let (Some(left), Some(right)) = (left_found, right_found) else {
        return Err(named(&"it has no cameras"));
    };
    let rig = recorded_rig(&Binocular { left, right }, rectified);
    rig.map(Rig::unsized_).map_err(|why| named(&why))
}

fn opened(path: &PathBuf) -> PyResult<BufReader<File>> {
    let file = File::open(path).map_err(|why| {
        std::io::Error::new(
            why.kind(),
            format!("{} cannot be opened: {why}", path.display()),
        )
    })?;
    Ok(BufReader::new(file))
}
