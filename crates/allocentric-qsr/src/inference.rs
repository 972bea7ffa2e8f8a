use std::collections::{BTreeMap, BTreeSet};

use crate::depth_reference::DepthReference;
use crate::premise::{Premises, premises_of};
use crate::qualitative_scene::QualitativeScene;
use crate::{
    BaseRelation, Case, Depth, DepthSet, Mode, ObjectId, OrientationSet, Places, Reason, Relation,
    compose,
};

/// What follows about pairs of objects by composition alone, once nothing new comes.
///
/// From the classes and bearings for the observer, each pair seen together gets its first
/// relation; CASE 1 through every third object then narrows the distances, round after round,
/// until a round changes nothing (section 3.2). Rounds look only at the relations of the round
/// before and go by name, so the order of the sightings makes no difference.
///
/// The published calculus is not sound, so it can refute itself. A composition that would leave
/// nothing is set aside as a [`Dispute`] and the relation stays. The sound calculus has no
/// disputes within one look.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inference {
    mode: Mode,
    relations: BTreeMap<(ObjectId, ObjectId), Relation>,
    disputes: Vec<Dispute>,
    rounds: usize,
}

/// A composition that shares no class with the relation it should narrow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dispute {
    /// The two objects of the relation, by name.
    pub between: [ObjectId; 2],
    /// The third object of the composition.
    pub through: ObjectId,
    /// The distance classes the relation has, and keeps.
    pub kept: DepthSet,
    /// The distance classes CASE 1 gives.
    pub refused: DepthSet,
}

impl Inference {
    /// Infers the relations between the objects of one look.
    ///
    /// `Published` reasons from the classes a person reads, `Sound` from all that may hold.
    #[must_use]
    pub fn of_scene(scene: &QualitativeScene, mode: Mode) -> Self {
        Self::close(scene.reference(), mode, &premises_of(scene, mode, 1))
    }

    /// The calculus behind every relation.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Where `to` is at `from`; `None` where nothing follows.
    #[must_use]
    pub fn relation(&self, from: &ObjectId, to: &ObjectId) -> Option<&Relation> {
        self.relations.get(&(from.clone(), to.clone()))
    }

    /// Every relation of which something is known, both ways, by name.
    pub fn relations(&self) -> impl Iterator<Item = &Relation> {
        self.relations.values()
    }

    /// The compositions set aside, in the order they came up.
    #[must_use]
    pub fn disputes(&self) -> &[Dispute] {
        &self.disputes
    }

    /// How many rounds it took, the last of which changed nothing.
    #[must_use]
    pub const fn rounds(&self) -> usize {
        self.rounds
    }

    pub(crate) fn close(reference: &DepthReference, mode: Mode, premises: &Premises) -> Self {
        let names: BTreeSet<&ObjectId> = premises.keys().flat_map(|(a, b)| [a, b]).collect();
        let names: Vec<&ObjectId> = names.into_iter().collect();
        let mut distances = Distances::universal(names.len(), reference.all());
        for (at, (first, second)) in pairs(names.len()).map(|at| (at, (names[at.0], names[at.1]))) {
            if let Some(premise) = premises.get(&(first.clone(), second.clone())) {
                distances.set(at, premise.depth);
            }
        }
        let sums = SumTable::plan(reference, mode);
        let mut through: BTreeMap<(usize, usize), Vec<ObjectId>> = BTreeMap::new();
        let mut disputed = BTreeSet::new();
        let mut disputes = Vec::new();
        let mut rounds = 0;
        loop {
            rounds += 1;
            let before = distances.clone();
            for (i, j) in pairs(names.len()) {
                for k in (0..names.len()).filter(|&k| k != i && k != j) {
                    let composed = sums.of(before.at(i, k), before.at(k, j));
                    let kept = distances.at(i, j);
                    let narrowed = kept & composed;
                    if narrowed.is_empty() {
                        if disputed.insert((i, j, k)) {
                            disputes.push(Dispute {
                                between: [names[i].clone(), names[j].clone()],
                                through: names[k].clone(),
                                kept,
                                refused: composed,
                            });
                        }
                    } else if narrowed != kept {
                        distances.set((i, j), narrowed);
                        let reasons = through.entry((i, j)).or_default();
                        if !reasons.contains(names[k]) {
                            reasons.push(names[k].clone());
                        }
                    }
                }
            }
            if distances == before {
                break;
            }
        }
        let mut relations = BTreeMap::new();
        for (i, j) in pairs(names.len()) {
            let premise = premises.get(&(names[i].clone(), names[j].clone()));
            let depth = distances.at(i, j);
            if premise.is_none() && depth == reference.all() {
                continue;
            }
            let labels = premise.map_or([OrientationSet::ALL; 2], |premise| {
                [premise.second_at_first, premise.first_at_second]
            });
            let reason = Reason::Composed {
                look: premise.map(|premise| premise.look),
                through: through.remove(&(i, j)).unwrap_or_default(),
            };
            for (from, to, orientation) in [(i, j, labels[0]), (j, i, labels[1])] {
                let relation = Relation {
                    from: names[from].clone(),
                    to: names[to].clone(),
                    places: Places { depth, orientation },
                    read: None,
                    mode,
                    reason: reason.clone(),
                };
                relations.insert((relation.from.clone(), relation.to.clone()), relation);
            }
        }
        Self {
            mode,
            relations,
            disputes,
            rounds,
        }
    }
}

/// All pairs of places below `count`, the first below the second.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |i| (i + 1..count).map(move |j| (i, j)))
}

/// The distance classes between objects by their place in the list of names: a symmetric matrix.
#[derive(Clone, PartialEq)]
struct Distances {
    count: usize,
    classes: Vec<DepthSet>,
}

impl Distances {
    fn universal(count: usize, all: DepthSet) -> Self {
        Self {
            count,
            classes: vec![all; count * count],
        }
    }

    fn at(&self, i: usize, j: usize) -> DepthSet {
        self.classes[i * self.count + j]
    }

    fn set(&mut self, (i, j): (usize, usize), classes: DepthSet) {
        self.classes[i * self.count + j] = classes;
        self.classes[j * self.count + i] = classes;
    }
}

/// CASE 1 of every two classes, planned once for a closure.
#[derive(Clone, Debug)]
pub(crate) struct SumTable {
    classes: usize,
    all: DepthSet,
    cells: Vec<DepthSet>,
}

impl SumTable {
    pub(crate) fn plan(reference: &DepthReference, mode: Mode) -> Self {
        let all = reference.all();
        let cells = all
            .iter()
            .flat_map(|first| all.iter().map(move |second| (first, second)))
            .map(|(i, j)| compose(reference, Case::One, mode, i.into(), j.into()).depth)
            .collect();
        Self {
            classes: all.len(),
            all,
            cells,
        }
    }

    pub(crate) fn of(&self, first: DepthSet, second: DepthSet) -> DepthSet {
        let mut sum = DepthSet::EMPTY;
        for i in first.iter().map(Depth::index) {
            for j in second.iter().map(Depth::index) {
                sum |= self.cells[i * self.classes + j];
                if sum == self.all {
                    return sum;
                }
            }
        }
        sum
    }
}
