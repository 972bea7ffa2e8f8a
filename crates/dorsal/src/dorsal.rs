use allocentric_qsr::{DepthReference, QualifyParams, QualitativeScene};
use disparity_pyramid::{EyeView, MatchParams};
use egocentric_depth::{LabelImage, LocateParams, StereoRig, locate, triangulate};
use v1_gabor::{Binocular, FilterBank, LumaImage};

use crate::{Error, Estimator, Names, Percept, sightings};

/// The dorsal stream: everything a look needs that is the same from one look to the next.
///
/// Its fields are plain values of the levels; exchange any of them between looks.
#[derive(Clone, Debug)]
pub struct Dorsal {
    /// The filters of level 1, planned for one size of image.
    pub bank: FilterBank,
    /// How level 2 matches the eyes.
    pub matching: MatchParams,
    /// Which estimator of level 2 looks.
    pub estimator: Estimator,
    /// Where the eyes are and which way they look.
    pub rig: StereoRig,
    /// What level 3 asks of an object.
    pub locating: LocateParams,
    /// The distance classes of level 4.
    pub reference: DepthReference,
    /// How level 4 turns numbers into symbols.
    pub qualifying: QualifyParams,
}

impl Dorsal {
    /// Looks once: from what two eyes see to the depth of every pixel, the place of every labelled
    /// object and the relations between them.
    ///
    /// `labels` belong to the left image; `names` gives the labels' names.
    ///
    /// # Errors
    /// [`Error`] carries the refusal of the first level that refused.
    pub fn look(
        &self,
        eyes: &Binocular<LumaImage>,
        labels: &LabelImage,
        names: &Names,
    ) -> Result<Percept, Error> {
        let (disparity, starts) = match self.estimator {
            Estimator::Vector(range) => {
                let responses = eyes.as_ref().try_map(|eye| self.bank.respond(eye))?;
                let found = range.disparity(&responses, self.matching)?;
                (found.field, found.starts)
            }
            Estimator::Dense(dense) => {
                let views = eyes.as_ref().map(EyeView::grey);
                let field = dense.disparity(&views, &self.rig, &self.bank, self.matching)?;
                (field, Vec::new())
            }
        };
        let sigma_px = self.estimator.disparity_sigma().of(&disparity);
        let depth = triangulate(&disparity, &self.rig).with_disparity_sigma(sigma_px)?;
        let egocentric = locate(&depth, labels, &self.rig, &self.locating)?;
        let qualitative = QualitativeScene::qualify_with(
            sightings(&egocentric, names),
            &self.reference,
            self.qualifying,
        )?;
        Ok(Percept {
            disparity,
            starts,
            depth,
            egocentric,
            qualitative,
        })
    }
}
