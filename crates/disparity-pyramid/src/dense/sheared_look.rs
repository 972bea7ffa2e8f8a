use std::ops::Range;

use ndarray::{Array2, Axis};
use rayon::prelude::*;
use v1_gabor::{Binocular, LumaImage, Size};

use crate::dense::dense_matcher::{DenseMatcher, WrongView};
use crate::dense::dense_params::DenseParams;
use crate::dense::dense_workspace::DenseWorkspace;
use crate::dense::eye_view::EyeView;
use crate::dense::phase_slants::{BLOCK, Slant, slants};
use crate::dense::search_range::SearchRange;
use crate::dense::steep_patches::{STEEPEST, SteepPatch, steep_patches};
use crate::{DisparityField, Validity};

/// How far around a patch is looked at with it, in pixels: at the ends of a slanted surface phases tell of both.
const AROUND: usize = 2 * BLOCK;

/// By how many times what phases say is left of a slant it is moved: they say too little.
const RELAXATION: f32 = 3.0;

/// A surface of which less than this is left faces both eyes, in pixels a row: a tenth of a pixel within a filter.
const FACING: f32 = 0.015;

/// How much surer than the old answer a new one must be.
const SURER: f32 = 0.1;

/// Answers that differ by less say the same, in pixels: hyperacuity and surface cells have chosen between them.
const SAME_PX: f32 = 0.3;

/// Looks again at what is so steep that steps of a pixel a row lose it, and takes what is surer.
///
/// Phases propose the slant (see [`slants`]). The right eye's rows are sheared until a surface so
/// slanted faces both eyes: its shift is the same on every row then, no path pays for steps, and a filter of seven
/// rows sees one shift. What is left of the slant is asked of the phases again, and the rows are sheared by
/// that too, [`slants`](DenseParams::slants) looks in all; the last one's answers count. Patches come by size, as
/// long as what is cut out for them is not more than one picture.
///
/// # Errors
/// None in truth: what is cut out has the size that its estimator is planned for.
pub(crate) fn look_along_slants(
    matcher: &DenseMatcher,
    eyes: &Binocular<EyeView<'_>>,
    search: SearchRange,
    workspace: &mut DenseWorkspace,
    field: &mut DisparityField,
) -> Result<(), WrongView> {
    let (params, size) = (matcher.params(), matcher.size());
    let steep = slants(&workspace.agreement, &matcher.waves(), field.dx.view());
    let mut pixels = size.area();
    for patch in steep_patches(&steep) {
        let ground = Ground::of(&patch, search, size);
        if let Some(rest) = pixels.checked_sub(ground.size().area()) {
            pixels = rest;
            ground.look((params, search), eyes, &patch, workspace, field)?;
        }
    }
    Ok(())
}

/// Where a patch is looked at.
struct Ground {
    /// The rows of both eyes.
    rows: Range<usize>,
    /// The columns of the left eye that are asked for.
    columns: Range<usize>,
    /// The columns that are cut out of both eyes, so that the search stays inside.
    cut: Range<usize>,
}

/// By how much rows are sheared: by nothing at the middle of a ground, by `down` pixels more with each row.
#[derive(Clone, Copy)]
struct Shear {
    down: f32,
    middle: f32,
}

impl Shear {
    /// In pixels, at a row of the whole picture.
    fn at(self, row: usize) -> f32 {
        self.down * (row as f32 - self.middle)
    }
}

/// What one eye shows on a ground.
struct Shown {
    luma: LumaImage,
    rgb: Option<Array2<[u8; 3]>>,
}

impl Shown {
    fn view(&self) -> EyeView<'_> {
        EyeView {
            luma: &self.luma,
            rgb: self.rgb.as_ref().map(|rgb| rgb.view()),
        }
    }
}

impl Ground {
    fn of(patch: &SteepPatch, search: SearchRange, size: Size) -> Self {
        let around = |range: &Range<usize>, most: usize| {
            range.start.saturating_sub(AROUND)..(range.end + AROUND).min(most)
        };
        let rows = around(&patch.rows, size.height);
        let columns = around(&patch.columns, size.width);
        let leftwards = (-search.least_dx()).max(0).unsigned_abs() as usize;
        let rightwards = search.most_dx().max(0).unsigned_abs() as usize;
        let cut =
            columns.start.saturating_sub(leftwards)..(columns.end + rightwards).min(size.width);
        Self { rows, columns, cut }
    }

    fn size(&self) -> Size {
        Size {
            width: self.cut.len(),
            height: self.rows.len(),
        }
    }

    /// Shears until the patch faces both eyes, and takes what is surer then.
    fn look(
        &self,
        (params, search): (DenseParams, SearchRange),
        eyes: &Binocular<EyeView<'_>>,
        patch: &SteepPatch,
        workspace: &mut DenseWorkspace,
        field: &mut DisparityField,
    ) -> Result<(), WrongView> {
        let looks = params.slants;
        let params = DenseParams {
            slants: 0,
            narrow_px: None,
            ..params
        };
        let planned = |params| {
            let Ok(matcher) = DenseMatcher::plan(params, self.size()) else {
                unreachable!("the same parameters are planned for the whole picture")
            };
            matcher
        };
        // Before the last look only the slant is asked for.
        let (quick, full) = (planned(params.coarse()), planned(params));
        let middle = (self.rows.start + self.rows.end) as f32 / 2.0;
        let mut shear = Shear {
            down: patch.down,
            middle,
        };
        let Some(left) = self.shown(&eyes.left, Shear { down: 0.0, middle }) else {
            return Ok(());
        };
        let mut found = DisparityField::default();
        let mut rest = f32::INFINITY;
        for look in 1..=looks {
            let right = self.shown(&eyes.right, shear);
            let (Some(right), Some(sheared)) = (right, self.sheared(search, shear)) else {
                return Ok(());
            };
            let views = Binocular {
                left: left.view(),
                right: right.view(),
            };
            if look == looks || rest.abs() < FACING {
                full.estimate_into(&views, sheared, workspace, &mut found)?;
                break;
            }
            quick.estimate_into(&views, sheared, workspace, &mut found)?;
            let left_over = slants(&workspace.agreement, &quick.waves(), found.dx.view());
            rest = RELAXATION * self.mean(&left_over, patch);
            shear.down = (shear.down + rest).clamp(-STEEPEST, STEEPEST);
        }
        self.take(&found, shear, search, field);
        Ok(())
    }

    /// The search among sheared shifts: all that those of the whole picture become on this ground. `None` where they
    /// are more than are counted.
    fn sheared(&self, search: SearchRange, shear: Shear) -> Option<SearchRange> {
        let (first, last) = (shear.at(self.rows.start), shear.at(self.rows.end - 1));
        let least = search.least_dx() as f32 - first.max(last);
        let most = search.most_dx() as f32 - first.min(last);
        SearchRange::new(least.floor() as i32, most.ceil() as i32).ok()
    }

    /// The mean slant of the blocks of this ground that begin in the patch.
    fn mean(&self, slants: &Array2<Slant>, patch: &SteepPatch) -> f32 {
        let inside = slants.indexed_iter().filter(|((row, column), _)| {
            patch.rows.contains(&(self.rows.start + row * BLOCK))
                && patch.columns.contains(&(self.cut.start + column * BLOCK))
        });
        Slant::mean(inside.map(|(_, slant)| *slant)).down
    }

    /// What an eye shows on this ground when its rows are sheared. `None` where samples are so large that what lies
    /// between them is not finite.
    fn shown(&self, eye: &EyeView<'_>, shear: Shear) -> Option<Shown> {
        let plane = eye.luma.plane();
        let last = plane.ncols() - 1;
        let luma = self.seen(shear, |y, x| cubic(|x| plane[[y, x]], x, last));
        let luma = LumaImage::new(luma).ok()?;
        let rgb = eye.rgb.map(|rgb| {
            let colour = |y, x, channel: usize| {
                let between = cubic(|x| f32::from(rgb[[y, x]][channel]), x, last);
                between.round() as u8
            };
            self.seen(shear, |y, x| [0, 1, 2].map(|channel| colour(y, x, channel)))
        });
        Some(Shown { luma, rgb })
    }

    /// A plane of this ground, of what there is at each row and sheared column of the whole picture.
    fn seen<T: Clone + Default + Send + Sync>(
        &self,
        shear: Shear,
        at: impl Fn(usize, f32) -> T + Sync,
    ) -> Array2<T> {
        let mut plane = Array2::default(self.size().dim());
        plane
            .axis_iter_mut(Axis(0))
            .into_par_iter()
            .zip(self.rows.clone())
            .for_each(|(mut row, y)| {
                let sheared = shear.at(y);
                for (sample, x) in row.iter_mut().zip(self.cut.clone()) {
                    *sample = at(y, x as f32 + sheared);
                }
            });
        plane
    }

    /// Takes over what is surer than what the field has.
    fn take(
        &self,
        found: &DisparityField,
        shear: Shear,
        search: SearchRange,
        field: &mut DisparityField,
    ) {
        let searched = search.least_dx() as f32 - 0.5..search.most_dx() as f32 + 0.5;
        for (row, y) in self.rows.clone().enumerate() {
            for x in self.columns.clone() {
                let (new, old) = ([row, x - self.cut.start], [y, x]);
                let dx = found.dx[new] + shear.at(y);
                let surer = !field.validity[old].is_valid()
                    || found.confidence[new] > field.confidence[old] + SURER;
                let differs = (dx - field.dx[old]).abs() >= SAME_PX;
                if found.validity[new].is_valid() && surer && differs && searched.contains(&dx) {
                    field.dx[old] = dx;
                    field.validity[old] = Validity::Valid;
                    field.confidence[old] = found.confidence[new];
                }
            }
        }
    }
}

/// A row between its samples, by Catmull and Rom's cubic; the last ones go on beyond its ends.
fn cubic(sample: impl Fn(usize) -> f32, x: f32, last: usize) -> f32 {
    let x = x.clamp(0.0, last as f32);
    let part = x - x.floor();
    let at = |step: isize| sample((x as usize).saturating_add_signed(step).min(last));
    let [a, b, c, d] = [at(-1), at(0), at(1), at(2)];
    let bend = 3.0 * (b - c) + d - a;
    b + 0.5 * part * (c - a + part * (2.0 * a - 5.0 * b + 4.0 * c - d + part * bend))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cubic goes through its samples, is exact for a parabola, and goes on level beyond the ends.
    #[test]
    fn a_parabola_between_its_samples() {
        let row: Vec<f32> = (0..12i16).map(|x| 0.1 * f32::from(x - 4).powi(2)).collect();
        let at = |x: f32| cubic(|x| row[x], x, row.len() - 1);
        for step in 20..200u8 {
            let x = f32::from(step) / 20.0;
            assert!((at(x) - 0.1 * (x - 4.0).powi(2)).abs() < 1e-5, "{x}");
        }
        assert_eq!(
            [at(-3.0), at(0.0), at(11.0), at(40.0)],
            [row[0], row[0], row[11], row[11]]
        );
    }

    /// What is cut out holds what the search leads to from every column that is asked for, inside the picture.
    #[test]
    fn a_ground_holds_its_search() {
        let size = Size {
            width: 300,
            height: 90,
        };
        let patch = SteepPatch {
            rows: 48..96,
            columns: 120..180,
            down: 0.5,
            blocks: 20,
        };
        let ground = Ground::of(&patch, SearchRange::new(-60, 5).unwrap(), size);
        assert_eq!(
            (ground.rows.clone(), ground.columns.clone()),
            (24..90, 96..204)
        );
        assert_eq!(ground.cut, 36..209);
        let shear = Shear {
            down: 0.5,
            middle: 57.0,
        };
        let sheared = ground
            .sheared(SearchRange::new(-60, 5).unwrap(), shear)
            .unwrap();
        // At the top -16.5 px, at the bottom 16 px.
        assert_eq!((sheared.least_dx(), sheared.most_dx()), (-76, 22));
    }
}
