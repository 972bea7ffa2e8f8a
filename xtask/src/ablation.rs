//! What each ingredient of the dense estimator is worth.

use cpu_time::ProcessTime;
use disparity_pyramid::{Acuity, Cost, DenseParams, LookBack};
use ndarray::Array2;
use stereo_formats::file_sign;
use stereo_formats::scene_folder::StereoScene;

use crate::estimator::{dense, search_of};
use crate::markdown_table::MarkdownTable;
use crate::masks::Masks;
use crate::metrics::Metrics;

/// The preset with one ingredient exchanged or left out at a time.
fn variants(preset: DenseParams) -> [(&'static str, DenseParams); 17] {
    [
        ("as it is", preset),
        (
            "the whole range searched everywhere",
            DenseParams {
                narrow_px: None,
                ..preset
            },
        ),
        (
            "narrowed by a look at a quarter of the size",
            DenseParams {
                narrow_px: Some(4),
                ..preset
            },
        ),
        (
            "quadrants for phase agreement",
            DenseParams {
                cost: Cost::PhaseQuadrants,
                ..preset
            },
        ),
        (
            "luma alone in the cost",
            DenseParams {
                opponent: 0.0,
                ..preset
            },
        ),
        (
            "an opponent colour beside luma in the cost",
            DenseParams {
                opponent: DenseParams::best().opponent,
                ..preset
            },
        ),
        (
            "no edges: steps cost the same everywhere",
            DenseParams {
                edge_softness: 1e6,
                ..preset
            },
        ),
        (
            "edges by luma alone",
            DenseParams {
                colour: false,
                ..preset
            },
        ),
        (
            "look back by the same paths",
            DenseParams {
                look_back: LookBack::SamePaths,
                ..preset
            },
        ),
        (
            "small patches kept",
            DenseParams {
                least_patch: 0,
                ..preset
            },
        ),
        ("no votes", DenseParams { votes: 0, ..preset }),
        (
            "no median",
            DenseParams {
                median: false,
                ..preset
            },
        ),
        (
            "no hyperacuity",
            DenseParams {
                acuity: Acuity::Parabola,
                ..preset
            },
        ),
        (
            "hyperacuity by the cost's own bank",
            DenseParams {
                acuity: Acuity::CostBank,
                ..preset
            },
        ),
        (
            "no surface cells",
            DenseParams {
                surface_radius: 0,
                ..preset
            },
        ),
        (
            "no choice of surfaces",
            DenseParams {
                choice_radius: 0,
                ..preset
            },
        ),
        if preset.slants > 0 {
            (
                "slants not looked at again",
                DenseParams {
                    slants: 0,
                    ..preset
                },
            )
        } else {
            (
                "slants that phases tell looked at again",
                DenseParams {
                    slants: DenseParams::best().slants,
                    ..preset
                },
            )
        },
    ]
}

/// Means over the scenes of what each variant of the preset gives, a value at every pixel.
pub(crate) fn table(
    scenes: &[(StereoScene, Array2<f32>)],
    preset: DenseParams,
    mut done: impl FnMut(&str),
) -> anyhow::Result<MarkdownTable> {
    let mut table = MarkdownTable::new([
        "mean over the scenes",
        "visible bad-1 %",
        "bad-0.5 %",
        "mean, px",
        "all bad-1 %",
        "CPU s",
    ]);
    let [as_it_is, others @ ..] = variants(preset);
    // What the preset leaves out itself, or has already, is no variant of it.
    let others = others.into_iter().filter(|(_, params)| *params != preset);
    for (name, params) in std::iter::once(as_it_is).chain(others) {
        let mut sums = [0.0; 5];
        for (scene, truth) in scenes {
            let pair = scene.pair()?;
            let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
            let clock = ProcessTime::now();
            let field = dense(params, &pair, search_of(truth.view())?)?;
            let seconds = clock.elapsed().as_secs_f64();
            let d = file_sign::d_of_field(&field, true);
            let over = |mask: &Array2<bool>| Metrics::of(d.view(), truth.view(), mask.view());
            if let (Some(visible), Some(all)) = (over(&masks.visible), over(&masks.all)) {
                let found = [
                    visible.bad.one,
                    visible.bad.half,
                    visible.mean_absolute,
                    all.bad.one,
                    seconds,
                ];
                for (sum, found) in sums.iter_mut().zip(found) {
                    *sum += found / scenes.len() as f64;
                }
            }
        }
        let cells = sums
            .iter()
            .zip([2, 2, 3, 2, 2])
            .map(|(mean, digits)| format!("{mean:.digits$}"));
        table.push(std::iter::once(name.to_owned()).chain(cells));
        done(name);
    }
    Ok(table)
}
