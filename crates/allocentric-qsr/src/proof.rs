use std::collections::BTreeMap;

use crate::constraint_network::FactSource;
use crate::double_cross_set::DoubleCrossSet;
use crate::explanation::{Because, Explanation, Statement, Step};
use crate::place::owned_labels;
use crate::{DepthReference, DepthSet, ObjectId, Rule};

/// Two places, the smaller first.
pub(crate) type Pair = (usize, usize);

/// Three places b, c and d, of which b is the smaller of the first two.
pub(crate) type Triple = (usize, usize, usize);

/// What a closure has derived, line by line, each with the lines it follows from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Proof {
    lines: Vec<Line>,
    /// The line that says what a pair is now, and a triple.
    of_pair: BTreeMap<Pair, usize>,
    of_triple: BTreeMap<Triple, usize>,
}

#[derive(Clone, Debug)]
struct Line {
    claim: Claim,
    ground: Ground,
}

/// What a line says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Claim {
    Distance(Pair, DepthSet),
    Direction(Triple, DoubleCrossSet),
}

/// Why a line says it; premises are places of earlier lines.
#[derive(Clone, Debug)]
pub(crate) enum Ground {
    Unknown,
    /// It was told or measured; `turned` if of a direction from the larger place to the smaller.
    Fact {
        source: FactSource,
        turned: bool,
    },
    Composed(usize, [usize; 2]),
    Directed(Rule, Vec<usize>),
    Both([usize; 2]),
}

impl Proof {
    /// The line that says what a pair may be, now that it may be this.
    pub(crate) fn distance(&mut self, pair: Pair, now: DepthSet) -> usize {
        if let Some(&line) = self.of_pair.get(&pair) {
            return line;
        }
        self.push(Claim::Distance(pair, now), Ground::Unknown)
    }

    /// The line that says what a triple may be, now that it may be this.
    pub(crate) fn direction(&mut self, triple: Triple, now: DoubleCrossSet) -> usize {
        if let Some(&line) = self.of_triple.get(&triple) {
            return line;
        }
        self.push(Claim::Direction(triple, now), Ground::Unknown)
    }

    /// Writes down what follows, and that it holds together with what was known: `before`, which
    /// `after` is the part of that is left.
    pub(crate) fn narrow(&mut self, derived: Claim, ground: Ground, before: Claim, after: Claim) {
        let known = match before {
            Claim::Distance(pair, set) => self.distance(pair, set),
            Claim::Direction(triple, rows) => self.direction(triple, rows),
        };
        let line = self.push(derived, ground);
        if derived != after {
            self.push(after, Ground::Both([known, line]));
        }
    }

    fn push(&mut self, claim: Claim, ground: Ground) -> usize {
        let place = self.lines.len();
        match claim {
            Claim::Distance(pair, _) => self.of_pair.insert(pair, place),
            Claim::Direction(triple, _) => self.of_triple.insert(triple, place),
        };
        self.lines.push(Line { claim, ground });
        place
    }

    /// The part of the proof that ends in the last line, or in what is known of a pair or a triple.
    pub(crate) fn tell(
        &self,
        end: Option<usize>,
        objects: &[ObjectId],
        reference: &DepthReference,
    ) -> Explanation {
        let end = end.unwrap_or(self.lines.len().saturating_sub(1));
        let mut needed = vec![false; end + 1];
        if let Some(last) = needed.last_mut() {
            *last = true;
        }
        for at in (0..=end).rev().filter(|&at| at < self.lines.len()) {
            if needed[at] {
                for &premise in self.lines[at].ground.premises() {
                    needed[premise] = true;
                }
            }
        }
        let mut place_of = BTreeMap::new();
        let mut explanation = Explanation { steps: Vec::new() };
        for (at, line) in self.lines.iter().enumerate().take(end + 1) {
            if !needed[at] {
                continue;
            }
            let premise = |at: &usize| place_of.get(at).copied().unwrap_or(0);
            let because = match &line.ground {
                Ground::Unknown => Because::Unknown,
                Ground::Fact { source, .. } => match source {
                    FactSource::Told(fact) => Because::Told { fact: fact.clone() },
                    FactSource::Measured(looks) => Because::Measured { looks: *looks },
                    FactSource::Joined { looks, landmarks } => Because::Joined {
                        looks: *looks,
                        landmarks: landmarks.clone(),
                    },
                },
                Ground::Composed(through, premises) => Because::Composed {
                    through: objects[*through].clone(),
                    premises: premises.each_ref().map(premise),
                },
                Ground::Directed(rule, premises) => Because::Directed {
                    rule: *rule,
                    premises: premises.iter().map(premise).collect(),
                },
                Ground::Both(premises) => Because::Both {
                    premises: premises.each_ref().map(premise),
                },
            };
            let statement = match line.claim {
                Claim::Distance((i, j), set) => Statement::Distance {
                    between: [objects[i].clone(), objects[j].clone()],
                    depth: owned_labels(reference, set),
                },
                Claim::Direction((b, c, d), rows) => {
                    // A told direction stands as it was told.
                    let turned = matches!(line.ground, Ground::Fact { turned: true, .. });
                    let (b, c, rows) = if turned {
                        (c, b, rows.swapped())
                    } else {
                        (b, c, rows)
                    };
                    Statement::Direction {
                        observer: objects[b].clone(),
                        reference: objects[c].clone(),
                        object: objects[d].clone(),
                        at_reference: rows.at_c(),
                        at_observer: rows.at_b(),
                    }
                }
            };
            place_of.insert(at, explanation.push(Step { statement, because }));
        }
        explanation
    }

    /// The line of what is known of a pair.
    pub(crate) fn line_of_pair(&self, pair: Pair) -> Option<usize> {
        self.of_pair.get(&pair).copied()
    }

    /// The line of what is known of a triple.
    pub(crate) fn line_of_triple(&self, triple: Triple) -> Option<usize> {
        self.of_triple.get(&triple).copied()
    }
}

impl Ground {
    fn premises(&self) -> &[usize] {
        match self {
            Self::Unknown | Self::Fact { .. } => &[],
            Self::Composed(_, premises) | Self::Both(premises) => premises,
            Self::Directed(_, premises) => premises,
        }
    }
}
