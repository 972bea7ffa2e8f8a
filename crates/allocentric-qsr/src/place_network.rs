use std::collections::BTreeMap;

use crate::constraint_network::{Closure, DistanceFact, NotAFact};
use crate::depth_reference::DepthReference;
use crate::direction_fact::DirectionFact;
use crate::double_cross::DOUBLE_CROSS;
use crate::double_cross_set::DoubleCrossSet;
use crate::inference::SumTable;
use crate::path_closure::Clash;
use crate::proof::{Claim, Ground, Pair, Proof, Triple};
use crate::triangle_table::TriangleTable;
use crate::{
    Depth, DepthSet, Explanation, Mode, ObjectId, Orientation, OrientationSet, Places, Rule,
};

/// Objects, and what may hold of the distances and the directions between them, closed together.
///
/// Distances and Freksa-Zimmermann labels narrow each other through the triangle relation
/// ([`TriangleTable`]); labels are also composed with labels. Five rules are carried to their common
/// fixpoint, each sound by itself:
///
/// | rule | from | follows |
/// |---|---|---|
/// | triangle inequality | \|ik\|, \|kj\| | \|ij\| |
/// | [`Rule::Triangle`] | three distances and a direction of one triangle | each of the four |
/// | [`Rule::Chain`] (CASE 1) | c at b seen from a, d at c seen from b | d at b seen from a |
/// | [`Rule::Turn`] | the turns from c to d and from d to e at b | the turn from c to e at b |
/// | [`Rule::Exchange`] | d at c seen from b | c at d seen from b |
///
/// What comes out is not refuted, never *consistent*; see [`Closure::NotRefuted`]. It does not depend
/// on the order of the facts, for they are sorted and closed anew whenever some are added: a network
/// of told facts is small. For distances alone, in thousands, there is
/// [`ConstraintNetwork`](crate::ConstraintNetwork).
///
/// ```
/// use allocentric_qsr::{Closure, DepthReference, DirectionFact, DistanceFact, FactSource, PlaceNetwork};
///
/// let reference = DepthReference::robot_120();
/// let mut network = PlaceNetwork::new(&reference, ["door", "cup", "lamp"].map(Into::into));
/// let fact = |a: &str, b: &str, class: &str| DistanceFact {
///     between: [a.into(), b.into()],
///     depth: reference.class_named(class).expect("a label of the system").into(),
///     source: FactSource::Told(format!("{b} within {class} of {a}")),
/// };
/// // 1 to 1.2 m to the cup, and as much from the cup to the lamp, square to the left of it:
/// network.constrain([fact("door", "cup", "n"), fact("cup", "lamp", "n")], [])?;
/// let left = DirectionFact::read("lamp l of cup seen from door").expect("a fact");
/// network.constrain([], [left])?;
/// // the lamp is 1.41 to 1.7 m from the door, which distances alone do not say.
/// let lamp = network.places(&"door".into(), &"cup".into(), &"lamp".into()).expect("known");
/// assert_eq!(lamp.orientation.labels(), ["l"]);
/// let depth = network.depth(&"door".into(), &"lamp".into()).expect("known");
/// assert_eq!(reference.labels(depth), ["f"]);
/// # Ok::<(), allocentric_qsr::NotAFact>(())
/// ```
#[derive(Clone, Debug)]
pub struct PlaceNetwork {
    reference: DepthReference,
    objects: Vec<ObjectId>,
    distance_facts: Vec<DistanceFact>,
    direction_facts: Vec<DirectionFact>,
    state: State,
}

/// What may hold, and why.
#[derive(Clone, Debug)]
struct State {
    count: usize,
    distances: Vec<DepthSet>,
    directions: BTreeMap<Triple, DoubleCrossSet>,
    proof: Proof,
}

impl PlaceNetwork {
    /// A network of these objects of which nothing is known.
    #[must_use]
    pub fn new(reference: &DepthReference, objects: impl IntoIterator<Item = ObjectId>) -> Self {
        let mut objects: Vec<ObjectId> = objects.into_iter().collect();
        objects.sort_unstable();
        objects.dedup();
        Self {
            reference: reference.clone(),
            state: State::universal(reference, objects.len()),
            objects,
            distance_facts: Vec::new(),
            direction_facts: Vec::new(),
        }
    }

    /// The objects, by name.
    #[must_use]
    pub fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    /// What may hold of the distance between two objects; `None` if one is unknown.
    #[must_use]
    pub fn depth(&self, from: &ObjectId, to: &ObjectId) -> Option<DepthSet> {
        Some(self.state.distance(self.place(from)?, self.place(to)?))
    }

    /// Where an object may be at a reference, seen from an observer; `None` if one of the three is
    /// unknown, or observer and reference are one.
    #[must_use]
    pub fn places(
        &self,
        observer: &ObjectId,
        reference: &ObjectId,
        object: &ObjectId,
    ) -> Option<Places> {
        let (b, c, d) = (
            self.place(observer)?,
            self.place(reference)?,
            self.place(object)?,
        );
        (b != c).then(|| Places {
            depth: self.state.distance(c, d),
            orientation: self.state.direction(b, c, d).at_c(),
        })
    }

    /// Every direction of which something is known, as observer, reference and object, with the
    /// labels of the object at the reference; by name.
    pub fn directions(&self) -> impl Iterator<Item = ([&ObjectId; 3], OrientationSet)> {
        self.state.directions.iter().map(|(&(b, c, d), rows)| {
            let names = [b, c, d].map(|at| &self.objects[at]);
            (names, rows.at_c())
        })
    }

    /// Takes facts and closes all facts anew. Facts that contradict the network are not taken.
    ///
    /// # Errors
    /// [`NotAFact`] names the object or the pair; the network stays as it was.
    pub fn constrain(
        &mut self,
        distances: impl IntoIterator<Item = DistanceFact>,
        directions: impl IntoIterator<Item = DirectionFact>,
    ) -> Result<Closure, NotAFact> {
        let mut distance_facts = self.distance_facts.clone();
        distance_facts.extend(distances);
        distance_facts.sort();
        distance_facts.dedup();
        let mut direction_facts = self.direction_facts.clone();
        direction_facts.extend(directions);
        direction_facts.sort();
        direction_facts.dedup();
        let mut told = Vec::new();
        for fact in &distance_facts {
            let claim = Claim::Distance(self.pair_of(fact)?, fact.depth);
            let (source, turned) = (fact.source.clone(), false);
            told.push((claim, Ground::Fact { source, turned }));
        }
        for fact in &direction_facts {
            let (b, c, d) = self.triple_of(fact)?;
            let rows = DoubleCrossSet::of(fact.at_reference, fact.at_observer);
            let rows = if b < c { rows } else { rows.swapped() };
            let claim = Claim::Direction((b.min(c), b.max(c), d), rows);
            let (source, turned) = (fact.source.clone(), b > c);
            told.push((claim, Ground::Fact { source, turned }));
        }
        let mut state = State::universal(&self.reference, self.objects.len());
        // The first clash ends it, so that the proof ends in its last line.
        let taken = told
            .into_iter()
            .try_for_each(|(claim, ground)| state.take(claim, ground).map(|_| ()));
        let table = TriangleTable::plan(&self.reference);
        let sums = SumTable::plan(&self.reference, Mode::Sound);
        if taken.and_then(|()| state.settle(&table, &sums)).is_err() {
            let proof = state.proof.tell(None, &self.objects, &self.reference);
            return Ok(Closure::Inconsistent(proof));
        }
        let narrowed = (0..self.objects.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .filter(|&(i, j)| state.distance(i, j) != self.state.distance(i, j))
            .count();
        (self.distance_facts, self.direction_facts) = (distance_facts, direction_facts);
        self.state = state;
        Ok(Closure::NotRefuted { narrowed })
    }

    /// Why the distance between two objects may be in no other class; `None` if one is unknown, or
    /// nothing is known of it.
    #[must_use]
    pub fn explain(&self, from: &ObjectId, to: &ObjectId) -> Option<Explanation> {
        let (i, j) = (self.place(from)?, self.place(to)?);
        let line = self.state.proof.line_of_pair((i.min(j), i.max(j)))?;
        Some(
            self.state
                .proof
                .tell(Some(line), &self.objects, &self.reference),
        )
    }

    /// Why an object may be nowhere else at a reference, seen from an observer; `None` if one is
    /// unknown, or nothing is known of it. The observer and the reference may stand exchanged in the
    /// answer, with both labels turned round.
    #[must_use]
    pub fn explain_direction(
        &self,
        observer: &ObjectId,
        reference: &ObjectId,
        object: &ObjectId,
    ) -> Option<Explanation> {
        let (b, c, d) = (
            self.place(observer)?,
            self.place(reference)?,
            self.place(object)?,
        );
        let line = self.state.proof.line_of_triple((b.min(c), b.max(c), d))?;
        Some(
            self.state
                .proof
                .tell(Some(line), &self.objects, &self.reference),
        )
    }

    fn place(&self, object: &ObjectId) -> Option<usize> {
        self.objects.binary_search(object).ok()
    }

    fn known(&self, object: &ObjectId) -> Result<usize, NotAFact> {
        self.place(object)
            .ok_or_else(|| NotAFact::Unknown(object.clone()))
    }

    fn pair_of(&self, fact: &DistanceFact) -> Result<Pair, NotAFact> {
        let [a, b] = &fact.between;
        if a == b {
            return Err(NotAFact::Itself(a.clone()));
        }
        if fact.depth.is_empty() || !fact.depth.is_subset(self.reference.all()) {
            return Err(NotAFact::Classes(a.clone(), b.clone()));
        }
        let (i, j) = (self.known(a)?, self.known(b)?);
        Ok((i.min(j), i.max(j)))
    }

    fn triple_of(&self, fact: &DirectionFact) -> Result<Triple, NotAFact> {
        if fact.observer == fact.reference {
            return Err(NotAFact::Itself(fact.observer.clone()));
        }
        // Where an object is at itself is no fact either.
        if fact.object == fact.reference || fact.object == fact.observer {
            return Err(NotAFact::Itself(fact.object.clone()));
        }
        if DoubleCrossSet::of(fact.at_reference, fact.at_observer).is_empty() {
            return Err(NotAFact::Labels(
                fact.object.clone(),
                fact.reference.clone(),
            ));
        }
        Ok((
            self.known(&fact.observer)?,
            self.known(&fact.reference)?,
            self.known(&fact.object)?,
        ))
    }
}

impl State {
    fn universal(reference: &DepthReference, count: usize) -> Self {
        let mut distances = vec![reference.all(); count * count];
        for place in 0..count {
            distances[place * count + place] = Depth::FIRST.into();
        }
        Self {
            count,
            distances,
            directions: BTreeMap::new(),
            proof: Proof::default(),
        }
    }

    fn distance(&self, i: usize, j: usize) -> DepthSet {
        self.distances[i * self.count + j]
    }

    fn direction(&self, b: usize, c: usize, d: usize) -> DoubleCrossSet {
        let known = self.directions.get(&(b.min(c), b.max(c), d));
        let rows = known.copied().unwrap_or(DoubleCrossSet::ALL);
        if b < c { rows } else { rows.swapped() }
    }

    /// Narrows to what is claimed and writes it down, if it says anything new.
    fn take(&mut self, derived: Claim, ground: Ground) -> Result<bool, Clash> {
        let (before, after, empty) = match derived {
            Claim::Distance((i, j), set) => {
                let before = self.distance(i, j);
                let after = before & set;
                if after == before {
                    return Ok(false);
                }
                self.distances[i * self.count + j] = after;
                self.distances[j * self.count + i] = after;
                let claim = |set| Claim::Distance((i, j), set);
                (claim(before), claim(after), after.is_empty())
            }
            Claim::Direction(triple, rows) => {
                let known = self.directions.get(&triple);
                let before = known.copied().unwrap_or(DoubleCrossSet::ALL);
                let after = before.and(rows);
                if after == before {
                    return Ok(false);
                }
                self.directions.insert(triple, after);
                let claim = |rows| Claim::Direction(triple, rows);
                (claim(before), claim(after), after.is_empty())
            }
        };
        self.proof.narrow(derived, ground, before, after);
        if empty { Err(Clash) } else { Ok(true) }
    }

    /// Carries every rule round after round, until a round changes nothing.
    fn settle(&mut self, table: &TriangleTable, sums: &SumTable) -> Result<(), Clash> {
        loop {
            let mut changed = self.compose_distances(sums)?;
            let triples: Vec<Triple> = self.directions.keys().copied().collect();
            for &triple in &triples {
                changed |= self.revise(triple, table)?;
                changed |= self.exchange(triple)?;
            }
            for &first in &triples {
                for &second in &triples {
                    changed |= self.join(first, second)?;
                }
            }
            if !changed {
                return Ok(());
            }
        }
    }

    /// The triangle inequality through every third object.
    fn compose_distances(&mut self, sums: &SumTable) -> Result<bool, Clash> {
        let mut changed = false;
        for i in 0..self.count {
            for j in i + 1..self.count {
                for k in (0..self.count).filter(|&k| k != i && k != j) {
                    let (first, second) = (self.distance(i, k), self.distance(k, j));
                    let composed = sums.of(first, second);
                    if self.distance(i, j).is_subset(composed) {
                        continue;
                    }
                    let premises = [
                        self.proof.distance((i.min(k), i.max(k)), first),
                        self.proof.distance((k.min(j), k.max(j)), second),
                    ];
                    let claim = Claim::Distance((i, j), composed);
                    changed |= self.take(claim, Ground::Composed(k, premises))?;
                }
            }
        }
        Ok(changed)
    }

    /// The three distances and the direction of one triangle narrow each other to what some three
    /// points have.
    fn revise(&mut self, (b, c, d): Triple, table: &TriangleTable) -> Result<bool, Clash> {
        if d == b || d == c {
            return Ok(false);
        }
        let (x, y, r) = (
            self.distance(b, c),
            self.distance(c, d),
            self.distance(b, d),
        );
        let rows = self.direction(b, c, d);
        let (mut xs, mut ys, mut rs) = (DepthSet::EMPTY, DepthSet::EMPTY, DepthSet::EMPTY);
        let mut kept = DoubleCrossSet::EMPTY;
        for i in x.iter() {
            for j in y.iter() {
                for row in rows.rows() {
                    let (at_c, at_b) = DOUBLE_CROSS[row];
                    let sides = table.third_side(i, j, at_c, at_b) & r;
                    if !sides.is_empty() {
                        (xs, ys, rs) = (xs | i.into(), ys | j.into(), rs | sides);
                        kept = kept.with(row);
                    }
                }
            }
        }
        if (xs, ys, rs, kept) == (x, y, r, rows) {
            return Ok(false);
        }
        let ordered = |i: usize, j: usize| (i.min(j), i.max(j));
        let premises = vec![
            self.proof.distance(ordered(b, c), x),
            self.proof.distance(ordered(c, d), y),
            self.proof.distance(ordered(b, d), r),
            self.proof.direction((b, c, d), rows),
        ];
        let ground = Ground::Directed(Rule::Triangle, premises);
        let mut changed = false;
        for (pair, set) in [((b, c), xs), ((c, d), ys), ((b, d), rs)] {
            let claim = Claim::Distance(ordered(pair.0, pair.1), set);
            changed |= self.take(claim, ground.clone())?;
        }
        changed |= self.take(Claim::Direction((b, c, d), kept), ground)?;
        Ok(changed)
    }

    /// The same three points, told with d in the place of c and of b, where d is apart from the other.
    fn exchange(&mut self, (b, c, d): Triple) -> Result<bool, Clash> {
        let rows = self.direction(b, c, d);
        let mut changed = false;
        for (from, third, rows) in [(b, c, rows), (c, b, rows.swapped())] {
            if rows.at_b().contains(Orientation::None) || from == d {
                continue;
            }
            changed |= self.say(
                from,
                d,
                third,
                rows.exchanged(),
                Rule::Exchange,
                &[(b, c, d)],
            )?;
        }
        Ok(changed)
    }

    /// What two directions say together that share a way: [`Rule::Chain`] and [`Rule::Turn`].
    fn join(&mut self, first: Triple, second: Triple) -> Result<bool, Clash> {
        let mut changed = false;
        let tellings = |(b, c, d): Triple| [(b, c, d), (c, b, d)];
        for (a, b, c) in tellings(first) {
            for (from, to, d) in tellings(second) {
                let (one, two) = (self.direction(a, b, c), self.direction(from, to, d));
                if (from, to) == (b, c) && d != a && d != b {
                    // c at b seen from a, then d against the way from b to c.
                    let apart = one.at_c().without(Orientation::None);
                    let labels = apart.turned(two.at_b());
                    let rows = DoubleCrossSet::of(labels, OrientationSet::ALL);
                    changed |= self.say(a, b, d, rows, Rule::Chain, &[first, second])?;
                }
                if (from, to) == (a, c) && d != a && d != b {
                    // The turns at a from b to c and from c to d.
                    let apart = one.at_b().without(Orientation::None);
                    let labels = apart.turned(two.at_b());
                    let rows = DoubleCrossSet::of(OrientationSet::ALL, labels);
                    changed |= self.say(a, b, d, rows, Rule::Turn, &[first, second])?;
                }
            }
        }
        Ok(changed)
    }

    /// Takes in where d is at c seen from b, as it follows by a rule from some triples.
    fn say(
        &mut self,
        b: usize,
        c: usize,
        d: usize,
        rows: DoubleCrossSet,
        rule: Rule,
        from: &[Triple],
    ) -> Result<bool, Clash> {
        let (triple, rows) = if b < c {
            ((b, c, d), rows)
        } else {
            ((c, b, d), rows.swapped())
        };
        let known = self.direction(triple.0, triple.1, triple.2);
        if known.and(rows) == known {
            return Ok(false);
        }
        let premises = from.iter().map(|&premise| {
            let rows = self.direction(premise.0, premise.1, premise.2);
            self.proof.direction(premise, rows)
        });
        let premises: Vec<usize> = premises.collect();
        self.take(
            Claim::Direction(triple, rows),
            Ground::Directed(rule, premises),
        )
    }
}
