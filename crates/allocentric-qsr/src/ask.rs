use crate::answer::Answer;
use crate::certainty::Certainty;
use crate::observer::Observer;
use crate::query::{Condition, Query};
use crate::scene_memory::SceneMemory;
use crate::{DepthSet, ObjectId};

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

impl SceneMemory {
    /// Answers a question.
    ///
    /// # Errors
    /// [`Unanswerable`] names what the memory does not know.
    pub fn ask(&self, query: &Query) -> Result<Answer, Unanswerable> {
        let unknown = |object: &ObjectId| Unanswerable::Object(object.clone());
        let pair = |a: &ObjectId, b: &ObjectId| {
            let lost = [a, b].into_iter().find(|name| self.here(name).is_none());
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
                        Observer::Object(name) if !self.is_here(end) => Some(name),
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
