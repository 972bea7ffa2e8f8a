use std::collections::BTreeMap;

use crate::depth_reference::DepthReference;
use crate::explanation::{Because, Explanation, Statement, Step};
use crate::path_closure::{Clash, Narrowing, PathClosure};
use crate::place::owned_labels;
use crate::word_table::{Word, WordTable};
use crate::{DepthSet, ObjectId};

/// What is known of one distance, and from whom.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct DistanceFact {
    /// The two objects.
    pub between: [ObjectId; 2],
    /// The classes their distance may be in.
    pub depth: DepthSet,
    /// Where it comes from.
    pub source: FactSource,
}

/// Where a fact comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FactSource {
    /// Somebody said so, in these words.
    Told(String),
    /// The two looks that show the objects.
    Measured([u64; 2]),
    /// The two looks that show the objects, in two map frames that these objects join.
    Joined {
        /// The looks.
        looks: [u64; 2],
        /// The objects that both frames have, by name.
        landmarks: Vec<ObjectId>,
    },
}

/// Why facts are none of a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotAFact {
    /// The network does not have the object.
    #[error("`{0}` is no object of the network")]
    Unknown(ObjectId),
    /// An object is at itself, and nothing else can be said.
    #[error("`{0}` has no distance to itself to be told")]
    Itself(ObjectId),
    /// No class may hold, which is no fact, or a class is of a larger reference system.
    #[error("the classes told of `{0}` and `{1}` are none, or none of this system")]
    Classes(ObjectId, ObjectId),
    /// No label may hold, or none at the reference goes with one at the observer.
    #[error("the labels told of `{0}` at `{1}` are none that three points have")]
    Labels(ObjectId, ObjectId),
}

/// What a closure comes to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Closure {
    /// No three objects contradict each other. This is less than *consistent*: a network may
    /// survive every triangle and still have no place in the plane.
    NotRefuted {
        /// How many pairs may be in fewer classes than before.
        narrowed: usize,
    },
    /// The facts cannot hold together, in the plane or anywhere; the network stays as it was.
    Inconsistent(Explanation),
}

/// Objects and what may hold of the distance between any two, closed under composition.
///
/// Each fact is carried through every third object by the sound composition
/// ([`compose`](crate::compose)) until nothing narrows. The result does not depend on the order of
/// the facts. Memory is two bytes for every pair in systems of up to eight classes, four up to sixteen
/// and eight beyond, and a quarter byte for the queue; reasons are worked out again when asked for, so they cost
/// nothing until then.
///
/// ```
/// use allocentric_qsr::{Closure, ConstraintNetwork, DepthReference, DistanceFact, FactSource};
///
/// let reference = DepthReference::robot_120();
/// let mut network = ConstraintNetwork::new(&reference, ["cup", "box", "lamp"].map(Into::into));
/// let fact = |a: &str, b: &str, class: &str| DistanceFact {
///     between: [a.into(), b.into()],
///     depth: reference.class_named(class).expect("a label of the system").into(),
///     source: FactSource::Told(format!("{b} {class} of {a}")),
/// };
/// network.constrain([fact("cup", "box", "vc"), fact("box", "lamp", "vc")])?;
/// let far = network.depth(&"cup".into(), &"lamp".into()).expect("both are objects");
/// assert_eq!(reference.labels(far), ["vc", "c", "n"]);
///
/// let Closure::Inconsistent(proof) = network.constrain([fact("cup", "lamp", "vf")])? else {
///     panic!("two steps of less than 60 cm do not make 250 cm");
/// };
/// assert!(proof.to_string().contains("nothing is left"));
/// # Ok::<(), allocentric_qsr::NotAFact>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConstraintNetwork {
    reference: DepthReference,
    table: WordTable,
    objects: Vec<ObjectId>,
    facts: Vec<DistanceFact>,
    cells: Cells,
}

/// The matrix, in the width the system needs.
#[derive(Clone, Debug)]
enum Cells {
    Narrow(PathClosure<u8>),
    Middle(PathClosure<u16>),
    Wide(PathClosure<u32>),
}

impl ConstraintNetwork {
    /// A network of these objects of which nothing is known.
    #[must_use]
    pub fn new(reference: &DepthReference, objects: impl IntoIterator<Item = ObjectId>) -> Self {
        let mut objects: Vec<ObjectId> = objects.into_iter().collect();
        objects.sort_unstable();
        objects.dedup();
        let table = WordTable::plan(reference);
        Self {
            cells: Cells::universal(&table, objects.len()),
            reference: reference.clone(),
            table,
            objects,
            facts: Vec::new(),
        }
    }

    /// The reference system of the distance classes.
    #[must_use]
    pub const fn reference(&self) -> &DepthReference {
        &self.reference
    }

    /// The objects, by name.
    #[must_use]
    pub fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    /// The facts, in the order they came.
    #[must_use]
    pub fn facts(&self) -> &[DistanceFact] {
        &self.facts
    }

    /// What may hold of the distance between two objects; `None` if one is unknown.
    #[must_use]
    pub fn depth(&self, from: &ObjectId, to: &ObjectId) -> Option<DepthSet> {
        let (i, j) = (self.place(from)?, self.place(to)?);
        Some(DepthSet::of_bits(self.cells.at(i, j)))
    }

    /// Takes facts and carries them through the network: all at once is the full closure, one is
    /// an increment. Facts that contradict the network are not taken.
    ///
    /// # Errors
    /// [`NotAFact`] names the object or the pair; the network stays as it was.
    pub fn constrain(
        &mut self,
        facts: impl IntoIterator<Item = DistanceFact>,
    ) -> Result<Closure, NotAFact> {
        let facts: Vec<DistanceFact> = facts.into_iter().collect();
        let mut told = Vec::with_capacity(facts.len());
        for fact in &facts {
            told.push((self.pair_of(fact)?, fact.depth.bits()));
        }
        let settled = match &mut self.cells {
            Cells::Narrow(cells) => carry(cells, &self.table, &told),
            Cells::Middle(cells) => carry(cells, &self.table, &told),
            Cells::Wide(cells) => carry(cells, &self.table, &told),
        };
        if let Ok(narrowed) = settled {
            self.facts.extend(facts);
            return Ok(Closure::NotRefuted { narrowed });
        }
        let together = self.facts.iter().chain(&facts).cloned().collect();
        Ok(Closure::Inconsistent(self.replay(together, None)))
    }

    /// The network without the facts that `gone` says, closed anew.
    #[must_use]
    pub fn without(&self, gone: impl Fn(&DistanceFact) -> bool) -> Self {
        let kept = self.facts.iter().filter(|fact| !gone(fact)).cloned();
        let mut next = Self::new(&self.reference, self.objects.iter().cloned());
        // Fewer facts than hold together hold together, and each has been checked.
        let closed = next.constrain(kept);
        debug_assert!(matches!(closed, Ok(Closure::NotRefuted { .. })));
        next
    }

    /// Why the distance between two objects may be in no other class; `None` if one is unknown.
    ///
    /// The network keeps no reasons: this closes it once more from the facts in a fixed order,
    /// writing down every step, so the explanation does not depend on the order of the facts.
    #[must_use]
    pub fn explain(&self, from: &ObjectId, to: &ObjectId) -> Option<Explanation> {
        let pair = (self.place(from)?, self.place(to)?);
        Some(self.replay(self.facts.clone(), Some(pair)))
    }

    /// The memory all pairs take together, in bytes; names and facts are beside it.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.cells {
            Cells::Narrow(cells) => cells.bytes(),
            Cells::Middle(cells) => cells.bytes(),
            Cells::Wide(cells) => cells.bytes(),
        }
    }

    fn place(&self, object: &ObjectId) -> Option<usize> {
        self.objects.binary_search(object).ok()
    }

    fn pair_of(&self, fact: &DistanceFact) -> Result<(usize, usize), NotAFact> {
        let [a, b] = &fact.between;
        let place = |object: &ObjectId| {
            let unknown = || NotAFact::Unknown(object.clone());
            self.place(object).ok_or_else(unknown)
        };
        if a == b {
            return Err(NotAFact::Itself(a.clone()));
        }
        if fact.depth.is_empty() || !fact.depth.is_subset(self.reference.all()) {
            return Err(NotAFact::Classes(a.clone(), b.clone()));
        }
        Ok((place(a)?, place(b)?))
    }

    /// Closes the facts anew and tells how the pair came to its set, or the first pair for which
    /// nothing is left.
    fn replay(&self, mut facts: Vec<DistanceFact>, pair: Option<(usize, usize)>) -> Explanation {
        facts.sort();
        facts.dedup();
        let mut told: BTreeMap<(usize, usize), Vec<&DistanceFact>> = BTreeMap::new();
        for fact in &facts {
            if let Ok((i, j)) = self.pair_of(fact) {
                told.entry((i.min(j), i.max(j))).or_default().push(fact);
            }
        }
        let mut cells = PathClosure::<u32>::universal(self.objects.len(), self.table.all());
        let mut log = Vec::new();
        let mut clash = None;
        for (&(i, j), facts) in &told {
            let together = facts
                .iter()
                .fold(self.reference.all(), |all, fact| all & fact.depth);
            cells.impose(i, j, together.bits());
            if together.is_empty() && clash.is_none() {
                clash = Some((i, j));
            }
        }
        if clash.is_none() && cells.settle(&self.table, &mut log).is_err() {
            clash = log.last().map(|n| (n.pair.0 as usize, n.pair.1 as usize));
        }
        let story = Story::of(self, &told, &log);
        let asked = pair.or(clash).unwrap_or((0, 0));
        story.tell(asked)
    }
}

impl Cells {
    fn universal(table: &WordTable, count: usize) -> Self {
        if table.is_narrow() {
            Self::Narrow(PathClosure::universal(count, table.all()))
        } else if table.is_middle() {
            Self::Middle(PathClosure::universal(count, table.all()))
        } else {
            Self::Wide(PathClosure::universal(count, table.all()))
        }
    }

    fn at(&self, i: usize, j: usize) -> u32 {
        match self {
            Self::Narrow(cells) => cells.at(i, j),
            Self::Middle(cells) => cells.at(i, j),
            Self::Wide(cells) => cells.at(i, j),
        }
    }
}

/// Narrows the told pairs and settles; the number of pairs that are narrower than before. On a
/// clash every pair gets back what it had.
fn carry<W: Word>(
    cells: &mut PathClosure<W>,
    table: &WordTable,
    told: &[((usize, usize), u32)],
) -> Result<usize, Clash> {
    let mut log = Vec::new();
    let mut settled = Ok(());
    for &((i, j), bits) in told {
        let before = cells.at(i, j);
        let after = before & bits;
        if after == before {
            continue;
        }
        log.push(Narrowing {
            pair: (i as u32, j as u32),
            through: i as u32,
            before,
            after,
        });
        cells.impose(i, j, after);
        if after == 0 {
            settled = Err(Clash);
        }
    }
    let settled = settled.and_then(|()| cells.settle(table, &mut log));
    if settled.is_err() {
        cells.abandon();
        for narrowing in log.iter().rev() {
            let (i, j) = narrowing.pair;
            cells.set(i as usize, j as usize, narrowing.before);
        }
    }
    settled.map(|()| {
        let mut pairs: Vec<(u32, u32)> = log.iter().map(|n| ordered(n.pair)).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs.len()
    })
}

fn ordered((i, j): (u32, u32)) -> (u32, u32) {
    (i.min(j), i.max(j))
}

/// A closure with all its steps, to be told backwards from one pair.
struct Story<'n> {
    network: &'n ConstraintNetwork,
    told: &'n BTreeMap<(usize, usize), Vec<&'n DistanceFact>>,
    log: &'n [Narrowing],
    /// The steps of each pair, in the order they came.
    of_pair: BTreeMap<(usize, usize), Vec<usize>>,
}

impl<'n> Story<'n> {
    fn of(
        network: &'n ConstraintNetwork,
        told: &'n BTreeMap<(usize, usize), Vec<&'n DistanceFact>>,
        log: &'n [Narrowing],
    ) -> Self {
        let mut of_pair: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for (at, narrowing) in log.iter().enumerate() {
            let (i, j) = narrowing.pair;
            of_pair
                .entry((i as usize, j as usize))
                .or_default()
                .push(at);
        }
        Self {
            network,
            told,
            log,
            of_pair,
        }
    }

    fn tell(&self, pair: (usize, usize)) -> Explanation {
        let mut explanation = Explanation { steps: Vec::new() };
        self.branch(&mut explanation, &mut BTreeMap::new(), pair, self.log.len());
        explanation
    }

    /// The step by which the pair had its set before the step `until` of the log, and the set.
    fn branch(
        &self,
        explanation: &mut Explanation,
        known: &mut BTreeMap<((usize, usize), Option<usize>), Told>,
        (from, to): (usize, usize),
        until: usize,
    ) -> Told {
        let pair = (from.min(to), from.max(to));
        let steps = self.of_pair.get(&pair).map_or(&[][..], Vec::as_slice);
        let last = steps[..steps.partition_point(|&at| at < until)]
            .last()
            .copied();
        if let Some(&told) = known.get(&(pair, last)) {
            return told;
        }
        let told = match last {
            None => self.base(explanation, pair),
            Some(at) => {
                let narrowing = self.log[at];
                let through = narrowing.through as usize;
                let ends = [(pair.0, through), (through, pair.1)];
                let [first, second] = ends.map(|end| self.branch(explanation, known, end, at));
                let composed = u32::compose(&u32::row(&self.network.table, first.set), second.set);
                let because = Because::Composed {
                    through: self.network.objects[through].clone(),
                    premises: [first.place, second.place],
                };
                if composed == narrowing.after {
                    self.push(explanation, pair, composed, because)
                } else {
                    let before = self.branch(explanation, known, pair, at);
                    let composed = self.push(explanation, pair, composed, because);
                    self.both(explanation, pair, before, composed)
                }
            }
        };
        known.insert((pair, last), told);
        told
    }

    /// What was told of a pair, or that nothing was.
    fn base(&self, explanation: &mut Explanation, pair: (usize, usize)) -> Told {
        let mut sofar: Option<Told> = None;
        for fact in self.told.get(&pair).map_or(&[][..], Vec::as_slice) {
            let because = match &fact.source {
                FactSource::Told(fact) => Because::Told { fact: fact.clone() },
                FactSource::Measured(looks) => Because::Measured { looks: *looks },
                FactSource::Joined { looks, landmarks } => Because::Joined {
                    looks: *looks,
                    landmarks: landmarks.clone(),
                },
            };
            let told = self.push(explanation, pair, fact.depth.bits(), because);
            sofar = Some(match sofar {
                None => told,
                Some(before) => self.both(explanation, pair, before, told),
            });
        }
        sofar.unwrap_or_else(|| {
            let all = self.network.table.all();
            // A place is at itself, as far as anyone needs to be told.
            let set = if pair.0 == pair.1 { 1 } else { all };
            self.push(explanation, pair, set, Because::Unknown)
        })
    }

    fn both(&self, to: &mut Explanation, pair: (usize, usize), one: Told, two: Told) -> Told {
        let premises = [one.place, two.place];
        self.push(to, pair, one.set & two.set, Because::Both { premises })
    }

    fn push(
        &self,
        to: &mut Explanation,
        (i, j): (usize, usize),
        set: u32,
        because: Because,
    ) -> Told {
        let objects = &self.network.objects;
        let place = to.push(Step {
            statement: Statement::Distance {
                between: [objects[i].clone(), objects[j].clone()],
                depth: owned_labels(&self.network.reference, DepthSet::of_bits(set)),
            },
            because,
        });
        Told { place, set }
    }
}

/// A step of an explanation: its place in the list, and its set as bits.
#[derive(Clone, Copy)]
struct Told {
    place: usize,
    set: u32,
}
