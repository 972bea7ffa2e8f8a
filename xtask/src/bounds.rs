use crate::markdown_table::MarkdownTable;
use crate::score::Score;

/// The most mean absolute error that a scene may have, in pixels: over visible pixels, the best
/// guess everywhere.
pub(crate) const MOST_MEAN_ABSOLUTE: [(&str, f64); 3] =
    [("venus", 0.35), ("sawtooth", 0.57), ("tsukuba", 0.58)];

/// Why the scores are not good enough.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NotGoodEnough {
    /// A scene with a bound is not among the scores.
    #[error("{0} has a bound and was not evaluated; leave --scene out, or name it too")]
    Missing(&'static str),
    /// The error of a scene is above its bound.
    #[error(
        "{scene}: a mean absolute error of {found:.3} px is above the bound of {most:.2} px \
         (best guess everywhere, visible pixels)"
    )]
    TooFar {
        /// The scene.
        scene: &'static str,
        /// Its mean absolute error, px.
        found: f64,
        /// Its bound, px.
        most: f64,
    },
}

/// Holds the scores against every bound.
pub(crate) fn check(scores: &[Score]) -> Result<(), NotGoodEnough> {
    for (scene, most) in MOST_MEAN_ABSOLUTE {
        let found = mean_absolute(scores, scene).ok_or(NotGoodEnough::Missing(scene))?;
        if found > most {
            return Err(NotGoodEnough::TooFar { scene, found, most });
        }
    }
    Ok(())
}

/// The bounds beside what was found.
pub(crate) fn table(scores: &[Score]) -> MarkdownTable {
    let mut table = MarkdownTable::new(["scene", "mean, px", "bound, px", ""]);
    for (scene, most) in MOST_MEAN_ABSOLUTE {
        let found = mean_absolute(scores, scene);
        table.push([
            scene.to_owned(),
            found.map_or_else(|| "-".to_owned(), |found| format!("{found:.3}")),
            format!("{most:.2}"),
            match found {
                None => "not evaluated",
                Some(found) if found > most => "above",
                Some(_) => "holds",
            }
            .to_owned(),
        ]);
    }
    table
}

fn mean_absolute(scores: &[Score], scene: &str) -> Option<f64> {
    let score = scores.iter().find(|score| score.scene == scene)?;
    Some(score.dense.visible?.mean_absolute)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::tests::made_up;

    #[test]
    fn a_bound_holds_is_exceeded_or_is_missing() {
        let good = |name: &str| {
            let mut score = made_up(name);
            score.dense.visible.as_mut().unwrap().mean_absolute = 0.35;
            score
        };
        let mut scores = vec![good("venus"), good("sawtooth")];
        let missing = check(&scores).unwrap_err().to_string();
        assert!(missing.starts_with("tsukuba"), "{missing}");
        scores.push(good("tsukuba"));
        // Exactly at the bound is within it.
        check(&scores).unwrap();
        scores[0].dense.visible.as_mut().unwrap().mean_absolute = 0.3501;
        let above = check(&scores).unwrap_err().to_string();
        assert!(
            above.starts_with("venus: a mean absolute error of 0.350 px"),
            "{above}"
        );
        assert!(table(&scores).to_string().contains("above"));
    }
}
