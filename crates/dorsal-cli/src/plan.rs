use anyhow::Context as _;
use dorsal::allocentric_qsr::{DepthReference, Inference, Mode, QualifyParams, QualitativeScene};
use dorsal::disparity_pyramid::{DisparityField, EyeView, FromVotes, MatchParams, RowAlignment};
use dorsal::egocentric_depth::{
    EgocentricScene, LocateParams, NoOrientation, OrientationParams, RelativeOrientation,
    SegmentParams, Segmentation, StereoRig, locate_into, relative_orientation, segment,
    triangulate_into,
};
use dorsal::v1_gabor::{Binocular, FilterBank, GaborParams};
use dorsal::{DenseLook, Estimator, Names, Range, RectifiedEyes, Rows, sightings};
use stereo_formats::picture::Picture;

use crate::console::Console;
use crate::look_room::LookRoom;
use crate::objects::Objects;
use crate::searched::Searched;
use crate::sight::{Scene, Sight};
use crate::times::Times;

/// How to look: the parameters of every level, and what is known of the eyes and the objects.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) estimator: Estimator,
    pub(crate) gabor: GaborParams,
    pub(crate) matching: MatchParams,
    pub(crate) rig: Option<StereoRig>,
    /// Whether depth is taken with the rig as the look itself says it is.
    pub(crate) recalibrate: bool,
    /// The objects, if they are known.
    pub(crate) objects: Option<Objects>,
    /// How objects are found in the depth, if they are to be.
    pub(crate) segmenting: Option<SegmentParams>,
    pub(crate) locating: LocateParams,
    pub(crate) reference: DepthReference,
    pub(crate) qualifying: QualifyParams,
}

/// What level 2 tells.
struct Matched {
    disparity: DisparityField,
    /// The same eyes matched for their drift, if that is to be corrected.
    vertical: Option<DisparityField>,
    searched: Searched,
}

impl Plan {
    /// Looks once, as far as the plan goes: disparity, with a rig depth, with objects their places
    /// and relations.
    ///
    /// This is `Dorsal::look` step by step, because a clock runs beside each level and because a
    /// pair without a rig has no depth.
    pub(crate) fn look(
        &self,
        eyes: &Binocular<Picture>,
        room: &mut LookRoom,
        times: &mut Times,
        console: &Console,
    ) -> anyhow::Result<Sight> {
        let Matched {
            disparity,
            vertical,
            searched,
        } = match self.estimator {
            Estimator::Vector(range) => self.vector(range, eyes, room, times, console)?,
            Estimator::Dense(dense) => Matched {
                disparity: self.dense(dense, eyes, room, times, console)?,
                vertical: None,
                searched: Searched::given(self.gabor.scales, &self.matching),
            },
        };

        let drift = self.drift(vertical.as_ref().unwrap_or(&disparity), times);
        let rig = match (&self.rig, &drift) {
            (Some(rig), Some(Ok(found))) if self.recalibrate => Some(
                rig.drifted(&found.drift)
                    .and_then(|rig| rig.with_sigma(found.standard_error))
                    .context("the rig cannot have drifted as the pictures say")?,
            ),
            _ => self.rig,
        };

        console.step("triangulating");
        let depth = rig.map(|rig| {
            let mut depth = std::mem::take(&mut room.depth);
            let sigma = self.estimator.disparity_sigma();
            times.measure("depth", || {
                triangulate_into(&disparity, &rig, &sigma, &mut room.sigma, &mut depth);
            });
            depth
        });

        let (objects, segmented) = match (&rig, &depth, &self.segmenting) {
            (Some(rig), Some(depth), Some(params)) => {
                console.step("finding the objects");
                let rgb = eyes.left.rgb();
                let found = times.measure("segments", || segment(depth, rgb, rig, params));
                match found {
                    Ok(Segmentation { labels, support }) => {
                        let names = Names::new();
                        (Some(Objects { labels, names }), Some(Ok(support)))
                    }
                    Err(reason) => (None, Some(Err(reason))),
                }
            }
            _ => (self.objects.clone(), None),
        };

        console.step("relating the objects");
        let scene = match (&rig, &depth, &objects) {
            (Some(rig), Some(depth), Some(objects)) => Some(times.measure("relations", || {
                let mut egocentric = EgocentricScene::default();
                let scene = (&mut room.locate, &mut egocentric);
                locate_into(depth, &objects.labels, rig, &self.locating, scene)?;
                let qualitative = QualitativeScene::qualify_with(
                    sightings(&egocentric, &objects.names),
                    &self.reference,
                    self.qualifying,
                )?;
                anyhow::Ok(Scene {
                    published: Inference::of_scene(&qualitative, Mode::Published),
                    egocentric,
                    qualitative,
                })
            })),
            _ => None,
        };
        Ok(Sight {
            disparity,
            searched,
            rig,
            drift,
            depth,
            objects,
            segmented,
            scene: scene.transpose().context("the objects cannot be placed")?,
        })
    }

    /// How the right eye has slipped from where the rig has it, as the vertical disparities say; the
    /// dense estimator has none.
    fn drift(
        &self,
        disparity: &DisparityField,
        times: &mut Times,
    ) -> Option<Result<RelativeOrientation, NoOrientation>> {
        let told = matches!(self.estimator, Estimator::Vector(_)) && !self.matching.rows_only;
        let rig = self.rig.filter(|_| told)?;
        // A tenth of what a calibration takes: neighbours tell little that is new.
        const MATCHES: usize = 2000;
        let params = OrientationParams {
            matches: MATCHES,
            ..OrientationParams::of(&rig)
        };
        Some(times.measure("drift", || relative_orientation(disparity, &rig, &params)))
    }

    /// The vector pyramid's disparity, and where it searched. Where depth is to be taken without the drift
    /// the eyes are matched once more for it: the look's own field has less of it than there is.
    fn vector(
        &self,
        range: Range,
        eyes: &Binocular<Picture>,
        room: &mut LookRoom,
        times: &mut Times,
        console: &Console,
    ) -> anyhow::Result<Matched> {
        let lumas = eyes.as_ref().map(Picture::luma);
        let bank = FilterBank::plan(self.gabor, lumas.left.size())
            .context("the pictures cannot be filtered")?;
        let mut found = std::mem::take(&mut room.found);
        console.step("matching the eyes");
        times
            .measure("disparity", || {
                let matcher = room.estimator.vector(&bank, self.matching)?;
                range.disparity_into(&lumas, matcher, &mut found)
            })
            .context("the eyes cannot be matched")?;
        let searched = Searched::of(&found, &self.matching);
        let orienting = MatchParams {
            zero_disparity_px: self.matching.zero_disparity_px,
            ..OrientationParams::matching()
        };
        let vertical = self.recalibrate.then(|| {
            console.step("matching the eyes for their drift");
            let mut found = FromVotes::default();
            times
                .measure("vertical", || {
                    let matcher = room.orienting.vector(&bank, orienting)?;
                    range.disparity_into(&lumas, matcher, &mut found)
                })
                .context("the eyes cannot be matched")?;
            anyhow::Ok(found.field)
        });
        Ok(Matched {
            disparity: found.field,
            vertical: vertical.transpose()?,
            searched,
        })
    }

    /// The dense estimator's disparity.
    fn dense(
        &self,
        dense: DenseLook,
        eyes: &Binocular<Picture>,
        room: &mut LookRoom,
        times: &mut Times,
        console: &Console,
    ) -> anyhow::Result<DisparityField> {
        let size = eyes.left.size();
        let views = eyes.as_ref().map(|eye| EyeView {
            luma: eye.luma(),
            rgb: Some(eye.rgb()),
        });
        let rectified = match (dense.rows, &self.rig) {
            (Rows::Rectified, Some(rig)) => {
                console.step("rectifying what the eyes see");
                let rectified = times.measure("rectifying", || room.estimator.rectify(&views, rig));
                Some(rectified.context("the pictures cannot be rectified")?)
            }
            _ => None,
        };
        let views = rectified.as_ref().map_or(views, RectifiedEyes::views);
        console.step("finding the range of disparities");
        let preparation = times.measure("preparation", || {
            let bank = FilterBank::plan(self.gabor, size)?;
            let vector = (&bank, self.matching);
            anyhow::Ok(dense.prepare_in(&views, vector, &mut room.estimator)?)
        });
        let preparation = preparation.context("the dense estimator cannot be prepared")?;
        let search = preparation.search;
        console.note(&format!(
            "disparities from {} to {} px are tried",
            -search.most_dx(),
            -search.least_dx()
        ));
        if let Some(rows) = &preparation.rows {
            let residual_px = rows.residual_px();
            console.note(&format!(
                "rows aligned; a vertical disparity of {residual_px:.2} px is left (RMS)"
            ));
            if residual_px > RowAlignment::MOST_RESIDUAL_PX {
                console.note(&format!(
                    "that is more than {} px: a line a row does not describe this rig, and \
                     matches will be missed",
                    RowAlignment::MOST_RESIDUAL_PX
                ));
            }
        }

        console.step("matching the eyes");
        let mut field = std::mem::take(&mut room.found.field);
        times
            .measure("disparity", || {
                dense.look_into(&views, &preparation, (&mut room.estimator, &mut field))
            })
            .context("the eyes cannot be matched")?;
        let Some(rectified) = rectified else {
            return Ok(field);
        };
        let mut taken = std::mem::take(&mut room.taken);
        times.measure("carrying back", || {
            rectified.as_taken_into(&field, &mut taken)
        })?;
        room.found.field = field;
        room.estimator.give_back(rectified);
        Ok(taken)
    }
}
