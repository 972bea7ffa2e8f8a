/// How two eyes are matched. The default is the robust pyramid, [`MatchParams::as_published`] the
/// paper's own steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchParams {
    /// Least energy (squared modulus, for images in `[0, 1]` and filters of unit gain) that an
    /// orientation must have in both eyes to be heard. The paper's value is `1e-6`: a grating of
    /// half a grey level in 256. `1e-7` hears weak textures too: a quarter more pixels answer on
    /// Venus, and the best guess everywhere errs by a fifth less.
    pub energy_threshold: f32,
    /// Where the search starts, in pixels of the image: the shift `(dx, dy)` that the coarsest
    /// scale takes for granted. `(0, 0)` is the paper's, a pair of eyes that fixate the scene.
    pub zero_disparity_px: (f32, f32),
    /// Warps at each scale but the finest. One warp falls short of the whole residual by about 8 %,
    /// since natural images have a mean instantaneous frequency below the peak frequency.
    pub warps: usize,
    /// Warps at the finest scale; a second one takes 2 to 8 % off the error of the best guess and nothing
    /// off that of the valid pixels.
    pub finest_warps: usize,
    /// At how many of the finest scales every second pixel of every second row is fitted, in place of
    /// every one. A filter sees a patch several pixels wide, so that neighbours say nearly the same;
    /// those between take the mean of the ones beside them, or the surer one's shift where these are
    /// two surfaces'. With 2 the whole takes three fifths of the time that it does with 0, and as the
    /// medians reach twice as far with as many values, it errs less on most scenes (`docs/ablation.md`).
    pub sparse_scales: usize,
    /// Rounds of robust reweighting of the orientations in each least-squares fit; 0 is the plain
    /// fit of equation 3.
    pub robust_rounds: usize,
    /// Median filters over valid neighbours after the last warp of a scale; after the others there
    /// is one (none if this is 0).
    pub medians: usize,
    /// Half-width of the median filters, in pixels: 1 is 3 x 3, 2 is 5 x 5.
    pub median_radius: MedianRadius,
    /// At how many of the finest scales the slope of the coarser scale's shifts is followed, up to
    /// 0.7 px a pixel: the right eye's filters are stretched by it, as the surface is stretched in its image, and
    /// medians bring neighbours to the place that asks along it. At the finest scale slopes from 0.02 on
    /// are followed, at the others from 0.15 on. Without the stretch
    /// the error of either component grows by two fifths of a pixel times its slope: 0.024 px at a slope of
    /// 0.06, in place of 0.009 to 0.018. At the finest alone, rendered tables that slant by half a pixel
    /// a row err by 0.2 px, and by 0.11 with all scales, which takes an eighth more time.
    /// [`estimate_monogenic`](crate::estimate_monogenic) and
    /// [`estimate_population`](crate::estimate_population) do not stretch.
    pub slanted_scales: usize,
    /// Least agreement of the orientations' phases with the fitted shift, from -1 (none heard) to
    /// 1; below it a pixel keeps what the coarser scale said.
    pub least_coherence: f32,
    /// Weight of the coarser scale's vertical shift against the phases', relative to all of them.
    /// Eyes on one baseline see little vertical disparity, and it varies slowly.
    pub vertical_prior: f32,
    /// Of the 3 x 3 pixels around a place at the second finest scale, how many at least have to be
    /// [`Incoherent`](crate::Validity::Incoherent) there to take its answer at the finest away. Where the search is lost,
    /// few answers agree with the phases at both scales by chance
    /// (`docs/level-2.md`, "Medians along a slope"). `None` takes nothing away.
    pub contradictions: Option<usize>,
    /// Least number of valid pixels among the 5 x 5 around a pixel without an answer of its own that
    /// make their median its answer; `None` leaves every such pixel unknown.
    pub fill_neighbours: Option<usize>,
    /// How far the way there and back may miss its start, in pixels; `None` asks one way only.
    pub left_right_px: Option<f32>,
    /// The scale at which the way back is found, 0 being the image's own. At 1 the default takes two
    /// fifths of the warps for it that 0 would.
    pub look_back_scale: usize,
    /// Warps at each scale of the way back, no more than there are on the way there. One in place of two
    /// takes a tenth off the time and leaves 1.8 % of the pixels fewer valid on the mean of thirteen
    /// scenes, most of them where the range is large and the way back is then lost itself.
    pub look_back_warps: usize,
    /// Least number of pixels of a patch of answers, of which neighbours differ by at most a pixel in
    /// `dx`; smaller ones are chance and become [`Inconsistent`](crate::Validity::Inconsistent). Where
    /// the search got lost, by a range too large or a surface too steep, a few per cent of the pixels
    /// still find a match that leads there and back, and their errors are as large as the range.
    pub least_patch: usize,
    /// Whether the vertical component is held at [`zero_disparity_px`](Self::zero_disparity_px)'s,
    /// for pairs whose rows are known to correspond: each fit then has one unknown,
    /// `dx = sum_q w_q k_x phase_q / sum_q w_q k_x^2`. It takes .01 to .03 px off the error of valid
    /// textured pixels on Venus, Sawtooth and Tsukuba.
    pub rows_only: bool,
    /// Unhears the neighbourhoods of phase singularities of either eye at every scale, beyond which
    /// a phase means nothing: the `tau` of
    /// [`Responses::singularities`](v1_gabor::Responses::singularities), 1.25 being strict and 1.75
    /// lenient. Where fewer than three orientations stay, a pixel is
    /// [`Singular`](crate::Validity::Singular). `None` hears every response above the energy
    /// threshold.
    ///
    /// With the paper's own steps, 1.75 takes 18, 13 and 9 % off the error of valid textured pixels on
    /// Venus, Sawtooth and Tsukuba and 5, 3 and 9 % of their number. With the default's robust weights
    /// and coherence, which refuse most of what it refuses, it puts 1 to 16 % on that error, and finding
    /// the singularities takes ten times as long as matching: so the default is `None`.
    pub singularity_tau: Option<f32>,
    /// Whether the field carries the covariance of each shift ([`ShiftCovariance`]), which takes an
    /// eighth of the time on top.
    ///
    /// [`ShiftCovariance`]: crate::ShiftCovariance
    pub covariance: bool,
}

/// The width of a median filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MedianRadius {
    /// 3 x 3 pixels.
    One,
    /// 5 x 5 pixels.
    Two,
}

impl Default for MatchParams {
    fn default() -> Self {
        Self {
            energy_threshold: 1e-7,
            zero_disparity_px: (0.0, 0.0),
            warps: 2,
            finest_warps: 1,
            sparse_scales: 2,
            robust_rounds: 1,
            medians: 2,
            median_radius: MedianRadius::Two,
            slanted_scales: 16,
            least_coherence: 0.82,
            vertical_prior: 0.1,
            contradictions: Some(6),
            fill_neighbours: Some(11),
            left_right_px: Some(1.5),
            look_back_scale: 1,
            look_back_warps: 2,
            least_patch: 400,
            rows_only: false,
            singularity_tau: None,
            covariance: false,
        }
    }
}

impl MatchParams {
    /// The paper's own steps: one warp a scale, a plain fit, one 3 x 3 median, no prior, no
    /// look back.
    #[must_use]
    pub fn as_published() -> Self {
        Self {
            energy_threshold: 1e-6,
            warps: 1,
            finest_warps: 1,
            sparse_scales: 0,
            slanted_scales: 0,
            robust_rounds: 0,
            medians: 1,
            median_radius: MedianRadius::One,
            least_coherence: -1.0,
            vertical_prior: 0.0,
            contradictions: None,
            fill_neighbours: None,
            left_right_px: None,
            least_patch: 0,
            ..Self::default()
        }
    }
}
