use crate::dense::path_step::MOST_PENALTY;

/// How the dense estimator works, one field an ingredient. The default is [`DenseParams::best`].
///
/// Costs are in units of the phase agreement: 0 where all orientations agree in phase, 1 where they
/// say nothing, 2 where all are opposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenseParams {
    /// What is compared at a pixel and a shift.
    pub cost: Cost,
    /// Energy (squared modulus, for images in `[0, 1]`) at which a response counts half: contrast
    /// below it fades out of the cost. `1e-3` ruins weak texture.
    pub silent_energy: f32,
    /// How much the responses to an opponent colour, red against cyan, count in the cost against those to luma,
    /// where the eyes see colours: what luma does not tell apart may be told by it. 0 compares luma alone, in
    /// two thirds of the time.
    pub opponent: f32,
    /// Energy, counted with that weight, at which a response to the opponent colour counts half: cameras
    /// see colours with more noise and less detail than luma.
    pub opponent_silent_energy: f32,
    /// Whether surfaces may end where the colour changes, or only where the luma does.
    pub colour: bool,
    /// How far beyond what a look at a quarter of the size finds around a pixel its own shift is searched,
    /// in pixels; `None` searches the whole range everywhere. The coarse look costs a sixty-fourth of a
    /// search of the whole range, and what only the fine one would have seen, such as a twig, may
    /// be missed.
    pub narrow_px: Option<u16>,
    /// What a path pays for a step of one pixel in shift: more makes slanted surfaces smoother, and
    /// in the end flat.
    pub small_step: f32,
    /// What a path pays for any larger step where the picture is smooth: more keeps surfaces
    /// together, and in the end joins them.
    pub large_step: f32,
    /// The step of the picture, in parts of the whole range of grey, at which a larger step of the
    /// shift costs a third: depth may end where colour does.
    pub edge_softness: f32,
    /// The noise of a picture, in parts of the whole range of grey, from which on it is smoothed before it says
    /// where surfaces end (the responses are not), responses are silent up to the noise, and steps cost less:
    /// 1 never does.
    pub noisy: f32,
    /// How the other eye's shifts are found for the look back.
    pub look_back: LookBack,
    /// How far the look back may miss, in pixels.
    pub left_right_px: f32,
    /// Patches of consistent shifts of fewer pixels than this are taken for chance; 0 keeps all.
    pub least_patch: usize,
    /// Rounds in which pixels without an answer take the shift that most of their surface has; 0
    /// asks no neighbour.
    pub votes: usize,
    /// Whether a 5 x 5 median smooths the filled field.
    pub median: bool,
    /// Which responses' phases refine the shift beyond the parabola through its costs (hyperacuity).
    pub acuity: Acuity,
    /// Half-width in pixels of the surface cells that fit a slanted plane about each pixel; 0 fits
    /// none.
    pub surface_radius: usize,
    /// Every so many pixels of a cell, along rows and columns, one is asked, and above 2 of these every
    /// second, as on the fields of one colour of a chessboard: neighbours know little that theirs do not.
    pub surface_stride: usize,
    /// Half-width in pixels of the neighbourhood whose colours say, where two surfaces meet, which of
    /// them a pixel is on; 0 leaves depth edges where the filters see them, which is a little beyond the
    /// end of what has more contrast.
    pub choice_radius: usize,
    /// Every so many pixels of that neighbourhood, along rows and columns, one is asked: 2 takes a quarter
    /// of the time that 1 does.
    pub choice_stride: usize,
    /// How often what phases tell to be steep is looked at again, with the right eye's rows sheared against its
    /// slant: a floor that falls by a pixel a row is lost to steps of whole pixels. What is cut out for
    /// it is at most one picture in all, and only the last look is a full one. Told by the codes of
    /// [`Cost::PhaseAgreement`] alone; 0 never looks again.
    pub slants: usize,
}

/// What is compared at a pixel and a shift.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// The agreement of the normalised responses: the energy of position-shifted binocular cells.
    PhaseAgreement,
    /// Only the quadrants of the phases, two bits an orientation: a byte a pixel, compared by
    /// counting the bits that differ.
    PhaseQuadrants,
}

/// How the other eye's shifts are found for the look back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookBack {
    /// By an aggregation of its own, along the surfaces that it sees: twice the time.
    OwnPaths,
    /// From the sums of the left eye's paths.
    SamePaths,
}

/// Which responses' phases refine the shift.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acuity {
    /// None: the parabola through the three best costs stands.
    Parabola,
    /// The responses that the cost is made of, four orientations of 7 taps: as they are coded for it by
    /// [`Cost::PhaseAgreement`].
    CostBank,
    /// Two banks of eight orientations, of 7 and of 11 taps.
    TwoBanks,
}

impl DenseParams {
    /// For measurement: every ingredient.
    #[must_use]
    pub const fn best() -> Self {
        Self {
            cost: Cost::PhaseAgreement,
            silent_energy: 3e-7,
            opponent: 1.5,
            opponent_silent_energy: 1e-4,
            colour: true,
            narrow_px: None,
            small_step: 1.0,
            large_step: 15.0,
            edge_softness: 0.014,
            noisy: 0.011,
            look_back: LookBack::OwnPaths,
            left_right_px: 1.1,
            least_patch: 30,
            votes: 3,
            median: true,
            acuity: Acuity::TwoBanks,
            surface_radius: 13,
            surface_stride: 2,
            choice_radius: 9,
            choice_stride: 1,
            slants: 8,
        }
    }

    /// For robots: one aggregation for both eyes, luma alone and grey guides, the cost's own bank for
    /// hyperacuity, one round of votes, smaller surface cells, and few neighbours that choose surfaces.
    #[must_use]
    pub const fn fast() -> Self {
        Self {
            silent_energy: 5e-7,
            opponent: 0.0,
            colour: false,
            narrow_px: Some(6),
            small_step: 1.02,
            large_step: 12.5,
            edge_softness: 0.012,
            noisy: 1.0,
            look_back: LookBack::SamePaths,
            left_right_px: 1.0,
            least_patch: 50,
            votes: 1,
            acuity: Acuity::CostBank,
            surface_radius: 9,
            surface_stride: 3,
            choice_radius: 6,
            choice_stride: 2,
            slants: 0,
            ..Self::best()
        }
    }
}

/// A parameter of the dense estimator that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {value} cannot be: {need}")]
pub struct BadDenseParam {
    /// Name of the field of [`DenseParams`].
    pub name: &'static str,
    /// Its value.
    pub value: f32,
    /// What it must be.
    pub need: &'static str,
}

impl DenseParams {
    /// Those of a look at a quarter of the size that narrows the search, and of one that asks for a slant: it says
    /// where surfaces are, and no more.
    pub(crate) const fn coarse(self) -> Self {
        Self {
            narrow_px: None,
            look_back: LookBack::SamePaths,
            votes: 0,
            acuity: Acuity::Parabola,
            surface_radius: 0,
            choice_radius: 0,
            slants: 0,
            least_patch: self.least_patch / 4,
            median: false,
            ..self
        }
    }

    /// Checks what the fields promise.
    pub(crate) fn check(&self) -> Result<(), BadDenseParam> {
        let within = |name, value: f32, least: f32, most: f32, need| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(BadDenseParam { name, value, need })
            }
        };
        within(
            "silent_energy",
            self.silent_energy,
            0.0,
            f32::MAX,
            "not negative, and finite",
        )?;
        within("opponent", self.opponent, 0.0, 100.0, "from 0 to 100")?;
        within(
            "opponent_silent_energy",
            self.opponent_silent_energy,
            0.0,
            f32::MAX,
            "not negative, and finite",
        )?;
        within(
            "small_step",
            self.small_step,
            0.0,
            MOST_PENALTY,
            "from 0 to 50",
        )?;
        within(
            "large_step",
            self.large_step,
            0.0,
            MOST_PENALTY,
            "from 0 to 50",
        )?;
        within(
            "edge_softness",
            self.edge_softness,
            f32::MIN_POSITIVE,
            f32::MAX,
            "positive, and finite",
        )?;
        within("noisy", self.noisy, 0.0, 1.0, "from 0 to 1")?;
        within(
            "left_right_px",
            self.left_right_px,
            0.0,
            f32::MAX,
            "not negative, and finite",
        )?;
        within(
            "surface_radius",
            self.surface_radius as f32,
            0.0,
            64.0,
            "from 0 to 64",
        )?;
        within(
            "choice_radius",
            self.choice_radius as f32,
            0.0,
            64.0,
            "from 0 to 64",
        )?;
        within(
            "surface_stride",
            self.surface_stride as f32,
            1.0,
            64.0,
            "from 1 to 64",
        )?;
        within(
            "choice_stride",
            self.choice_stride as f32,
            1.0,
            64.0,
            "from 1 to 64",
        )?;
        within("slants", self.slants as f32, 0.0, 64.0, "from 0 to 64")
    }
}

impl Default for DenseParams {
    fn default() -> Self {
        Self::best()
    }
}
