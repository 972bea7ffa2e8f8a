//! The vector pyramid over the textured pixels of the scenes of Table 1, in both directions and along
//! the rows, and what it has to reach there.

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
Valid pixels over the textured mask: mean / std of the absolute error in pixels, signed mean (density). \
Two-dimensional as the default is, and with the vertical shift held at 0 (`MatchParams::rows_only`). A mark asks \
for no more error at no less density, and for a signed mean within 0.06 px; `--check` fails where one is missed.";

/// The most that the signed mean may be away from nought, in pixels.
const MOST_SIGNED: f64 = 0.06;

/// What a scene may err at most, mean and standard deviation of the absolute error in pixels, and how
/// many per cent of the textured pixels it must answer at least.
type Mark = (f64, f64, f64);

/// One way to match, and its marks in the order of the scenes of Table 1.
struct Way {
    name: &'static str,
    params: fn() -> MatchParams,
    marks: Option<[Mark; 3]>,
}

const PAPER_ENERGY: f32 = 1e-6;

const WAYS: [Way; 5] = [
    Way {
        name: "default",
        params: MatchParams::default,
        marks: Some([(0.24, 0.50, 92.0), (0.28, 0.95, 95.0), (0.30, 0.50, 95.0)]),
    },
    Way {
        name: "default, energy 1e-6",
        params: || MatchParams {
            energy_threshold: PAPER_ENERGY,
            ..MatchParams::default()
        },
        marks: Some([(0.19, 0.62, 68.0), (0.26, 0.97, 80.0), (0.29, 0.50, 87.0)]),
    },
    Way {
        name: "rows only, energy 1e-6",
        params: || MatchParams {
            energy_threshold: PAPER_ENERGY,
            rows_only: true,
            ..MatchParams::default()
        },
        marks: Some([(0.15, 0.45, 65.0), (0.23, 0.80, 78.0), (0.28, 0.45, 84.0)]),
    },
    Way {
        name: "rows only",
        params: || MatchParams {
            rows_only: true,
            ..MatchParams::default()
        },
        marks: None,
    },
    Way {
        name: "the paper's steps, rows only",
        params: || MatchParams {
            rows_only: true,
            ..MatchParams::as_published()
        },
        marks: None,
    },
];

/// One scene, matched in one way: its errors over valid textured pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Textured {
    scene: String,
    way: &'static str,
    errors: Option<Metrics>,
}

/// A mark that is missed.
#[derive(Debug, thiserror::Error)]
#[error("{scene}, {way}, valid textured pixels: {found}, and the mark is {mark}")]
pub(crate) struct Missed {
    scene: &'static str,
    way: &'static str,
    found: String,
    mark: String,
}

impl Textured {
    /// Matches one scene in every way.
    pub(crate) fn of(scene: &StereoScene, truth: &Array2<f32>) -> anyhow::Result<Vec<Self>> {
        let pair = scene.pair()?;
        let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
        let matched = WAYS.iter().map(|way| {
            let field = vector(&pair.as_ref().map(Picture::luma), (way.params)())?;
            let d = file_sign::d_of_field(&field, false);
            Ok(Self {
                scene: scene.description.name.clone(),
                way: way.name,
                errors: Metrics::of(d.view(), truth.view(), masks.textured.view()),
            })
        });
        matched.collect()
    }

    fn find(all: &[Self], scene: &str, way: &str) -> Option<Metrics> {
        all.iter()
            .find(|found| (found.scene.as_str(), found.way) == (scene, way))?
            .errors
    }
}

/// Holds every scene that was evaluated against its marks.
pub(crate) fn check(found: &[Textured]) -> Result<(), Missed> {
    for way in &WAYS {
        for (scene, mark) in table_1::SCENES.into_iter().zip(way.marks.iter().flatten()) {
            let errors = Textured::find(found, scene, way.name);
            if let Some(errors) = errors.filter(|errors| !reaches(errors, *mark)) {
                return Err(Missed {
                    scene,
                    way: way.name,
                    found: cell(&errors),
                    mark: cell_of_mark(*mark),
                });
            }
        }
    }
    Ok(())
}

fn reaches(errors: &Metrics, (mean, std, density): Mark) -> bool {
    errors.mean_absolute <= mean
        && errors.std_absolute <= std
        && 100.0 * errors.density >= density
        && errors.signed_mean.abs() <= MOST_SIGNED
}

fn cell(errors: &Metrics) -> String {
    format!(
        "{:.3} / {:.3}, {:+.3} ({:.1} %)",
        errors.mean_absolute,
        errors.std_absolute,
        errors.signed_mean,
        100.0 * errors.density
    )
}

fn cell_of_mark((mean, std, density): Mark) -> String {
    format!("{mean:.2} / {std:.2}, {MOST_SIGNED:.2} ({density:.0} %)")
}

/// The marks beside what was found; `None` if no scene was evaluated.
pub(crate) fn table(found: &[Textured]) -> Option<MarkdownTable> {
    if found.is_empty() {
        return None;
    }
    let [venus, sawtooth, tsukuba] = table_1::SCENES;
    let mut table = MarkdownTable::new(["valid, textured", venus, sawtooth, tsukuba]);
    for way in &WAYS {
        let cells = table_1::SCENES.map(|scene| {
            let errors = Textured::find(found, scene, way.name);
            errors.as_ref().map_or_else(|| "-".to_owned(), cell)
        });
        table.push(std::iter::once(way.name.to_owned()).chain(cells));
        if let Some(marks) = way.marks {
            let name = format!("its mark, {}", way.name);
            table.push(std::iter::once(name).chain(marks.map(cell_of_mark)));
        }
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::tests::made_up;

    #[test]
    fn marks_stand_beside_what_was_found_and_fail_what_misses_them() {
        assert!(table(&[]).is_none());
        let mut errors = made_up("sawtooth").valid.textured.expect("a metric");
        (errors.mean_absolute, errors.std_absolute) = (0.28, 0.95);
        (errors.signed_mean, errors.density) = (-0.06, 0.95);
        let found = |errors| {
            [Textured {
                scene: "sawtooth".to_owned(),
                way: "default",
                errors: Some(errors),
            }]
        };
        // Exactly at every mark is within it.
        check(&found(errors)).expect("the marks are reached");
        let shown = table(&found(errors)).expect("a scene").to_string();
        for part in ["0.280 / 0.950, -0.060 (95.0 %)", "0.28 / 0.95, 0.06 (95 %)"] {
            assert!(shown.contains(part), "{part} is not in\n{shown}");
        }
        let spoil: [fn(&mut Metrics); 4] = [
            |errors| errors.mean_absolute = 0.2801,
            |errors| errors.std_absolute = 0.9501,
            |errors| errors.signed_mean = 0.0601,
            |errors| errors.density = 0.9499,
        ];
        for spoil in spoil {
            let mut worse = errors;
            spoil(&mut worse);
            let missed = check(&found(worse)).expect_err("a mark is missed");
            assert!(
                missed.to_string().starts_with("sawtooth, default, "),
                "{missed}"
            );
        }
    }
}
