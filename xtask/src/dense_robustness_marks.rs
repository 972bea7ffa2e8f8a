//! What bad cameras and a bad rig may cost the dense estimator.

use crate::dense_robustness_run::{Condition, DenseRobustnessRun};
use crate::metrics::Metrics;

/// The most bad-1 of a pair that we rectified ourselves, %.
const MOST_RIG_BAD_1: f64 = 2.0;
/// The most vertical disparity that our own alignment may leave, px RMS.
const MOST_RESIDUAL_PX: f64 = 0.15;
/// The most that another exposure curve may cost, times the clean bad-1.
const MOST_EXPOSURE_RATIO: f64 = 1.15;
/// The most that the other exposure of Motorcycle may cost, times that of the normal one.
const MOST_TAKEN_RATIO: f64 = 1.5;
/// What SGBM's bad-1 is above on each rig that nobody rectified, %.
const LEAST_SGBM_BAD_1: f64 = 50.0;

/// The scenes of the two exposures, the normal one first.
pub(crate) const EXPOSURES: [&str; 2] = ["motorcycle", "motorcycle-exposure"];

/// Every mark that the run misses, a sentence each with the scene and the figure.
pub(crate) fn missed(run: &DenseRobustnessRun) -> Vec<String> {
    let mut missed = Vec::new();
    for trial in &run.trials {
        let scene = &trial.scene;
        let title = trial.condition.title();
        for (preset, found) in [("best", trial.best), ("fast", trial.fast)] {
            let Some(found) = found.map(|metrics| metrics.bad.one) else {
                missed.push(format!("{scene}, {title}, {preset}: nothing to compare"));
                continue;
            };
            let most = match trial.condition {
                Condition::Clean | Condition::AsTaken => None,
                Condition::Noise => bad_1(trial.sgbm).map(|sgbm| (sgbm, "SGBM's")),
                Condition::Gain | Condition::Gamma => run
                    .trial(scene, Condition::Clean)
                    .and_then(|clean| {
                        bad_1(if preset == "best" {
                            clean.best
                        } else {
                            clean.fast
                        })
                    })
                    .map(|clean| (MOST_EXPOSURE_RATIO * clean, "1.15 times the clean one")),
                Condition::Rig(_) => Some((MOST_RIG_BAD_1, "the mark")),
            };
            if let Some((most, name)) = most
                // Noise has to leave us below SGBM; the others may be as large as their mark.
                && (found > most || trial.condition == Condition::Noise && found >= most)
            {
                missed.push(format!(
                    "{scene}, {title}, {preset}: bad-1 is {found:.2} %, and {name} is {most:.2} %"
                ));
            }
        }
        if let Some(residual) = trial.residual_px
            && residual > MOST_RESIDUAL_PX
        {
            missed.push(format!(
                "{scene}, {title}: {residual:.3} px RMS of vertical disparity are left, and the mark \
                 is {MOST_RESIDUAL_PX:.2} px"
            ));
        }
        if let (Condition::Rig(_), Some(sgbm)) = (trial.condition, bad_1(trial.sgbm))
            && sgbm <= LEAST_SGBM_BAD_1
        {
            missed.push(format!(
                "{scene}, {title}: SGBM's bad-1 is {sgbm:.2} %, and it should be above 50 %"
            ));
        }
    }
    let taken = EXPOSURES.map(|scene| run.trial(scene, Condition::AsTaken));
    if let [Some(normal), Some(other)] = taken {
        for (preset, normal, other) in [
            ("best", normal.best, other.best),
            ("fast", normal.fast, other.fast),
        ] {
            if let (Some(normal), Some(other)) = (bad_1(normal), bad_1(other))
                && other > MOST_TAKEN_RATIO * normal
            {
                missed.push(format!(
                    "{}, {preset}: bad-1 is {other:.2} %, and 1.5 times that of {} is {:.2} %",
                    EXPOSURES[1],
                    EXPOSURES[0],
                    MOST_TAKEN_RATIO * normal
                ));
            }
        }
    }
    missed
}

/// SGBM's bad-1 on the mean of the bad rigs, %; `None` if it saw none.
pub(crate) fn sgbm_on_rigs(run: &DenseRobustnessRun) -> Option<f64> {
    let rigs = run.trials.iter();
    let rigs = rigs.filter(|trial| matches!(trial.condition, Condition::Rig(_)));
    let bad: Vec<f64> = rigs.filter_map(|trial| bad_1(trial.sgbm)).collect();
    (!bad.is_empty()).then(|| bad.iter().sum::<f64>() / bad.len() as f64)
}

fn bad_1(metrics: Option<Metrics>) -> Option<f64> {
    metrics.map(|metrics| metrics.bad.one)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use ndarray::Array2;

    use super::*;
    use crate::dense_robustness_run::DenseTrial;
    use crate::machine::Machine;
    use crate::rig_signs::RigSigns;

    /// Errors of which so many in a hundred are wrong.
    fn wrong(percent: usize) -> Option<Metrics> {
        let truth = Array2::zeros((10, 10));
        let found = Array2::from_shape_fn(
            (10, 10),
            |(y, x)| {
                if 10 * y + x < percent { 5.0 } else { 0.0 }
            },
        );
        Metrics::of(
            found.view(),
            truth.view(),
            Array2::from_elem((10, 10), true).view(),
        )
    }

    fn missed_by(trials: &[(&str, Condition, usize, usize, Option<f64>)]) -> Vec<String> {
        let trial =
            |&(scene, condition, ours, sgbm, residual_px): &(&str, _, _, _, _)| DenseTrial {
                scene: scene.to_owned(),
                condition,
                best: wrong(ours),
                fast: wrong(ours),
                sgbm: wrong(sgbm),
                residual_px,
                told_residual_px: None,
            };
        missed(&DenseRobustnessRun {
            schema: DenseRobustnessRun::SCHEMA,
            date: String::new(),
            machine: Machine::this(),
            command: String::new(),
            versions: BTreeMap::new(),
            trials: trials.iter().map(trial).collect(),
        })
    }

    #[test]
    fn each_mark_holds_or_is_missed() {
        use Condition::{AsTaken, Clean, Gain, Noise};
        let mut rigs = RigSigns::all().map(Condition::Rig);
        let (one, other) = (rigs.next().unwrap(), rigs.next().unwrap());
        let count = |trials: &[_]| missed_by(trials).len();
        let clean = ("venus", Clean, 20, 20, None);
        assert_eq!(count(&[clean, ("venus", Gain, 23, 90, None)]), 0);
        assert_eq!(count(&[clean, ("venus", Gain, 24, 90, None)]), 2);
        assert_eq!(count(&[("venus", Noise, 9, 10, None)]), 0);
        assert_eq!(count(&[("venus", Noise, 10, 10, None)]), 2);
        assert_eq!(count(&[("venus", one, 2, 51, Some(0.15))]), 0);
        assert_eq!(count(&[("venus", one, 3, 50, Some(0.151))]), 4);
        // Each rig counts by itself, for us and for SGBM: a mean of 60 hides no 40.
        let two = |ours, sgbm| {
            [
                ("venus", one, 2, 80, None),
                ("venus", other, ours, sgbm, None),
            ]
        };
        assert_eq!((count(&two(2, 51)), count(&two(2, 40))), (0, 1));
        assert_eq!(count(&two(3, 51)), 2);
        let taken = |other| {
            [
                (EXPOSURES[0], AsTaken, 10, 10, None),
                (EXPOSURES[1], AsTaken, other, 10, None),
            ]
        };
        assert_eq!((count(&taken(15)), count(&taken(16))), (0, 2));
        let said = missed_by(&[("venus", Noise, 12, 10, None)]);
        assert!(said[0].starts_with("venus, noise") && said[0].contains("12.00 %"));
    }
}
