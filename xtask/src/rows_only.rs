//! The vector pyramid on rectified pairs whose vertical shift it is told.

use disparity_pyramid::MatchParams;
use ndarray::Array2;
use serde::Serialize;
use stereo_formats::file_sign;
use stereo_formats::picture::Picture;
use stereo_formats::scene_folder::StereoScene;

use crate::estimator::vector;
use crate::markdown_table::MarkdownTable;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::table_1;

/// How the table is to be read.
pub(crate) const READING: &str = "\
The vertical shift held at 0 (`MatchParams::rows_only`), valid pixels over the textured mask: mean \
/ std of the absolute error in pixels (density). The mark asks for no more error at no less density, \
and was measured at the paper's energy of 1e-6.";

/// What a scene may err at most and must answer at least: mean and standard deviation of the
/// absolute error in pixels, and per cent of the textured pixels; in the order of the scenes of
/// Table 1.
const MARKS: [(f64, f64, f64); 3] = [(0.15, 0.45, 65.0), (0.23, 0.80, 78.0), (0.28, 0.45, 84.0)];

/// One scene along the rows only: its errors over valid textured pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RowsOnly {
    scene: String,
    /// The default.
    default: Option<Metrics>,
    /// The default at the paper's energy threshold.
    paper_energy: Option<Metrics>,
    /// The paper's own steps.
    published: Option<Metrics>,
}

impl RowsOnly {
    /// Matches one scene along the rows, by each parameter set.
    pub(crate) fn of(scene: &StereoScene, truth: &Array2<f32>) -> anyhow::Result<Self> {
        let pair = scene.pair()?;
        let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
        let textured = |params: MatchParams| {
            let params = MatchParams {
                rows_only: true,
                ..params
            };
            let field = vector(&pair.as_ref().map(Picture::luma), params)?;
            let d = file_sign::d_of_field(&field, false);
            anyhow::Ok(Metrics::of(d.view(), truth.view(), masks.textured.view()))
        };
        let published = MatchParams::as_published();
        Ok(Self {
            scene: scene.description.name.clone(),
            default: textured(MatchParams::default())?,
            paper_energy: textured(MatchParams {
                energy_threshold: published.energy_threshold,
                ..MatchParams::default()
            })?,
            published: textured(published)?,
        })
    }
}

/// A row of the table: its name, and what it takes of a scene.
type Row = (&'static str, fn(&RowsOnly) -> Option<Metrics>);

/// The marks beside what was found; `None` if no scene was evaluated.
pub(crate) fn table(found: &[RowsOnly]) -> Option<MarkdownTable> {
    if found.is_empty() {
        return None;
    }
    let cell = |mean: f64, std: f64, density: f64| format!("{mean:.3} / {std:.3} ({density:.0} %)");
    let [venus, sawtooth, tsukuba] = table_1::SCENES;
    let mut table = MarkdownTable::new(["rows only", venus, sawtooth, tsukuba]);
    let marks = MARKS.map(|(mean, std, density)| cell(mean, std, density));
    table.push(std::iter::once("mark".to_owned()).chain(marks));
    let rows: [Row; 3] = [
        ("default, energy 1e-6", |scene| scene.paper_energy),
        ("default", |scene| scene.default),
        ("the paper's steps", |scene| scene.published),
    ];
    for (name, metrics) in rows {
        let cells = table_1::SCENES.map(|name| {
            let scene = found.iter().find(|scene| scene.scene == name);
            scene.and_then(metrics).map_or_else(
                || "-".to_owned(),
                |m| cell(m.mean_absolute, m.std_absolute, 100.0 * m.density),
            )
        });
        table.push(std::iter::once(name.to_owned()).chain(cells));
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::tests::made_up;

    #[test]
    fn marks_stand_above_what_was_found() {
        assert!(table(&[]).is_none());
        let metrics = made_up("sawtooth").valid.textured;
        let found = RowsOnly {
            scene: "sawtooth".to_owned(),
            default: metrics,
            paper_energy: None,
            published: metrics,
        };
        let table = table(&[found]).expect("a scene").to_string();
        let mark = table.find("0.230 / 0.800 (78 %)").expect("the mark");
        let ours = table.find("0.500 / 0.000").expect("the default");
        assert!(mark < ours, "{table}");
    }
}
