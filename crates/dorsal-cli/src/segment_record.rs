use dorsal::egocentric_depth::{NotSegmentable, Position, SupportPlane};
use serde::Serialize;

/// What a look without labels found, as `look.json` has it.
#[derive(Debug, Serialize)]
pub(crate) struct SegmentRecord {
    objects: usize,
    /// How high the head is above the plane that the objects stand on; nothing without one.
    support_below_m: Option<f64>,
    /// The part of the known depths that lie on it.
    support_share: Option<f64>,
    /// Why no objects were looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
}

impl SegmentRecord {
    pub(crate) fn of(segmented: &Result<SupportPlane, NotSegmentable>, objects: usize) -> Self {
        let support = segmented.as_ref().ok();
        let head = Position::new(0.0, 0.0, 0.0);
        Self {
            objects,
            support_below_m: support.map(|support| support.height_m(head)),
            support_share: support.map(SupportPlane::share),
            refused: segmented.as_ref().err().map(NotSegmentable::to_string),
        }
    }

    /// The same, for a person.
    pub(crate) fn sentence(&self) -> String {
        let plural = if self.objects == 1 { "" } else { "s" };
        match (self.support_below_m, self.support_share) {
            (Some(below_m), Some(share)) => format!(
                "{} object{plural} on a plane {below_m:.2} m from the eyes, which holds {:.0} % of the depths",
                self.objects,
                100.0 * share
            ),
            _ => "none: no plane to stand on".to_owned(),
        }
    }
}
