use std::fmt::Write;

use anyhow::Context;
use disparity_pyramid::{Validity, estimate};
use ndarray::Array2;
use serde::Serialize;
use stereo_formats::file_sign;
use stereo_formats::scene_folder::StereoScene;
use v1_gabor::{FilterBank, GaborParams};

use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::pyramid_ablation::ablations;

/// The vector pyramid with each of its ingredients off in turn, scene by scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AblationRun {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    /// The machine.
    pub(crate) machine: Machine,
    /// One entry a scene.
    pub(crate) scenes: Vec<AblatedScene>,
}

/// One scene, in the order of [`ablations`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AblatedScene {
    /// Name of the scene.
    pub(crate) scene: String,
    /// One row for each thing left out.
    pub(crate) rows: Vec<AblationRow>,
}

/// The errors without one ingredient.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AblationRow {
    /// What is left out.
    pub(crate) without: &'static str,
    /// Valid pixels, visible.
    pub(crate) valid: Option<Metrics>,
    /// Valid pixels, textured.
    pub(crate) textured: Option<Metrics>,
    /// The best guess everywhere, visible.
    pub(crate) dense: Option<Metrics>,
    /// Mean length of the vertical shift of valid visible pixels, px: the truth is 0.
    pub(crate) vertical_px: Option<f64>,
}

/// A measure of a row, with the name that its column has.
type Measure = (&'static str, fn(&AblationRow) -> Option<f64>);

const MEASURES: [Measure; 7] = [
    ("valid: mean", |row| Some(row.valid?.mean_absolute)),
    ("bad-1 %", |row| Some(row.valid?.bad.one)),
    ("density %", |row| Some(100.0 * row.valid?.density)),
    ("textured: mean", |row| Some(row.textured?.mean_absolute)),
    ("dense: mean", |row| Some(row.dense?.mean_absolute)),
    ("bad-1 %", |row| Some(row.dense?.bad.one)),
    ("dy, px", |row| row.vertical_px),
];

impl AblatedScene {
    /// Matches one scene with each ingredient off in turn.
    pub(crate) fn of(scene: &StereoScene, truth: &Array2<f32>) -> anyhow::Result<Self> {
        let pair = scene.pair()?;
        let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
        let size = pair.left.size();
        let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)
            .context("level 1 has no bank for these images")?;
        let responses = pair.as_ref().try_map(|eye| bank.respond(eye.luma()))?;
        let row = |ablation: crate::pyramid_ablation::Ablation| {
            let field = estimate(&responses, ablation.params)?;
            let (valid, dense) = (
                file_sign::d_of_field(&field, false),
                file_sign::d_of_field(&field, true),
            );
            let over = |d: &Array2<f32>, mask: &Array2<bool>| {
                Metrics::of(d.view(), truth.view(), mask.view())
            };
            let seen = masks.estimated(&field.validity().mapv(Validity::is_valid));
            let level = Array2::zeros(truth.dim());
            let vertical = Metrics::of(field.dy(), level.view(), seen.view());
            anyhow::Ok(AblationRow {
                without: ablation.without,
                valid: over(&valid, &masks.visible),
                textured: over(&valid, &masks.textured),
                dense: over(&dense, &masks.visible),
                vertical_px: vertical.map(|metrics| metrics.mean_absolute),
            })
        };
        let rows: anyhow::Result<Vec<AblationRow>> = ablations().into_iter().map(row).collect();
        Ok(Self {
            scene: scene.description.name.clone(),
            rows: rows?,
        })
    }
}

impl AblationRun {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-ablation/1";

    /// Means over the scenes, a row for each thing left out.
    pub(crate) fn table(&self) -> MarkdownTable {
        let names = MEASURES.map(|(name, _)| name.to_owned());
        let mut table = MarkdownTable::with_head(["without".to_owned()].into_iter().chain(names));
        for (place, ablation) in ablations().iter().enumerate() {
            let cells = MEASURES.map(|(_, measure)| {
                let found = self.scenes.iter().map(|scene| measure(&scene.rows[place]));
                let found: Option<Vec<f64>> = found.collect();
                found.filter(|found| !found.is_empty()).map_or_else(
                    || "-".to_owned(),
                    |found| format!("{:.3}", found.iter().sum::<f64>() / found.len() as f64),
                )
            });
            table.push([ablation.without.to_owned()].into_iter().chain(cells));
        }
        table
    }

    /// One measure scene by scene.
    fn by_scene(&self, measure: fn(&AblationRow) -> Option<f64>) -> MarkdownTable {
        let names = self.scenes.iter().map(|scene| scene.scene.clone());
        let mut table = MarkdownTable::with_head(["without".to_owned()].into_iter().chain(names));
        for (place, ablation) in ablations().iter().enumerate() {
            let cells = self.scenes.iter().map(|scene| {
                let found = measure(&scene.rows[place]);
                found.map_or_else(|| "-".to_owned(), |found| format!("{found:.3}"))
            });
            table.push([ablation.without.to_owned()].into_iter().chain(cells));
        }
        table
    }

    /// The page `docs/ablation.md`.
    pub(crate) fn page(&self) -> String {
        let machine = &self.machine;
        let mut page = format!(
            "# What each ingredient of the vector pyramid is worth\n\n\
             Written by `cargo xtask eval-middlebury --ablate`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} core{}\n- compiler: {}, {} build\n\n\
             The default parameters with one ingredient off in turn, over {} scenes; the last rows \
             have what neither the default nor the paper has: a test for phase singularities (tau \
             1.75), the vertical shift held at 0, the left eye's filters stretched along the slopes, or \
             one warp on the way back in place of two. Masks and \
             measures are those of [results.md](results.md); dy is the mean absolute vertical shift \
             over valid visible pixels of rectified pairs, whose truth is 0.\n\n\
             ## Means over the scenes, px\n\n{}",
            self.date,
            machine.cpu,
            machine.cores,
            if machine.cores == 1 { "" } else { "s" },
            machine.rustc,
            machine.build,
            self.scenes.len(),
            self.table(),
        );
        // Writing to a string does not fail.
        let by_scene: [Measure; 3] = [
            ("Mean absolute error, valid, visible", MEASURES[0].1),
            ("Mean absolute error, valid, textured", MEASURES[3].1),
            ("Mean absolute error, dense, visible", MEASURES[4].1),
        ];
        for (title, measure) in by_scene {
            let _ = write!(page, "\n## {title}, px\n\n{}", self.by_scene(measure));
        }
        page
    }
}
