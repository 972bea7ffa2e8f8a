use std::fmt;
use std::str::FromStr;

use serde::Serialize;

use crate::certainty::Certainty;
use crate::scene_memory::{Observer, SceneMemory, ToldFact};
use crate::{
    DepthSet, Explanation, FreePath, Life, ObjectId, Orientation, OrientationSet, RelationRecord,
};

/// A question in words.
///
/// | words | asks |
/// |---|---|
/// | `relation A from B [seen from C]` | where A is at B |
/// | `within CLASSES of X [and CONDITION]..` | which objects are at such a distance from X |
/// | `LABELS of X [seen from C] [and CONDITION]..` | which objects bear such a label at X |
/// | `between A and B` | which objects lie between A and B |
/// | `reachable A [within METRES] [radius METRES]` | whether an arm of 1 m gets to A |
/// | `free_path from A to B [radius METRES]` | whether the straight way is free |
/// | `last_seen A` | when A was seen last |
/// | `where A` | where A is for the robot |
/// | `explain A from B` | why the distance of A from B is what it is |
///
/// Names and classes are single words; `robot` is the robot. CLASSES and LABELS are joined by
/// commas. Of the labels, `front`, `back`, `left` and `right` are half the plane each with its two
/// quadrants and the ray between (`right` is `fr,r,br`); the nine names and short labels of
/// [`Orientation`] are themselves, so an exact ray is asked for as `sf`, `l`, `r` or `sb`. Labels
/// at an object are seen from the robot unless said otherwise.
///
/// A query reads and writes the same: `parse` of `to_string` is the query.
#[derive(Clone, Debug, PartialEq)]
pub enum Query {
    /// `relation A from B seen from C`.
    Relation {
        /// What is placed.
        of: ObjectId,
        /// Where it is told from.
        from: ObjectId,
        /// Who looks.
        seen_from: Observer,
    },
    /// All conditions together.
    Which(Vec<Condition>),
    /// `between A and B`.
    Between(ObjectId, ObjectId),
    /// `reachable A within M radius M`.
    Reachable {
        /// What is reached for.
        object: ObjectId,
        /// How far the arm reaches, in metres.
        reach_m: f64,
        /// The radius of what moves, in metres.
        radius_m: f64,
    },
    /// `free_path from A to B radius M`.
    FreePath {
        /// Where the way begins.
        from: Observer,
        /// Where it ends.
        to: Observer,
        /// The radius of what moves, in metres.
        radius_m: f64,
    },
    /// `last_seen A`.
    LastSeen(ObjectId),
    /// `where A`.
    Where(ObjectId),
    /// `explain A from B`.
    Explain(ObjectId, ObjectId),
}

/// One thing asked of an object.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// `within vc,c of X`: the class labels as written, and the centre.
    Within(Vec<String>, Observer),
    /// `fr,r,br of X seen from C`.
    Oriented(OrientationSet, Observer, Observer),
}

/// Words that are no query.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadQuery {
    /// There are no words.
    #[error("an empty question; ask for example `relation pc_screen from cd_box seen from robot`")]
    Empty,
    /// A word is missing or another stands in its place.
    #[error("`{found}` where {expected} should stand")]
    Word {
        /// What stands there; empty at the end.
        found: String,
        /// What should.
        expected: &'static str,
    },
}

/// A question the memory cannot answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unanswerable {
    /// An object is unknown, gone, or in another map frame.
    #[error("the memory does not know where `{0}` is")]
    Object(ObjectId),
    /// A distance class is none of the reference system.
    #[error("`{label}` is no distance class of `{system}`")]
    Class {
        /// The label asked for.
        label: String,
        /// The name of the reference system.
        system: String,
    },
}

/// An answer; as data an object with `"answer"` and what belongs to it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// Where one object is at another.
    Relation(RelationRecord),
    /// Objects, by name, those that certainly answer and those that possibly do.
    Objects {
        /// Certainly.
        certain: Vec<ObjectId>,
        /// Possibly, beside those.
        possible: Vec<ObjectId>,
    },
    /// Whether an arm gets there.
    Reachable {
        /// Whether it is near enough.
        reach: Certainty,
        /// What is on the way.
        way: FreePath,
    },
    /// What is on the way.
    FreePath(FreePath),
    /// When an object was seen last.
    LastSeen {
        /// The look, counted from 1.
        look: u64,
        /// Its time, in milliseconds.
        time_ms: u64,
        /// Where in its life the object is.
        life: Life,
    },
    /// Where an object is for the robot.
    Where {
        /// To the right, in metres.
        right_m: f64,
        /// Ahead, in metres.
        forward_m: f64,
        /// The covariance of the two, in square metres.
        covariance_m2: [[f64; 2]; 2],
    },
    /// Why.
    Explain(Explanation),
}

impl SceneMemory {
    /// Answers a question.
    ///
    /// # Errors
    /// [`Unanswerable`] names what the memory does not know.
    pub fn ask(&self, query: &Query) -> Result<Answer, Unanswerable> {
        let unknown = |object: &ObjectId| Unanswerable::Object(object.clone());
        let pair = |a: &ObjectId, b: &ObjectId| {
            let lost = [a, b]
                .into_iter()
                .find(|name| self.estimate(name).is_none());
            Unanswerable::Object(lost.unwrap_or(a).clone())
        };
        match query {
            Query::Relation {
                of,
                from,
                seen_from,
            } => {
                let relation = self
                    .relation(from, of, seen_from)
                    .ok_or_else(|| pair(from, of))?;
                Ok(Answer::Relation(relation.record(&self.reference)))
            }
            Query::Which(conditions) => self.which_all(conditions),
            Query::Between(a, b) => {
                let found = self.between(a, b).ok_or_else(|| pair(a, b))?;
                Ok(Answer::of_objects(found))
            }
            Query::Reachable {
                object,
                reach_m,
                radius_m,
            } => {
                let reached = self.reachable(object, *reach_m, *radius_m);
                let (reach, way) = reached.ok_or_else(|| unknown(object))?;
                Ok(Answer::Reachable { reach, way })
            }
            Query::FreePath { from, to, radius_m } => {
                let lost = || {
                    let ends = [from, to].into_iter().find_map(|end| match end {
                        Observer::Object(name) if self.estimate(name).is_none() => Some(name),
                        _ => None,
                    });
                    ends.map_or_else(|| Unanswerable::Object("robot".into()), unknown)
                };
                let path = self.free_path(from, to, *radius_m).ok_or_else(lost)?;
                Ok(Answer::FreePath(path))
            }
            Query::LastSeen(object) => {
                let kept = self.object(object).ok_or_else(|| unknown(object))?;
                Ok(Answer::LastSeen {
                    look: kept.last_look,
                    time_ms: kept.last_time_ms,
                    life: kept.life,
                })
            }
            Query::Where(object) => {
                let place = self.from_robot(object).ok_or_else(|| unknown(object))?;
                Ok(Answer::Where {
                    right_m: place.right_m,
                    forward_m: place.forward_m,
                    covariance_m2: place.covariance_m2,
                })
            }
            Query::Explain(of, from) => {
                let explanation = self.explain(from, of).ok_or_else(|| pair(from, of))?;
                Ok(Answer::Explain(explanation))
            }
        }
    }

    /// Reads a fact in words: `A within CLASSES of B`.
    ///
    /// # Errors
    /// [`BadQuery`] for words of another form, [`BadQuery::Word`] for a class that is none.
    pub fn read_fact(&self, words: &str) -> Result<ToldFact, BadQuery> {
        let mut words = Words::of(words);
        let of = words.name()?;
        words.expect("within", "`within`")?;
        let classes = words.list("distance classes")?;
        words.expect("of", "`of`")?;
        let from = words.name()?;
        words.end()?;
        let classes = classes.iter().map(|label| {
            self.reference
                .class_named(label)
                .ok_or_else(|| BadQuery::Word {
                    found: label.clone(),
                    expected: "a distance class",
                })
        });
        Ok(ToldFact {
            between: [from, of],
            depth: classes.collect::<Result<DepthSet, BadQuery>>()?,
        })
    }

    fn which_all(&self, conditions: &[Condition]) -> Result<Answer, Unanswerable> {
        for condition in conditions {
            let (Condition::Within(_, place) | Condition::Oriented(_, place, _)) = condition;
            if let Observer::Object(name) = place
                && !self.living().any(|known| known == name)
            {
                return Err(Unanswerable::Object(name.clone()));
            }
        }
        let classes = |labels: &[String]| -> Result<DepthSet, Unanswerable> {
            let class = |label: &String| {
                self.reference
                    .class_named(label)
                    .ok_or_else(|| Unanswerable::Class {
                        label: label.clone(),
                        system: self.reference.name().to_owned(),
                    })
            };
            labels.iter().map(class).collect()
        };
        let mut asked = Vec::new();
        for condition in conditions {
            asked.push(match condition {
                Condition::Within(labels, _) => classes(labels)?,
                Condition::Oriented(..) => DepthSet::EMPTY,
            });
        }
        let sure = |object: &ObjectId| {
            let each = conditions
                .iter()
                .zip(&asked)
                .map(|(condition, &classes)| match condition {
                    Condition::Within(_, centre) => self.is_within(object, classes, centre),
                    Condition::Oriented(labels, at, from) => {
                        self.is_oriented(object, *labels, at, from)
                    }
                });
            each.collect::<Option<Vec<Certainty>>>()?.into_iter().min()
        };
        Ok(Answer::of_objects(self.which(sure)))
    }
}

impl Answer {
    fn of_objects(found: Vec<(ObjectId, Certainty)>) -> Self {
        let (certain, possible): (Vec<_>, Vec<_>) = found
            .into_iter()
            .partition(|(_, sure)| *sure == Certainty::Certain);
        let names = |found: Vec<(ObjectId, Certainty)>| found.into_iter().map(|f| f.0).collect();
        Self::Objects {
            certain: names(certain),
            possible: names(possible),
        }
    }
}

/// The words of a question, taken one by one.
struct Words<'q>(std::iter::Peekable<std::str::SplitWhitespace<'q>>);

impl<'q> Words<'q> {
    fn of(text: &'q str) -> Self {
        Self(text.split_whitespace().peekable())
    }

    fn next(&mut self, expected: &'static str) -> Result<&'q str, BadQuery> {
        self.0.next().ok_or(BadQuery::Word {
            found: String::new(),
            expected,
        })
    }

    fn expect(&mut self, word: &str, expected: &'static str) -> Result<(), BadQuery> {
        let found = self.next(expected)?;
        if found == word {
            Ok(())
        } else {
            Err(BadQuery::Word {
                found: found.to_owned(),
                expected,
            })
        }
    }

    fn takes(&mut self, word: &str) -> bool {
        self.0.next_if_eq(&word).is_some()
    }

    fn name(&mut self) -> Result<ObjectId, BadQuery> {
        match self.next("the name of an object")? {
            "robot" => Err(BadQuery::Word {
                found: "robot".to_owned(),
                expected: "the name of an object",
            }),
            name => Ok(name.into()),
        }
    }

    fn place(&mut self) -> Result<Observer, BadQuery> {
        Ok(match self.next("an object or `robot`")? {
            "robot" => Observer::Robot,
            name => Observer::Object(name.into()),
        })
    }

    fn list(&mut self, expected: &'static str) -> Result<Vec<String>, BadQuery> {
        let word = self.next(expected)?;
        Ok(word.split(',').map(str::to_owned).collect())
    }

    fn metres(&mut self, word: &str, otherwise: f64) -> Result<f64, BadQuery> {
        if !self.takes(word) {
            return Ok(otherwise);
        }
        let expected = "a distance in metres";
        let found = self.next(expected)?;
        let number: Option<f64> = found.parse().ok();
        let fits = |m: &f64| (0.0..=1e6).contains(m);
        number.filter(fits).ok_or_else(|| BadQuery::Word {
            found: found.to_owned(),
            expected,
        })
    }

    fn seen_from(&mut self) -> Result<Observer, BadQuery> {
        if !self.takes("seen") {
            return Ok(Observer::Robot);
        }
        self.expect("from", "`from`")?;
        self.place()
    }

    fn condition(&mut self) -> Result<Condition, BadQuery> {
        if self.takes("within") {
            let classes = self.list("distance classes")?;
            self.expect("of", "`of`")?;
            return Ok(Condition::Within(classes, self.place()?));
        }
        let expected = "a question, `within` or an orientation";
        let word = self.next(expected)?;
        let mut labels = OrientationSet::EMPTY;
        for label in word.split(',') {
            labels |= labels_of(label).ok_or_else(|| BadQuery::Word {
                found: label.to_owned(),
                expected,
            })?;
        }
        self.expect("of", "`of`")?;
        let at = self.place()?;
        Ok(Condition::Oriented(labels, at, self.seen_from()?))
    }

    fn end(&mut self) -> Result<(), BadQuery> {
        self.0.next().map_or(Ok(()), |found| {
            Err(BadQuery::Word {
                found: found.to_owned(),
                expected: "the end of the question",
            })
        })
    }
}

/// The orientations a word stands for: half the plane, or one label.
fn labels_of(word: &str) -> Option<OrientationSet> {
    use Orientation::{BackLeft, BackRight, FrontLeft, FrontRight};
    use Orientation::{Left, Right, StraightBack, StraightFront};
    Some(match word {
        "front" => OrientationSet::from_iter([FrontLeft, StraightFront, FrontRight]),
        "back" => OrientationSet::from_iter([BackLeft, StraightBack, BackRight]),
        "left" => OrientationSet::from_iter([FrontLeft, Left, BackLeft]),
        "right" => OrientationSet::from_iter([FrontRight, Right, BackRight]),
        _ => Orientation::named(word)?.into(),
    })
}

impl FromStr for Query {
    type Err = BadQuery;

    fn from_str(text: &str) -> Result<Self, BadQuery> {
        let mut words = Words::of(text);
        let Some(&first) = words.0.peek() else {
            return Err(BadQuery::Empty);
        };
        let query = match first {
            "relation" | "explain" | "between" | "reachable" | "free_path" | "last_seen"
            | "where" => {
                words.0.next();
                asked(first, &mut words)?
            }
            _ => {
                let mut conditions = vec![words.condition()?];
                while words.takes("and") {
                    conditions.push(words.condition()?);
                }
                Self::Which(conditions)
            }
        };
        words.end()?;
        Ok(query)
    }
}

/// The rest of a question that begins with its own word.
fn asked(first: &str, words: &mut Words<'_>) -> Result<Query, BadQuery> {
    Ok(match first {
        "relation" => {
            let of = words.name()?;
            words.expect("from", "`from`")?;
            Query::Relation {
                of,
                from: words.name()?,
                seen_from: words.seen_from()?,
            }
        }
        "explain" => {
            let of = words.name()?;
            words.expect("from", "`from`")?;
            Query::Explain(of, words.name()?)
        }
        "between" => {
            let one = words.name()?;
            words.expect("and", "`and`")?;
            Query::Between(one, words.name()?)
        }
        "reachable" => Query::Reachable {
            object: words.name()?,
            reach_m: words.metres("within", 1.0)?,
            radius_m: words.metres("radius", 0.05)?,
        },
        "free_path" => {
            words.expect("from", "`from`")?;
            let from = words.place()?;
            words.expect("to", "`to`")?;
            Query::FreePath {
                from,
                to: words.place()?,
                radius_m: words.metres("radius", 0.05)?,
            }
        }
        "last_seen" => Query::LastSeen(words.name()?),
        _ => Query::Where(words.name()?),
    })
}

impl fmt::Display for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Relation {
                of,
                from,
                seen_from,
            } => {
                write!(
                    f,
                    "relation {of} from {from} seen from {}",
                    place(seen_from)
                )
            }
            Self::Which(conditions) => {
                for (at, condition) in conditions.iter().enumerate() {
                    let and = if at > 0 { " and " } else { "" };
                    match condition {
                        Condition::Within(classes, centre) => {
                            write!(f, "{and}within {} of {}", classes.join(","), place(centre))?;
                        }
                        Condition::Oriented(labels, at, from) => {
                            let labels = labels.labels().join(",");
                            let (at, from) = (place(at), place(from));
                            write!(f, "{and}{labels} of {at} seen from {from}")?;
                        }
                    }
                }
                Ok(())
            }
            Self::Between(a, b) => write!(f, "between {a} and {b}"),
            Self::Reachable {
                object,
                reach_m,
                radius_m,
            } => {
                write!(f, "reachable {object} within {reach_m} radius {radius_m}")
            }
            Self::FreePath { from, to, radius_m } => {
                let (from, to) = (place(from), place(to));
                write!(f, "free_path from {from} to {to} radius {radius_m}")
            }
            Self::LastSeen(object) => write!(f, "last_seen {object}"),
            Self::Where(object) => write!(f, "where {object}"),
            Self::Explain(of, from) => write!(f, "explain {of} from {from}"),
        }
    }
}

/// A place in words. A pose has none of its own in the language, where the robot is meant.
fn place(at: &Observer) -> &str {
    match at {
        Observer::Object(object) => object.as_str(),
        Observer::Robot | Observer::At(_) => "robot",
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |names: &[ObjectId]| {
            let names: Vec<&str> = names.iter().map(ObjectId::as_str).collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        match self {
            Self::Relation(relation) => {
                write!(
                    f,
                    "{} at {}: {{{}}}, {{{}}}",
                    relation.to,
                    relation.from,
                    relation.depth.join(", "),
                    relation.orientation.labels().join(", ")
                )?;
                if let Some(read) = &relation.read {
                    write!(f, "; read {} {}", read.depth, read.orientation.short())?;
                }
                Ok(())
            }
            Self::Objects { certain, possible } => {
                write!(
                    f,
                    "certainly {}; possibly {}",
                    list(certain),
                    list(possible)
                )
            }
            Self::Reachable { reach, way } => write!(f, "in reach: {reach}; the way: {way}"),
            Self::FreePath(path) => write!(f, "{path}"),
            Self::LastSeen {
                look,
                time_ms,
                life,
            } => {
                write!(f, "in look {look}, at {time_ms} ms; now {life}")
            }
            Self::Where {
                right_m,
                forward_m,
                covariance_m2: [[rr, _], [_, ff]],
            } => write!(
                f,
                "{right_m:.3} m to the right (sigma {:.3}), {forward_m:.3} m ahead (sigma {:.3})",
                rr.sqrt(),
                ff.sqrt()
            ),
            Self::Explain(explanation) => write!(f, "{explanation}"),
        }
    }
}

impl fmt::Display for FreePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Clear => f.write_str("clear"),
            Self::Blocked { by } => {
                let names: Vec<&str> = by.iter().map(ObjectId::as_str).collect();
                write!(f, "blocked by {}", names.join(", "))
            }
            Self::Unknown { at_m: [x, z] } => write!(f, "never seen free at ({x:.2}, {z:.2}) m"),
        }
    }
}
