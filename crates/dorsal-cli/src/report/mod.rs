//! The page that a command leaves beside its files: everything to look at, in one file that needs no
//! network.
mod frame;
mod of_flow;
mod of_look;
mod of_scan;
mod of_v1;
mod plane;

use std::collections::BTreeMap;

use dorsal::Names;
use dorsal::allocentric_qsr::DepthReference;
use serde::Serialize;

pub(crate) use frame::Frame;
pub(crate) use of_flow::flow_page;
pub(crate) use of_look::look_page;
pub(crate) use of_scan::scan_page;
pub(crate) use of_v1::{monogenic_page, responses_page};

/// What the page shows, as data; the page itself draws it.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    version: &'static str,
    /// Short facts for the head of the page: what, and how much.
    pub(crate) facts: Vec<(String, String)>,
    reference: Classes,
    /// The names of labels, by number.
    names: BTreeMap<u16, String>,
    /// What is drawn from above: least and greatest x, least and greatest z, metres.
    extent: [f64; 4],
    pub(crate) frames: Vec<Frame>,
    pub(crate) asked: Vec<QuestionRecord>,
}

/// A distance class.
#[derive(Debug, Serialize)]
struct Class {
    short: String,
    name: String,
    from_m: f64,
}

#[derive(Debug, Serialize)]
struct Classes {
    classes: Vec<Class>,
}

/// A question and its answer.
#[derive(Debug, Serialize)]
pub(crate) struct QuestionRecord {
    pub(crate) question: String,
    pub(crate) answer: String,
    pub(crate) truth: Option<String>,
    pub(crate) right: Option<bool>,
}

impl Report {
    /// A page of these frames; the view from above holds every object of every frame.
    fn new(
        title: impl Into<String>,
        subtitle: impl Into<String>,
        reference: &DepthReference,
        names: &Names,
        frames: Vec<Frame>,
    ) -> Self {
        let mut extent = [-0.3f64, 0.3, 0.0, 0.6];
        for [x, z] in frames.iter().flat_map(Frame::spots) {
            extent[0] = extent[0].min(x - 0.15);
            extent[1] = extent[1].max(x + 0.15);
            extent[3] = extent[3].max(z + 0.25);
        }
        let classes = reference.classes().iter().map(|class| Class {
            short: class.short.clone(),
            name: class.name.clone(),
            from_m: f64::from(class.from_mm) / 1e3,
        });
        Self {
            title: title.into(),
            subtitle: subtitle.into(),
            version: env!("CARGO_PKG_VERSION"),
            facts: Vec::new(),
            reference: Classes {
                classes: classes.collect(),
            },
            names: names
                .iter()
                .map(|(label, name)| (label.0.get(), name.clone()))
                .collect(),
            extent,
            frames,
            asked: Vec::new(),
        }
    }

    /// The bytes of the page.
    pub(crate) fn html(&self) -> Result<Vec<u8>, serde_json::Error> {
        // Inside a script element only `</` could end the data; as an escape it says the same.
        let data = serde_json::to_string(self)?.replace('<', "\\u003c");
        Ok(include_str!("page.html")
            .replacen("DATA</script>", &format!("{data}</script>"), 1)
            .into_bytes())
    }
}
