use anyhow::Context;
use ndarray::Array2;
use serde::Serialize;
use stereo_formats::file_sign;
use stereo_formats::picture::Picture;
use stereo_formats::scene_folder::StereoScene;

use crate::machine::Machine;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::phase_statistics::PhaseStatistics;
use crate::table_1_row::{Filters, Matcher, Row};

/// The paper's Table 1, run again: every row over every scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Table1Run {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    pub(crate) machine: Machine,
    pub(crate) scenes: Vec<SceneRun>,
}

/// One scene: what each row made of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SceneRun {
    pub(crate) scene: String,
    pub(crate) integer_truth: bool,
    pub(crate) rows: Vec<RowRun>,
    /// The finest scale of the left eye, family by family, without the spherical one.
    pub(crate) phases: Vec<(Filters, Option<PhaseStatistics>)>,
}

/// One row over one scene: the valid pixels over three masks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct RowRun {
    pub(crate) row: Row,
    pub(crate) textured: Option<Metrics>,
    pub(crate) visible: Option<Metrics>,
    /// Textured, and called valid by every family under the table's protocol.
    pub(crate) common: Option<Metrics>,
}

impl Table1Run {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-table-1/1";

    /// Every row that is run: the paper's five, their search along rows only and with a second
    /// warp, and the default of this library.
    ///
    /// PBBDE is the vector pyramid over Gabor responses: under one protocol for all, its row is the
    /// Gabor row, and is run once.
    pub(crate) fn rows() -> Vec<Row> {
        let of = |matcher| {
            let filters = Filters::ALL.into_iter().enumerate();
            filters.map(move |(printed, filters)| Row {
                printed,
                filters,
                matcher,
            })
        };
        let ours = Row {
            printed: 4,
            filters: Filters::Gabor,
            matcher: Matcher::Default,
        };
        of(Matcher::Published)
            .chain(of(Matcher::PublishedRowsOnly))
            .chain(of(Matcher::PublishedTwoWarps))
            .chain([ours])
            .collect()
    }
}

impl SceneRun {
    /// Runs every row over one scene.
    pub(crate) fn of(scene: &StereoScene, truth: &Array2<f32>) -> anyhow::Result<Self> {
        let pair = scene.pair()?;
        let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
        let eyes = pair.map(Picture::into_luma);
        let look = |row: Row| {
            let field = row
                .look(&eyes)
                .with_context(|| format!("row {}", row.filters.name()))?;
            anyhow::Ok((row, file_sign::d_of_field(&field, false)))
        };
        let looks: Vec<(Row, Array2<f32>)> = Table1Run::rows()
            .into_iter()
            .map(look)
            .collect::<anyhow::Result<_>>()?;
        let mut common = masks.textured.clone();
        for (row, d) in &looks {
            if row.matcher == Matcher::Published {
                common.zip_mut_with(d, |common, d| *common &= d.is_finite());
            }
        }
        let rows = looks.iter().map(|(row, d)| {
            let over = |mask: &Array2<bool>| Metrics::of(d.view(), truth.view(), mask.view());
            RowRun {
                row: *row,
                textured: over(&masks.textured),
                visible: over(&masks.visible),
                common: over(&common),
            }
        });
        let threshold = Matcher::Published.params().energy_threshold;
        let phases = Filters::ALL.into_iter().filter_map(|filters| {
            let responses = filters.respond(&eyes).transpose()?;
            Some(responses.map(|responses| {
                let finest = &responses.left.scales()[0];
                (filters, PhaseStatistics::of(finest, threshold))
            }))
        });
        Ok(Self {
            scene: scene.description.name.clone(),
            integer_truth: scene.description.integer_truth,
            rows: rows.collect(),
            phases: phases.collect::<anyhow::Result<_>>()?,
        })
    }

    /// What a row made of this scene.
    pub(crate) fn row(&self, filters: Filters, matcher: Matcher) -> Option<&RowRun> {
        let mut rows = self.rows.iter();
        rows.find(|run| run.row.filters == filters && run.row.matcher == matcher)
    }
}
