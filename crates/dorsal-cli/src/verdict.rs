use std::fmt;

use dorsal::allocentric_qsr::{Inference, Mode, QualitativeScene};
use dorsal::object_id;

use crate::demo_scene::DemoScene;
use crate::object_table::place_words;
use crate::plan::Plan;
use crate::sight::Scene;
use crate::text_table::TextTable;
use crate::true_object::TrueObject;

/// How what was seen compares with what is so.
#[derive(Debug)]
pub(crate) struct Verdict {
    name: &'static str,
    /// The table of objects, for a person.
    pub(crate) comparison: String,
    depths: Tally,
    depth_bound: String,
    egocentric: Tally,
    /// Measured relations that leave room for the true place.
    measured: Tally,
    /// Relations of the published inference that equal those inferred from the truth.
    published: Tally,
    relations_promised: bool,
}

/// So many of so many.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    right: usize,
    of: usize,
}

impl Tally {
    const fn count(&mut self, right: bool) {
        self.of += 1;
        self.right += right as usize;
    }

    const fn all(self) -> bool {
        self.right == self.of
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.right, self.of)
    }
}

impl Verdict {
    /// Compares the objects of a look with the truth of its scene, object by object and pair by
    /// pair. An object without a place has everything wrong.
    pub(crate) fn new(demo: &DemoScene, plan: &Plan, scene: &Scene) -> anyhow::Result<Self> {
        let names = &demo.objects.names;
        let truth = TrueObject::scene(&demo.truth, names, &plan.reference, plan.qualifying)?;
        let mut verdict = Self {
            name: demo.name,
            comparison: String::new(),
            depths: Tally::default(),
            depth_bound: demo.promise.depth_bound(),
            egocentric: Tally::default(),
            measured: Tally::default(),
            published: Tally::default(),
            relations_promised: demo.promise.has_relations(),
        };
        verdict.comparison = verdict.compare_objects(demo, scene, &truth);
        verdict.compare_relations(scene, &truth);
        Ok(verdict)
    }

    fn compare_objects(
        &mut self,
        demo: &DemoScene,
        scene: &Scene,
        truth: &QualitativeScene,
    ) -> String {
        let mut table = TextTable::new([
            "object",
            ">depth m",
            ">true m",
            ">error cm",
            ">%",
            "",
            "for the observer",
            "truly",
            "",
        ]);
        for object in &demo.truth {
            let name = object_id(object.label, &demo.objects.names);
            let reference = truth.reference();
            let words = |scene: &QualitativeScene| {
                let place = scene.place(&name).map(|place| place.read);
                place.map_or_else(
                    || "no place".to_owned(),
                    |place| place_words(place, reference),
                )
            };
            let (place, true_place) = (words(&scene.qualitative), words(truth));
            let same_place = place == true_place;
            self.egocentric.count(same_place);

            let depth_m = scene
                .egocentric
                .object(object.label)
                .map(|seen| seen.depth_m);
            // An object without a place is as far off as can be.
            let kept = demo
                .promise
                .keeps(depth_m.unwrap_or(f64::INFINITY), object.depth_m);
            if let Some(kept) = kept {
                self.depths.count(kept);
            }
            let number = |value: Option<f64>, decimals: usize| {
                value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
            };
            let signed = |value: Option<f64>| {
                value.map_or_else(|| "-".to_owned(), |value| format!("{value:+.2}"))
            };
            let error_m = depth_m.map(|depth_m| depth_m - object.depth_m);
            table.line([
                name.to_string(),
                number(depth_m, 3),
                format!("{:.3}", object.depth_m),
                signed(error_m.map(|error_m| 100.0 * error_m)),
                signed(error_m.map(|error_m| 100.0 * error_m / object.depth_m)),
                kept.map_or(" ", tick).to_owned(),
                place,
                true_place,
                tick(same_place).to_owned(),
            ]);
        }
        table.to_string()
    }

    fn compare_relations(&mut self, scene: &Scene, truth: &QualitativeScene) {
        let true_published = Inference::of_scene(truth, Mode::Published);
        for relation in truth.relations() {
            let (from, to) = (&relation.from, &relation.to);
            let measured = scene.qualitative.relation(from, to);
            self.measured.count(
                measured
                    .zip(relation.read)
                    .is_some_and(|(measured, place)| measured.places.contains(place)),
            );
            let places = |inference: &Inference| {
                let relation = inference.relation(from, to);
                relation.map(|relation| relation.places)
            };
            self.published
                .count(places(&scene.published) == places(&true_published));
        }
    }

    /// Whether everything that is promised holds.
    pub(crate) const fn holds(&self) -> bool {
        let relations = self.egocentric.all() && self.published.all();
        self.depths.all() && (relations || !self.relations_promised)
    }
}

impl fmt::Display for Verdict {
    /// One line: how many of each hold.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} {}: {} depths {}, {} egocentric relations right, {} published relations as from \
             the truth, {} measured relations leave room for the true place",
            tick(self.holds()),
            self.name,
            self.depths,
            self.depth_bound,
            self.egocentric,
            self.published,
            self.measured,
        )
    }
}

const fn tick(right: bool) -> &'static str {
    if right { "✓" } else { "✗" }
}
