use dorsal::allocentric_qsr::{
    FreePath, GroundPose, ObjectId, Observer, Orientation, Query, SceneMemory,
};

use crate::score::{HAND_M, believes};
use crate::true_places::TruePlaces;

/// A question to the map, its answer, and what is so.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The question, in the words of `dorsal memory ask` where it has some.
    pub question: String,
    /// What the map answers.
    pub answer: String,
    /// What is so, where the truth can say.
    pub truth: Option<String>,
    /// Whether the answer agrees with the truth; nothing where there is none.
    pub right: Option<bool>,
}

/// Where the hand waits, `[right, forward]` of the head in metres: the near edge of a table.
pub const HAND_AT_M: [f64; 2] = [0.0, 0.75];

/// The two objects of Figure 12 in a map: one to be grasped, and the nearest to its right, which is to
/// be unseen meanwhile. The pair of the paper if it is there, else the closest.
#[must_use]
pub fn figure_12(memory: &SceneMemory) -> Option<[ObjectId; 2]> {
    let paper = [ObjectId::new("cd_box"), ObjectId::new("pc_screen")];
    let known = |name: &ObjectId| believes(memory.object(name).map(|kept| kept.life));
    if paper.iter().all(known) {
        return Some(paper);
    }
    let places: Vec<(&ObjectId, [f64; 2])> = memory
        .objects()
        .filter(|(name, _)| known(name))
        .filter_map(|(name, _)| {
            let place = memory.from_robot(name)?;
            Some((name, [place.right_m, place.forward_m]))
        })
        .collect();
    let pairs = places
        .iter()
        .flat_map(|a| places.iter().map(move |b| (a, b)));
    let beside = pairs.filter_map(|((a, p), (b, q))| {
        let turn = (q[0].atan2(q[1]) - p[0].atan2(p[1])).to_degrees();
        let apart = (p[0] - q[0]).hypot(p[1] - q[1]);
        // So far to the right that one view can do without it.
        (12.0..40.0).contains(&turn).then_some((apart, [*a, *b]))
    });
    let (_, pair) = beside.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(pair.map(Clone::clone))
}

/// Asks the map what a robot that is about to act would ask: Figure 12's questions first. Whether the
/// hand's way to the first of the pair is truly free is told, for the answer to be held against it.
#[must_use]
pub fn ask_all(
    memory: &SceneMemory,
    truth: &TruePlaces,
    pair: Option<&[ObjectId; 2]>,
    way_is_free: bool,
    moved: Option<&str>,
) -> Vec<Asked> {
    let mut asked = Vec::new();
    let mut ask = |words: String, truth: Option<String>, right: Option<bool>| {
        let answer = words
            .parse::<Query>()
            .map_err(|error| error.to_string())
            .and_then(|query| memory.ask(&query).map_err(|error| error.to_string()));
        asked.push(Asked {
            question: words,
            answer: answer.map_or_else(|error| error, |answer| answer.to_string()),
            truth,
            right,
        });
    };
    let relation = |of: &ObjectId, from: &ObjectId| {
        let exact = truth
            .scene(memory.reference(), memory.params().qualify)
            .ok()?;
        let so = exact.relation(from, of)?;
        let read = so.read?;
        let words = format!(
            "{} {}",
            memory.reference().short(read.depth),
            read.orientation.short()
        );
        let answer = memory.relation(from, of, &Observer::Robot)?;
        let depth = answer.places.depth & so.places.depth == so.places.depth;
        let both = answer.places.orientation & so.places.orientation;
        Some((words, depth && both == so.places.orientation))
    };
    if let Some([grasped, unseen]) = pair {
        let so = relation(unseen, grasped);
        ask(
            format!("relation {unseen} from {grasped} seen from robot"),
            so.as_ref().map(|so| so.0.clone()),
            so.as_ref().map(|so| so.1),
        );
        ask(format!("last_seen {unseen}"), None, None);
        ask(
            format!("free_path from {unseen} to {grasped} radius {HAND_M}"),
            None,
            None,
        );
        ask(
            format!("reachable {grasped} within 1.3 radius {HAND_M}"),
            None,
            None,
        );
        ask(format!("right of {grasped}"), None, None);
        ask(format!("where {unseen}"), None, None);
    }
    ask("within c of robot".to_owned(), None, None);
    if let Some(moved) = moved {
        ask(format!("last_seen {moved}"), None, None);
        ask(format!("where {moved}"), place(truth, moved), None);
    }
    if let Some([grasped, unseen]) = pair {
        ask(format!("explain {unseen} from {grasped}"), None, None);
        asked.extend(way(memory, grasped, way_is_free));
    }
    asked
}

/// Where an object truly is, in words.
fn place(truth: &TruePlaces, object: &str) -> Option<String> {
    let place = truth.get(&ObjectId::new(object))?.position;
    Some(format!(
        "{:.3} m to the right, {:.3} m ahead",
        place.x_m, place.z_m
    ))
}

/// What the map knows of the straight way of a hand from [`HAND_AT_M`] to an object: the path of
/// Figure 12. Nothing if the map does not know where the object is.
#[must_use]
pub fn hand_way(memory: &SceneMemory, to: &ObjectId) -> Option<FreePath> {
    memory.free_path(&hand()?, &Observer::Object(to.clone()), HAND_M)
}

/// Where the hand waits, as an end of a way.
pub(crate) fn hand() -> Option<Observer> {
    let [right, forward] = HAND_AT_M;
    Some(Observer::At(GroundPose::new(right, forward, 0.0).ok()?))
}

fn way(memory: &SceneMemory, to: &ObjectId, is_free: bool) -> Option<Asked> {
    let [right, forward] = HAND_AT_M;
    let way = hand_way(memory, to)?;
    let truth = if is_free { "clear" } else { "not clear" };
    Some(Asked {
        question: format!(
            "the way of a hand from {right:.2} m to the right and {forward:.2} m ahead to {to}, radius \
             {HAND_M}"
        ),
        right: Some((way == FreePath::Clear) == is_free),
        answer: way.to_string(),
        truth: Some(truth.to_owned()),
    })
}

/// Whether the map knows the three things that Figure 12 shows: how near the unseen object is, to the
/// class, that it is to the right, and whether the hand's way to the other is clear, which it truly is
/// or is not.
#[must_use]
pub fn knows_figure_12(
    memory: &SceneMemory,
    truth: &TruePlaces,
    pair: &[ObjectId; 2],
    way_is_free: bool,
) -> bool {
    let [grasped, unseen] = pair;
    let exact = truth.scene(memory.reference(), memory.params().qualify);
    let so = exact.ok().and_then(|exact| exact.relation(grasped, unseen));
    let answer = memory.relation(grasped, unseen, &Observer::Robot);
    let (Some(so), Some(answer)) = (so, answer) else {
        return false;
    };
    let rightward = [
        Orientation::FrontRight,
        Orientation::Right,
        Orientation::BackRight,
    ];
    let way = hand_way(memory, grasped);
    answer.places.depth == so.places.depth
        && answer
            .places
            .orientation
            .iter()
            .all(|label| rightward.contains(&label))
        && way.is_some_and(|way| (way == FreePath::Clear) == way_is_free)
}
