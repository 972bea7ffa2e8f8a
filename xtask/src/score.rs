use std::time::Duration;

use disparity_pyramid::{DisparityField, Validity};
use ndarray::{Array2, ArrayView2};
use serde::Serialize;
use stereo_formats::file_sign;
use stereo_formats::scene_toml::StereoDescription;

use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::sparsification::Sparsification;

/// How well one scene was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Score {
    /// Name of the scene.
    pub(crate) scene: String,
    /// The set it comes from.
    pub(crate) dataset: String,
    /// The paper to cite.
    pub(crate) citation: String,
    /// Columns.
    pub(crate) width: usize,
    /// Rows.
    pub(crate) height: usize,
    /// Whether the truth is rounded to whole pixels, so that a finer answer is penalised.
    pub(crate) integer_truth: bool,
    /// Wall time from the two images to the field, in seconds.
    pub(crate) seconds: f64,
    /// The pixels that the estimator calls valid, and nothing else.
    pub(crate) valid: OverMasks,
    /// The best guess everywhere.
    pub(crate) dense: OverMasks,
    /// How well the confidence orders the errors of the best guess over visible pixels.
    pub(crate) sparsification: Option<Sparsification>,
}

/// The errors of one output over each mask; `None` where a mask leaves no pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct OverMasks {
    /// Where the truth is known.
    pub(crate) all: Option<Metrics>,
    /// Where the right eye sees it too.
    pub(crate) visible: Option<Metrics>,
    /// Where it is visible and the estimator calls its answer valid.
    pub(crate) estimated: Option<Metrics>,
    /// Where it is visible, in texture, and on a continuous surface.
    pub(crate) textured: Option<Metrics>,
}

impl OverMasks {
    /// The masks by name, in the order of the tables.
    pub(crate) const fn by_name(&self) -> [(&'static str, Option<Metrics>); 4] {
        [
            ("all", self.all),
            ("visible", self.visible),
            ("estimated", self.estimated),
            ("textured", self.textured),
        ]
    }
}

impl Score {
    /// Compares a field with the truth `d` of its scene.
    pub(crate) fn of(
        description: &StereoDescription,
        field: &DisparityField,
        truth: ArrayView2<'_, f32>,
        masks: &Masks,
        took: Duration,
    ) -> Self {
        let estimated = masks.estimated(&field.validity().mapv(Validity::is_valid));
        let over = |dense| {
            let d: Array2<f32> = file_sign::d_of_field(field, dense);
            let over = |mask: &Array2<bool>| Metrics::of(d.view(), truth, mask.view());
            OverMasks {
                all: over(&masks.all),
                visible: over(&masks.visible),
                estimated: over(&estimated),
                textured: over(&masks.textured),
            }
        };
        Self {
            scene: description.name.clone(),
            dataset: description.dataset.clone(),
            citation: description.citation.clone(),
            width: description.size.width,
            height: description.size.height,
            integer_truth: description.integer_truth,
            seconds: took.as_secs_f64(),
            valid: over(false),
            dense: over(true),
            sparsification: Sparsification::of(
                file_sign::d_of_field(field, true).view(),
                field.confidence(),
                truth,
                &masks.visible,
            ),
        }
    }

    /// The outputs by name, in the order of the tables.
    pub(crate) const fn outputs(&self) -> [(&'static str, OverMasks); 2] {
        [("valid", self.valid), ("dense", self.dense)]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A small made-up scene, its truth and a field that is half a pixel off; every third column
    /// is not valid and two pixels off.
    pub(crate) fn made_up(name: &str) -> Score {
        let text = format!(
            "name = '{name}'\ndataset = 'made up'\ncitation = 'nobody'\nterms = 'none'\n\
             width = 12\nheight = 6\nleft = 'l.png'\nright = 'r.png'\nrectified = true\n"
        );
        let description = stereo_formats::scene_toml::decode_stereo(text.as_bytes()).unwrap();
        let shape = (6, 12);
        let mut truth = Array2::from_elem(shape, 2.0);
        truth[[0, 0]] = f32::NAN;
        let valid = |x: usize| !x.is_multiple_of(3);
        let dx = Array2::from_shape_fn(shape, |(_, x)| if valid(x) { -2.5 } else { -4.0 });
        let validity = Array2::from_shape_fn(shape, |(_, x)| {
            if valid(x) {
                Validity::Valid
            } else {
                Validity::NoEnergy
            }
        });
        let zeros = Array2::zeros(shape);
        let field = DisparityField::new(dx, zeros.clone(), zeros, validity).unwrap();
        let everywhere = Array2::from_elem(shape, true);
        let masks = Masks {
            all: truth.mapv(f32::is_finite),
            visible: Array2::from_shape_fn(shape, |(_, x)| x >= 2),
            textured: everywhere,
        };
        let took = Duration::from_millis(250);
        Score::of(&description, &field, truth.view(), &masks, took)
    }

    #[test]
    fn valid_answers_and_best_guesses_are_told_apart() {
        let score = made_up("plane");
        let all = score.valid.all.unwrap();
        // 72 pixels, one of unknown truth; two thirds of them valid.
        assert_eq!((all.asked, all.answered), (71, 48));
        // Nearer than the truth is a positive error.
        assert_eq!((all.mean_absolute, all.signed_mean), (0.5, 0.5));
        let dense = score.dense.all.unwrap();
        assert_eq!((dense.asked, dense.density), (71, 1.0));
        assert_eq!(dense.mean_absolute, (48.0 * 0.5 + 23.0 * 2.0) / 71.0);
        // Where the estimator stands behind its answer, both outputs are the same.
        assert_eq!(score.valid.estimated, score.dense.estimated);
        assert_eq!(score.valid.estimated.unwrap().answered, 42);
        assert_eq!(score.valid.visible.unwrap().density, 0.7);
    }
}
