use allocentric_qsr::{DepthReference, QualifyParams, QualitativeScene};
use disparity_pyramid::{DisparityField, EyeView, FromVotes, MatchParams, Start};
use egocentric_depth::{LabelImage, LocateParams, StereoRig, locate_into, triangulate_into};
use v1_gabor::{Binocular, FilterBank, LumaImage, V1Responses, WrongSize};

use crate::{Error, Estimator, EstimatorWorkspace, LookWorkspace, Names, Percept, sightings};

/// The dorsal stream: everything a look needs that is the same from one look to the next.
///
/// Its fields are plain values of the levels; exchange any of them between looks: what a change makes
/// necessary is planned anew, and nothing else.
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
    /// What is planned and worked in from look to look; begins as the default.
    pub workspace: LookWorkspace,
}

impl Dorsal {
    /// Looks once: from what two eyes see to the depth of every pixel, the place of every labelled
    /// object and the relations between them.
    ///
    /// `labels` belong to the left image; `names` gives the labels' names. Who looks again and again
    /// asks [`look_into`](Self::look_into).
    ///
    /// # Errors
    /// [`Error`] carries the refusal of the first level that refused.
    pub fn look(
        &self,
        eyes: &Binocular<LumaImage>,
        labels: &LabelImage,
        names: &Names,
    ) -> Result<Percept, Error> {
        let mut percept = Percept::default();
        let mut workspace = LookWorkspace::default();
        self.see(eyes, labels, names, (&mut workspace, &mut percept))?;
        Ok(percept)
    }

    /// Looks again, written over an earlier percept: the bits of [`look`](Self::look). From the second look
    /// on nothing is planned again, and nothing larger than a page is allocated, with the vector pyramid over
    /// a range that is given, and with
    /// [`DenseParams::fast`](disparity_pyramid::DenseParams::fast) along rows that correspond.
    ///
    /// # Errors
    /// [`Error`] carries the refusal of the first level that refused; of the percept the levels below
    /// that are the new look's then.
    pub fn look_into(
        &mut self,
        eyes: &Binocular<LumaImage>,
        labels: &LabelImage,
        names: &Names,
        percept: &mut Percept,
    ) -> Result<(), Error> {
        let mut workspace = std::mem::take(&mut self.workspace);
        let seen = self.see(eyes, labels, names, (&mut workspace, percept));
        self.workspace = workspace;
        seen
    }

    /// The responses of both eyes at every scale, for who wants those themselves: a look makes them where
    /// they are needed and does not hold them.
    ///
    /// # Errors
    /// [`WrongSize`] if an image has another size than the bank was planned for.
    pub fn respond(
        &self,
        eyes: &Binocular<LumaImage>,
    ) -> Result<Binocular<V1Responses>, WrongSize> {
        eyes.as_ref().try_map(|eye| self.bank.respond(eye))
    }

    /// The four levels, one line each; a line consumes only what the lines above it made.
    fn see(
        &self,
        eyes: &Binocular<LumaImage>,
        labels: &LabelImage,
        names: &Names,
        (workspace, percept): (&mut LookWorkspace, &mut Percept),
    ) -> Result<(), Error> {
        let Percept {
            disparity,
            starts,
            depth,
            egocentric,
            qualitative,
        } = percept;
        let LookWorkspace {
            estimator,
            sigma,
            locate,
        } = workspace;
        self.disparity(eyes, estimator, (disparity, starts))?;
        let own = self.estimator.disparity_sigma();
        triangulate_into(disparity, &self.rig, &own, sigma, depth);
        locate_into(
            depth,
            labels,
            &self.rig,
            &self.locating,
            (locate, egocentric),
        )?;
        *qualitative = QualitativeScene::qualify_with(
            sightings(egocentric, names),
            &self.reference,
            self.qualifying,
        )?;
        Ok(())
    }

    /// Levels 1 and 2: the disparity of every pixel, and where the vector pyramid's search began.
    fn disparity(
        &self,
        eyes: &Binocular<LumaImage>,
        workspace: &mut EstimatorWorkspace,
        (disparity, starts): (&mut DisparityField, &mut Vec<Start>),
    ) -> Result<(), Error> {
        match self.estimator {
            Estimator::Vector(range) => {
                let mut found = FromVotes {
                    field: std::mem::take(disparity),
                    starts: std::mem::take(starts),
                    scales: 0,
                };
                let matcher = workspace.vector(&self.bank, self.matching)?;
                let seen = range.disparity_into(eyes, matcher, &mut found);
                (*disparity, *starts) = (found.field, found.starts);
                Ok(seen?)
            }
            Estimator::Dense(dense) => {
                let views = eyes.as_ref().map(EyeView::grey);
                let vector = (&self.bank, self.matching);
                starts.clear();
                dense.disparity_into(&views, &self.rig, vector, (workspace, disparity))
            }
        }
    }
}
