use serde::Serialize;

use crate::flow_errors::FlowErrors;
use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;

/// The most mean endpoint error that a scene may have, in pixels: over all pixels of known truth,
/// the best guess everywhere.
const MARKS: [(&str, f64); 3] = [
    ("rubberwhale", 0.35),
    ("dimetrodon", 0.40),
    ("grove2", 0.45),
];

/// The row of [`FlowScore::methods`] that the marks are about.
pub(crate) const OURS_DENSE: &str = "dorsal, dense";

/// One run over the flow scenes: what was measured, when, where and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FlowRun {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    /// The machine.
    pub(crate) machine: Machine,
    /// The command that gives these numbers again; folders are left out.
    pub(crate) command: String,
    /// OpenCV's version, if it ran beside us.
    pub(crate) opencv: Option<String>,
    /// One score a scene.
    pub(crate) scenes: Vec<FlowScore>,
}

/// How well the motion of one scene was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FlowScore {
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
    /// Our outputs, then OpenCV's.
    pub(crate) methods: Vec<MethodScore>,
}

/// The errors of one method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct MethodScore {
    /// What it is called.
    pub(crate) method: String,
    /// Its errors; `None` if it answered nowhere.
    pub(crate) errors: Option<FlowErrors>,
    /// Wall time from two frames to the flow, in seconds.
    pub(crate) seconds: f64,
}

impl FlowRun {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-flow-evaluation/1";

    /// Every measure of every scene and method.
    pub(crate) fn table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "scene, method",
            "endpoint, px",
            "std",
            "above 1 px, %",
            "angular, deg",
            "std",
            "density %",
            "seconds",
        ]);
        for score in &self.scenes {
            for MethodScore {
                method,
                errors,
                seconds,
            } in &score.methods
            {
                let name = format!("{}, {method}", score.scene);
                let Some(errors) = errors else {
                    table.push([name]);
                    continue;
                };
                table.push([
                    name,
                    format!("{:.3}", errors.endpoint_mean),
                    format!("{:.3}", errors.endpoint_std),
                    format!("{:.2}", errors.above_1),
                    format!("{:.2}", errors.angular_mean_deg),
                    format!("{:.2}", errors.angular_std_deg),
                    format!("{:.1}", 100.0 * errors.density),
                    format!("{seconds:.2}"),
                ]);
            }
        }
        table
    }

    /// The marks of the scenes that were evaluated, beside what was found.
    pub(crate) fn marks(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new(["scene", "endpoint, px", "mark, px", ""]);
        for (scene, mark) in MARKS {
            let Some(found) = self.endpoint(scene) else {
                continue;
            };
            table.push([
                scene.to_owned(),
                format!("{found:.3}"),
                format!("{mark:.2}"),
                if found <= mark { "holds" } else { "missed" }.to_owned(),
            ]);
        }
        table
    }

    /// The first scene whose mark does not hold, in a sentence.
    pub(crate) fn missed(&self) -> Option<String> {
        MARKS.iter().find_map(|&(scene, mark)| match self.endpoint(scene) {
            None => Some(format!("{scene} has a mark and was not evaluated")),
            Some(found) if found > mark => Some(format!(
                "{scene}: a mean endpoint error of {found:.3} px is above the mark of {mark:.2} px"
            )),
            Some(_) => None,
        })
    }

    /// The mean endpoint error of our best guess everywhere.
    fn endpoint(&self, scene: &str) -> Option<f64> {
        let score = self.scenes.iter().find(|score| score.scene == scene)?;
        let ours = score
            .methods
            .iter()
            .find(|score| score.method == OURS_DENSE)?;
        Some(ours.errors?.endpoint_mean)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use ndarray::array;
    use stereo_formats::VectorPlanes;

    use super::*;

    /// A run over one scene that errs by `error_px` everywhere.
    pub(crate) fn made_up(scene: &str, error_px: f32) -> FlowRun {
        let truth = VectorPlanes::new(array![[0.0]], array![[0.0]]).unwrap();
        let errors = FlowErrors::of(array![[error_px]].view(), array![[0.0]].view(), &truth);
        FlowRun {
            schema: FlowRun::SCHEMA,
            date: "2024-02-29".to_owned(),
            machine: Machine {
                cpu: "A CPU".to_owned(),
                cores: 2,
                rustc: "rustc 1".to_owned(),
                build: "release",
            },
            command: "cargo xtask eval-flow".to_owned(),
            opencv: None,
            scenes: vec![FlowScore {
                scene: scene.to_owned(),
                dataset: "a set".to_owned(),
                citation: "A. Author".to_owned(),
                width: 1,
                height: 1,
                methods: vec![MethodScore {
                    method: OURS_DENSE.to_owned(),
                    errors,
                    seconds: 1.0,
                }],
            }],
        }
    }

    #[test]
    fn a_mark_holds_or_is_missed() {
        let mut run = made_up("rubberwhale", 0.25);
        run.scenes.extend(made_up("dimetrodon", 0.25).scenes);
        assert!(run.missed().unwrap().starts_with("grove2 has a mark"));
        run.scenes.extend(made_up("grove2", 0.25).scenes);
        assert_eq!(run.missed(), None);
        run.scenes[1] = made_up("dimetrodon", 0.5).scenes.remove(0);
        assert!(run.missed().unwrap().starts_with("dimetrodon: a mean"));
        assert!(run.marks().to_string().contains("missed"));
    }
}
