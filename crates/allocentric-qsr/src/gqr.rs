//! Our distance calculus and its networks in the text form of the constraint solver GQR, so that
//! anyone can compare closures.
//!
//! GQR wants an identity relation. Distance zero becomes a base relation of its own, `=`, and the
//! first class is what is left of it; a set that contains the first class contains both.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::constraint_network::{ConstraintNetwork, DistanceFact};
use crate::depth_reference::DepthReference;
use crate::{BaseRelation, Case, Depth, DepthSet, Mode, ObjectId, compose};

/// The identity of the exported calculus.
const IDENTITY: &str = "=";

/// The sound calculus of a reference system as GQR's three files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GqrCalculus {
    /// `NAME.spec`, which names the two others as `NAME.comp` and `NAME.conv`.
    pub spec: String,
    /// `NAME.comp`, the composition of every two base relations.
    pub composition: String,
    /// `NAME.conv`, the converse of every base relation: itself.
    pub converse: String,
}

impl GqrCalculus {
    /// The files of this reference system.
    #[must_use]
    pub fn of(reference: &DepthReference) -> Self {
        let name = reference.name();
        let labels = labels(reference);
        let relations = || (0..=labels.len()).map(|at| base(&labels, at));
        let spec = format!(
            "# Distance classes of {name}, composed by the triangle inequality\n\
             comp_table_file {name}.comp\nconverse_file {name}.conv\nidentity {IDENTITY}\n\
             calculus_size {}\n",
            labels.len() + 1
        );
        let mut converse = String::new();
        for relation in relations() {
            line(&mut converse, format_args!("{relation} :: {relation}"));
        }
        let mut composition = String::new();
        for (i, first) in relations().enumerate() {
            for (j, second) in relations().enumerate() {
                let sum = match (i.checked_sub(1), j.checked_sub(1)) {
                    (None, _) => second.to_owned(),
                    (_, None) => first.to_owned(),
                    (Some(i), Some(j)) => {
                        let [a, b] = [i, j].map(|class| DepthSet::from(Depth::of_index(class)));
                        let sum = compose(reference, Case::One, Mode::Sound, a, b).depth;
                        let classes = sum.iter().map(|class| labels[class.index()].as_str());
                        // Two distances end in one point where they can be equal.
                        let same = (i == j).then_some(IDENTITY);
                        same.into_iter()
                            .chain(classes)
                            .collect::<Vec<_>>()
                            .join(" ")
                    }
                };
                line(
                    &mut composition,
                    format_args!("{first} : {second} :: ( {sum} )"),
                );
            }
        }
        Self {
            spec,
            composition,
            converse,
        }
    }
}

impl ConstraintNetwork {
    /// The facts as a network in GQR's text form, one line for each, the objects as numbers in
    /// the order of their names.
    #[must_use]
    pub fn to_gqr(&self) -> String {
        network(self.reference(), self.objects(), self.facts())
    }
}

impl GqrCalculus {
    /// Facts as a network in GQR's text form, whether they can hold together or not: their objects
    /// are numbers in the order of the names.
    #[must_use]
    pub fn network(reference: &DepthReference, facts: &[DistanceFact]) -> String {
        let ends = facts.iter().flat_map(|fact| fact.between.iter().cloned());
        let objects: BTreeSet<ObjectId> = ends.collect();
        network(reference, &Vec::from_iter(objects), facts)
    }
}

/// A line for every fact, after one with the last object and the name.
fn network(reference: &DepthReference, objects: &[ObjectId], facts: &[DistanceFact]) -> String {
    let labels = labels(reference);
    let mut text = String::new();
    let last = objects.len().saturating_sub(1);
    line(
        &mut text,
        format_args!("{last} # {} distances", reference.name()),
    );
    for fact in facts {
        // Every fact is of two of the objects.
        let [from, to] = [0, 1].map(|end| objects.binary_search(&fact.between[end]).unwrap_or(0));
        let first = fact.depth.contains(Depth::FIRST).then_some(IDENTITY);
        let classes = fact
            .depth
            .iter()
            .map(|class| labels[class.index()].as_str());
        let set: Vec<&str> = first.into_iter().chain(classes).collect();
        line(&mut text, format_args!("{from} {to} ( {} )", set.join(" ")));
    }
    text + ".\n"
}

/// The labels of the classes; numbered ones if a label has a meaning in GQR's files.
fn labels(reference: &DepthReference) -> Vec<String> {
    let classes = reference.classes();
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if classes.iter().all(|class| class.short.chars().all(plain)) {
        classes.iter().map(|class| class.short.clone()).collect()
    } else {
        (0..classes.len()).map(|k| format!("k{k}")).collect()
    }
}

fn base(labels: &[String], at: usize) -> &str {
    at.checked_sub(1).map_or(IDENTITY, |class| &labels[class])
}

fn line(text: &mut String, words: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{words}");
}
