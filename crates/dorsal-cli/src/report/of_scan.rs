use dorsal::Names;
use dorsal::allocentric_qsr::{Observer, QualitativeScene};
use dorsal_scan::{Asked, Score, TruePlaces};
use stereo_formats::file_sign;

use crate::report::frame::{Frame, MOST_WIDTH, TrueSpot};
use crate::report::plane::{LabelPlane, Plane};
use crate::report::{QuestionRecord, Report};
use crate::scan_step::ScanStep;

/// Planes of a scan are half as wide as those of a single look, because there are many.
const PLANE_WIDTH: usize = MOST_WIDTH / 2;

impl Frame {
    /// One look of a scan, beside the truth of its moment.
    pub(crate) fn of_scan(
        step: &ScanStep,
        truth: &TruePlaces,
        names: &Names,
    ) -> anyhow::Result<Self> {
        let look = &step.look;
        let size = look.percept.depth.size();
        let mut frame = Self::new(format!("look {}", look.number), size);
        frame.why = look.shown.fixation.why.to_string();
        let moved = look.moved.as_ref();
        frame
            .notes
            .extend(moved.map(|object| format!("somebody has moved {object}")));
        let changes = look.changes.iter().map(ToString::to_string);
        frame.notes.extend(changes);
        let refused = look.refused.as_ref();
        frame
            .notes
            .extend(refused.map(|why| format!("not remembered: {why}")));
        let pictures = &look.shown.pictures;
        frame.picture("left", pictures.left.view(), "what the left eye sees")?;
        frame.picture("right", pictures.right.view(), "what the right eye sees")?;
        let d = file_sign::d_of_field(&look.percept.disparity, false);
        frame.planes.insert(
            "disparity",
            Plane::of(
                d.view(),
                PLANE_WIDTH,
                "px",
                "disparity in colours, near is red",
            ),
        );
        let depth = look.percept.depth.metres();
        frame.planes.insert(
            "depth",
            Plane::of(depth, PLANE_WIDTH, "m", "depth in colours, near is red"),
        );
        let labels = &look.shown.view.truth.labels;
        frame.labels = Some(LabelPlane::of(labels, PLANE_WIDTH));
        frame.see(&look.percept.egocentric, names);
        let [right, down, forward] = look.shown.fixation.point_m;
        frame.fixation = Some([right, forward]);
        frame.look_over(&look.rig, down);
        frame.times = step.times.milliseconds();

        let memory = &look.memory;
        frame.remember(memory);
        frame.truth = truth
            .iter()
            .map(|(name, place)| TrueSpot {
                name: name.to_string(),
                x: place.position.x_m,
                z: place.position.z_m,
            })
            .collect();
        let reference = memory.reference();
        let exact: QualitativeScene = truth.scene(reference, memory.params().qualify)?;
        let known: Vec<_> = memory.objects().map(|(name, _)| name.clone()).collect();
        for name in &known {
            if let Some(place) = memory.place_from(memory.robot(), name) {
                frame.egocentric(&place, reference);
            }
        }
        for from in &known {
            for to in known.iter().filter(|to| *to != from) {
                let Some(relation) = memory.relation(from, to, &Observer::Robot) else {
                    continue;
                };
                let so = exact.relation(from, to).map(|so| so.places);
                let why = memory.explain(from, to).map(|why| why.to_string());
                frame.relate(&relation, so, why, reference);
            }
        }
        Ok(frame)
    }
}

/// The page of a scan.
pub(crate) fn scan_page(
    frames: Vec<Frame>,
    names: &Names,
    reference: &dorsal::allocentric_qsr::DepthReference,
    score: &Score,
    asked: &[Asked],
) -> anyhow::Result<Vec<u8>> {
    let looks = frames.len();
    let mut report = Report::new(
        "A head scans a room",
        "Look after look a map grows: noisy cameras, lenses not quite as calibrated, encoders that err, \
         a right eye that has slipped, and one thing that somebody moves",
        reference,
        names,
        frames,
    );
    let ((depth, orientation), (classes, _)) = (score.sound.right(), score.sound.left());
    let found = score.objects - score.missed.len();
    report.facts = vec![
        ("looks".into(), looks.to_string()),
        (
            "objects found".into(),
            format!("{found} of {}", score.objects),
        ),
        (
            "relations with the truth in them".into(),
            format!("{:.1} %", 100.0 * depth.min(orientation)),
        ),
        ("distance classes left".into(), format!("{classes:.2}")),
        (
            "ways called clear".into(),
            format!("{}, {} wrongly", score.ways.clear, score.ways.wrong),
        ),
    ];
    report.asked = asked
        .iter()
        .map(|asked| QuestionRecord {
            question: asked.question.clone(),
            answer: asked.answer.clone(),
            truth: asked.truth.clone(),
            right: asked.right,
        })
        .collect();
    Ok(report.html()?)
}
