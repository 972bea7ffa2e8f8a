//! Scores as tables for people.

use crate::markdown_table::MarkdownTable;
use crate::metrics::Metrics;
use crate::score::Score;
use crate::table_1::{self, Printed};

/// One output of a scene over one mask.
type Over = fn(&Score) -> Option<Metrics>;

/// Every measure of one scene, a row for each output and mask.
pub(crate) fn of_scene(score: &Score) -> MarkdownTable {
    let mut table = MarkdownTable::new([
        "output, mask",
        "mean",
        "std",
        "signed",
        "RMS",
        "bad-0.5 %",
        "bad-1 %",
        "bad-2 %",
        "bad-4 %",
        "density %",
        "pixels",
    ]);
    for (output, over) in score.outputs() {
        for (mask, metrics) in over.by_name() {
            let name = std::iter::once(format!("{output}, {mask}"));
            table.push(name.chain(metrics.iter().flat_map(Metrics::cells)));
        }
    }
    table
}

/// One row a scene: the measures that are compared most.
pub(crate) fn of_all(scores: &[Score]) -> MarkdownTable {
    let mut table = MarkdownTable::new([
        "scene",
        "valid: mean",
        "std",
        "bad-1 %",
        "density %",
        "dense: mean",
        "std",
        "bad-1 %",
        "all: bad-1 %",
        "seconds",
    ]);
    for score in scores {
        let cell = |metrics: Option<Metrics>, write: fn(&Metrics) -> String| {
            metrics.as_ref().map_or_else(|| "-".to_owned(), write)
        };
        let (valid, dense) = (score.valid.visible, score.dense.visible);
        let mean: fn(&Metrics) -> String = |m| format!("{:.3}", m.mean_absolute);
        let std: fn(&Metrics) -> String = |m| format!("{:.3}", m.std_absolute);
        let bad_1: fn(&Metrics) -> String = |m| format!("{:.2}", m.bad.one);
        table.push([
            score.scene.clone(),
            cell(valid, mean),
            cell(valid, std),
            cell(valid, bad_1),
            cell(valid, |m| format!("{:.1}", 100.0 * m.density)),
            cell(dense, mean),
            cell(dense, std),
            cell(dense, bad_1),
            cell(score.dense.all, bad_1),
            format!("{:.2}", score.seconds),
        ]);
    }
    table
}

/// How well the confidence orders the errors, one row a scene.
pub(crate) fn of_sparsification(scores: &[Score]) -> MarkdownTable {
    let mut table = MarkdownTable::new(["scene", "by confidence", "ideal", "unordered"]);
    for score in scores {
        let Some(curve) = score.sparsification else {
            continue;
        };
        let cells = [curve.area, curve.ideal, curve.unordered].map(|part| format!("{part:.2}"));
        table.push(std::iter::once(score.scene.clone()).chain(cells));
    }
    table
}

/// The paper's Table 1 with our own rows below it; `None` if none of its scenes was evaluated.
///
/// An entry is the mean and the standard deviation of the absolute error, and for our own rows
/// the density.
pub(crate) fn beside_table_1(scores: &[Score]) -> Option<MarkdownTable> {
    let found = table_1::SCENES.map(|scene| scores.iter().find(|score| score.scene == scene));
    if found.iter().all(Option::is_none) {
        return None;
    }
    let [venus, sawtooth, tsukuba] = table_1::SCENES;
    let mut table = MarkdownTable::new(["mean / std, px", venus, sawtooth, tsukuba]);
    for (filters, printed) in table_1::ROWS {
        let cells = printed.map(|Printed { mean, std }| format!("{mean:.2} / {std:.2}"));
        table.push(std::iter::once(format!("paper, {filters}")).chain(cells));
    }
    let ours: [(&str, Over); 4] = [
        ("ours, valid, textured", |score| score.valid.textured),
        ("ours, valid, visible", |score| score.valid.visible),
        ("ours, dense, textured", |score| score.dense.textured),
        ("ours, dense, visible", |score| score.dense.visible),
    ];
    for (name, metrics) in ours {
        let cells = found.map(|score| {
            score.and_then(metrics).map_or_else(
                || "-".to_owned(),
                |m| {
                    let (mean, std) = (m.mean_absolute, m.std_absolute);
                    format!("{mean:.3} / {std:.3} ({:.0} %)", 100.0 * m.density)
                },
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
    fn every_output_and_mask_has_its_row() {
        let table = of_scene(&made_up("plane")).to_string();
        for output in ["valid", "dense"] {
            for mask in ["all", "visible", "estimated", "textured"] {
                assert!(table.contains(&format!("| {output}, {mask} ")), "{table}");
            }
        }
    }

    #[test]
    fn the_papers_rows_stand_above_ours() {
        assert!(beside_table_1(&[made_up("plane")]).is_none());
        let table = beside_table_1(&[made_up("tsukuba")]).unwrap().to_string();
        let paper = table.find("0.12 / 0.67").unwrap();
        let ours = table.find("0.500 / 0.000 (68 %)").unwrap();
        assert!(paper < ours, "{table}");
        // The other two scenes were not evaluated.
        assert_eq!(table.lines().last().unwrap().matches(" - ").count(), 2);
    }
}
