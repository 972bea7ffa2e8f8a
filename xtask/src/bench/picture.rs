use super::contestants::{DENSE_FAST, LOOK, VECTOR};
use super::report::{AtSize, Report};
use crate::curve_svg::{self, Diagram, Sheet};

/// Where the picture stands, seen from the documents' folder.
pub(super) const PICTURE: &str = "pictures/performance.svg";

const DRAWN: [&str; 5] = [VECTOR, DENSE_FAST, LOOK, "SGBM", "DIS"];

/// Time and memory a pixel against the size of the image; `None` of a single size.
pub(super) fn picture(report: &Report) -> Option<String> {
    let sizes = &report.sizes;
    if sizes.len() < 2 {
        return None;
    }
    let diagram = |title: &str, value: fn(&AtSize, &str) -> Option<f64>| {
        let point = |at: &AtSize, name| Some((pixels(at) / 1e6, value(at, name)?));
        let curve = |name| sizes.iter().filter_map(|at| point(at, name)).collect();
        Diagram {
            title: title.to_owned(),
            curves: DRAWN.map(curve).into(),
        }
    };
    let sheet = Sheet {
        title: "Time and memory a pixel, over the size of the image in megapixels".to_owned(),
        names: DRAWN.map(str::to_owned).into(),
        diagrams: vec![
            diagram("CPU time, ns a pixel", |at, name| {
                let found = at.contestants.iter().find(|one| one.name == name)?;
                Some(found.cpu_ns_a_pixel)
            }),
            diagram("wall time on two threads, ns a pixel", |at, name| {
                let found = at.two_threads.iter().find(|one| one.name == name)?;
                Some(found.wall_ms * 1e6 / pixels(at))
            }),
            diagram("workspace, bytes a pixel", |at, name| {
                let found = at.memory.iter().find(|one| one.name == name)?;
                Some(found.bytes_a_pixel)
            }),
        ],
    };
    Some(curve_svg::encode(&sheet))
}

fn pixels(at: &AtSize) -> f64 {
    (at.width * at.height) as f64
}
