use dorsal::allocentric_qsr::{Change, SceneMemory};
use dorsal_scan::{Asked, Pairs, Score, TruePlaces};
use serde::Serialize;

use crate::drift_record::DriftRecord;
use crate::scan_step::ScanStep;
use crate::times::Times;

/// What `scan.json` says of a scan: schema `dorsal-scan/1`.
#[derive(Debug, Serialize)]
pub(crate) struct ScanRecord {
    schema: &'static str,
    version: &'static str,
    looks: Vec<LookOfScan>,
    objects: Vec<ObjectOfScan>,
    score: ScoreRecord,
    asked: Vec<AskedRecord>,
}

/// One look.
#[derive(Debug, Serialize)]
pub(crate) struct LookOfScan {
    number: usize,
    why: String,
    /// Right, down, forward.
    fixation_m: [f64; 3],
    moved: Option<String>,
    drift: Option<DriftRecord>,
    /// Cut by the edge of the picture, so not sighted.
    cut: Vec<String>,
    changes: Vec<Change>,
    refused: Option<String>,
    time_ms: Times,
}

/// An object of the map beside the truth, `[right, forward]`.
#[derive(Debug, Serialize)]
struct ObjectOfScan {
    name: String,
    life: Option<&'static str>,
    place_m: Option<[f64; 2]>,
    sigma_m: Option<[f64; 2]>,
    true_place_m: [f64; 2],
}

#[derive(Debug, Serialize)]
struct ScoreRecord {
    objects: usize,
    missed: Vec<String>,
    ghosts: Vec<String>,
    sound: PairsRecord,
    published: PairsRecord,
    ways_clear: usize,
    ways_clear_wrongly: usize,
    ways_blocked: usize,
    ways_unknown: usize,
    holds: bool,
}

#[derive(Debug, Serialize)]
struct PairsRecord {
    asked: usize,
    true_class: f64,
    true_orientation: f64,
    classes_left: f64,
    labels_left: f64,
}

#[derive(Debug, Serialize)]
struct AskedRecord {
    question: String,
    answer: String,
    truth: Option<String>,
    right: Option<bool>,
}

impl ScanRecord {
    pub(crate) fn new(
        looks: Vec<LookOfScan>,
        memory: &SceneMemory,
        truth: &TruePlaces,
        score: &Score,
        asked: &[Asked],
    ) -> Self {
        let names = |names: &[dorsal::allocentric_qsr::ObjectId]| {
            names.iter().map(ToString::to_string).collect()
        };
        Self {
            schema: "dorsal-scan/1",
            version: env!("CARGO_PKG_VERSION"),
            looks,
            objects: truth
                .iter()
                .map(|(name, so)| {
                    let place = memory.from_robot(name);
                    ObjectOfScan {
                        name: name.to_string(),
                        life: memory.object(name).map(|kept| kept.life.label()),
                        place_m: place.map(|place| [place.right_m, place.forward_m]),
                        sigma_m: place
                            .map(|place| [0, 1].map(|axis| place.covariance_m2[axis][axis].sqrt())),
                        true_place_m: [so.position.x_m, so.position.z_m],
                    }
                })
                .collect(),
            score: ScoreRecord {
                objects: score.objects,
                missed: names(&score.missed),
                ghosts: names(&score.ghosts),
                sound: PairsRecord::of(&score.sound),
                published: PairsRecord::of(&score.published),
                ways_clear: score.ways.clear,
                ways_clear_wrongly: score.ways.wrong,
                ways_blocked: score.ways.blocked,
                ways_unknown: score.ways.unknown,
                holds: score.holds(),
            },
            asked: asked
                .iter()
                .map(|asked| AskedRecord {
                    question: asked.question.clone(),
                    answer: asked.answer.clone(),
                    truth: asked.truth.clone(),
                    right: asked.right,
                })
                .collect(),
        }
    }
}

impl LookOfScan {
    pub(crate) fn of(step: &ScanStep) -> Self {
        let look = &step.look;
        Self {
            number: look.number,
            why: look.shown.fixation.why.to_string(),
            fixation_m: look.shown.fixation.point_m,
            moved: look.moved.clone(),
            drift: look.drift.as_ref().map(DriftRecord::of),
            cut: look.cut.iter().map(ToString::to_string).collect(),
            changes: look.changes.clone(),
            refused: look.refused.clone(),
            time_ms: step.times.clone(),
        }
    }
}

impl PairsRecord {
    fn of(pairs: &Pairs) -> Self {
        let ((true_class, true_orientation), (classes_left, labels_left)) =
            (pairs.right(), pairs.left());
        Self {
            asked: pairs.asked,
            true_class,
            true_orientation,
            classes_left,
            labels_left,
        }
    }
}
