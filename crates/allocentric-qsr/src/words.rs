use std::str::FromStr;

use crate::observer::Observer;
use crate::query::{BadQuery, Condition, Query};
use crate::{ObjectId, Orientation, OrientationSet};

/// The words of a question or a fact, taken one by one.
///
/// White space parts words, but not between double quotes: `"tall carton"` is one word.
pub(crate) struct Words<'q>(std::iter::Peekable<std::vec::IntoIter<&'q str>>);

impl<'q> Words<'q> {
    pub(crate) fn of(text: &'q str) -> Self {
        Self(split(text).into_iter().peekable())
    }

    fn next(&mut self, expected: &'static str) -> Result<&'q str, BadQuery> {
        self.0.next().ok_or(BadQuery::Word {
            found: String::new(),
            expected,
        })
    }

    pub(crate) fn expect(&mut self, word: &str, expected: &'static str) -> Result<(), BadQuery> {
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

    pub(crate) fn name(&mut self) -> Result<ObjectId, BadQuery> {
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

    pub(crate) fn list(&mut self, expected: &'static str) -> Result<Vec<String>, BadQuery> {
        let word = self.next(expected)?;
        Ok(word.split(',').map(str::to_owned).collect())
    }

    /// Orientations, joined by commas.
    pub(crate) fn labels(&mut self, expected: &'static str) -> Result<OrientationSet, BadQuery> {
        let mut labels = OrientationSet::EMPTY;
        for label in self.next(expected)?.split(',') {
            labels |= labels_of(label).ok_or_else(|| BadQuery::Word {
                found: label.to_owned(),
                expected,
            })?;
        }
        Ok(labels)
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
        let labels = self.labels("a question, `within` or an orientation")?;
        self.expect("of", "`of`")?;
        let at = self.place()?;
        Ok(Condition::Oriented(labels, at, self.seen_from()?))
    }

    pub(crate) fn end(&mut self) -> Result<(), BadQuery> {
        self.0.next().map_or(Ok(()), |found| {
            Err(BadQuery::Word {
                found: found.to_owned(),
                expected: "the end of the question",
            })
        })
    }
}

/// The words of a text; a quote that is not closed ends with the text.
fn split(mut text: &str) -> Vec<&str> {
    let mut words = Vec::new();
    loop {
        text = text.trim_start();
        if let Some(quoted) = text.strip_prefix('"') {
            let (word, rest) = quoted.split_once('"').unwrap_or((quoted, ""));
            words.push(word);
            text = rest;
        } else if text.is_empty() {
            return words;
        } else {
            let end = text.find(char::is_whitespace).unwrap_or(text.len());
            words.push(&text[..end]);
            text = &text[end..];
        }
    }
}

/// The name of an object as a word: in quotes where white space would part it.
pub(crate) fn word(name: &ObjectId) -> String {
    let name = name.as_str();
    if name.is_empty() || name.contains(char::is_whitespace) {
        format!("\"{name}\"")
    } else {
        name.to_owned()
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
