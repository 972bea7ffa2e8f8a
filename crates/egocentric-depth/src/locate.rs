use v1_gabor::Size;

use crate::egocentric_scene::{LocatedObject, UnlocatedObject, WhyUnlocated};
use crate::robust_sample::{MEDIAN_OVER_MEAN, densest_half, median, robust_sigma};
use crate::{DepthMap, EgocentricScene, Label, LabelImage, StereoRig};

/// What [`locate`] asks of an object and presumes of the depths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocateParams {
    /// One standard deviation of a disparity, in pixels, for maps that do not know their own
    /// ([`DepthMap::disparity_sigma_px`]). It sets the uncertainty of each position,
    /// and no depth is taken for an outlier within three times what it explains.
    pub disparity_sigma_px: f64,
    /// One standard deviation of an object's median pixel along either axis: how well the label
    /// marks the object.
    pub label_sigma_px: f64,
    /// How many pixels with a known depth an object needs.
    pub least_reliable_pixels: usize,
}

impl Default for LocateParams {
    /// A quarter pixel is the mean error of the vector pyramid where its orientations agree, a
    /// pixel is what a hand-drawn outline keeps to in the mean, and sixteen pixels make a patch of
    /// four by four.
    fn default() -> Self {
        Self {
            disparity_sigma_px: 0.25,
            label_sigma_px: 1.0,
            least_reliable_pixels: 16,
        }
    }
}

/// Why nothing can be located.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotLocatable {
    /// The labels are not those of this depth map.
    #[error("a depth map of {depth} pixels cannot be read with labels of {labels}")]
    Sizes {
        /// Size of the depth map.
        depth: Size,
        /// Size of the label image.
        labels: Size,
    },
    /// A standard deviation is negative or not finite.
    #[error("a standard deviation of {0} px is none; it must be finite and not negative")]
    Sigma(f64),
}

/// Finds each labelled object's place from the known depths of its pixels.
///
/// The depth of an object is the median of those that agree: hand-drawn labels bleed over depth
/// edges, so depths that lie farther than three standard deviations from the densest half of the
/// label are left out. The position is the line of sight of the median agreeing pixel at that
/// depth, in the level observer frame. Pixels of unknown depth never move an object.
///
/// What a position may be off by has four sources: the disparities' own error, which neighbours share,
/// so that no number of pixels makes it smaller; the spread of the object's depths, which the number
/// of pixels does make smaller; the pixels that are left out, which may have lain on either side of the
/// median; and the label.
///
/// `rig` is the one the map was triangulated with. To demand a confidence of the depths, pass
/// [`DepthMap::only_confident`].
///
/// # Errors
/// [`NotLocatable`] if the sizes differ or a standard deviation cannot be. An object without
/// enough known depth is no error; it stands in [`EgocentricScene::unlocated`].
pub fn locate(
    depth: &DepthMap,
    labels: &LabelImage,
    rig: &StereoRig,
    params: &LocateParams,
) -> Result<EgocentricScene, NotLocatable> {
    let sizes = (depth.size(), labels.size());
    if sizes.0 != sizes.1 {
        return Err(NotLocatable::Sizes {
            depth: sizes.0,
            labels: sizes.1,
        });
    }
    for sigma_px in [params.disparity_sigma_px, params.label_sigma_px] {
        if !(sigma_px.is_finite() && sigma_px >= 0.0) {
            return Err(NotLocatable::Sigma(sigma_px));
        }
    }
    let mut scene = EgocentricScene::default();
    for evidence in gather(depth, labels, params) {
        match place(&evidence, rig, params) {
            Ok(object) => scene.objects.push(object),
            Err(reason) => scene.unlocated.push(UnlocatedObject {
                label: evidence.label,
                pixels: evidence.pixels,
                reliable_pixels: evidence.known.len(),
                reason,
            }),
        }
    }
    Ok(scene)
}

/// What the depth map says about one label.
struct Evidence {
    label: Label,
    pixels: usize,
    known: Vec<KnownPixel>,
}

#[derive(Clone, Copy)]
struct KnownPixel {
    x: u32,
    y: u32,
    depth_m: f32,
    sigma_px: f32,
}

/// One walk over the planes; the evidence comes by ascending label.
fn gather(depth: &DepthMap, labels: &LabelImage, params: &LocateParams) -> Vec<Evidence> {
    let sigma_px = depth.disparity_sigma_px();
    let mut evidence: Vec<Evidence> = labels
        .labels()
        .into_iter()
        .map(|label| Evidence {
            label,
            pixels: 0,
            known: Vec::new(),
        })
        .collect();
    let most = evidence.last().map_or(0, |last| last.label.0.get());
    let mut slot_of_label = vec![None; usize::from(most) + 1];
    for (slot, found) in evidence.iter().enumerate() {
        slot_of_label[usize::from(found.label.0.get())] = Some(slot);
    }
    for (((y, x), &number), &depth_m) in labels.plane().indexed_iter().zip(depth.metres()) {
        let Some(slot) = slot_of_label[usize::from(number)] else {
            continue;
        };
        let found = &mut evidence[slot];
        found.pixels += 1;
        if depth_m.is_finite() {
            found.known.push(KnownPixel {
                x: x as u32,
                y: y as u32,
                depth_m,
                sigma_px: sigma_px.map_or(params.disparity_sigma_px as f32, |plane| plane[[y, x]]),
            });
        }
    }
    evidence
}

/// The robust place of one object.
fn place(
    evidence: &Evidence,
    rig: &StereoRig,
    params: &LocateParams,
) -> Result<LocatedObject, WhyUnlocated> {
    // Without a single depth there is no median, however few the caller asks for.
    let needed = params.least_reliable_pixels.max(1);
    if evidence.known.len() < needed {
        return Err(WhyUnlocated::TooFewReliablePixels { needed });
    }
    let agreeing = without_outliers(&evidence.known, rig)?;
    let mut depths = depths_of(&agreeing);
    let depth_m = median(&mut depths);
    let spread_m = robust_sigma(&depths, depth_m);
    let pixel = median_pixel(&agreeing);
    let in_head = rig
        .back_project(pixel, depth_m)
        .ok_or(WhyUnlocated::NotInFront)?;

    // Errors of neighbouring disparities go together, so the mean over an object does not shrink
    // them; only what its own spread adds to the median does shrink with the number of pixels.
    let of_median_m = MEDIAN_OVER_MEAN * spread_m / (agreeing.len() as f64).sqrt();
    let of_left_out_m = left_out_sigma(&mut depths, evidence.pixels);
    let depth_sigma_m = rig
        .depth_sigma_m(in_head, median_sigma_px(&agreeing))
        .hypot(of_median_m)
        .hypot(of_left_out_m);
    // The pixels that are left out may lie on one side of the object as well as before or behind it.
    let pixel_sigma_px = [columns(&agreeing), rows(&agreeing)].map(|mut places| {
        left_out_sigma(&mut places, evidence.pixels).hypot(params.label_sigma_px)
    });
    Ok(LocatedObject {
        label: evidence.label,
        position: rig.to_observer(in_head),
        covariance_m2: covariance(rig, pixel, depth_m, depth_sigma_m, pixel_sigma_px)
            .ok_or(WhyUnlocated::NotInFront)?,
        pixel,
        depth_m,
        spread_m,
        pixels: evidence.pixels,
        reliable_pixels: evidence.known.len(),
        agreeing_pixels: agreeing.len(),
    })
}

/// How far the median of all pixels' depths, columns or rows may be from that of those that agree: one
/// standard deviation.
///
/// The part of those left out that lie below it may be anything from none to all, a uniform distribution
/// with a standard deviation of `1 / sqrt(12)`. With a part `u` of all left out, that moves the rank of
/// the median among those that agree by `u / (1 - u)` of it.
fn left_out_sigma(values: &mut [f64], pixels: usize) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len() - 1;
    let kept = values.len() as f64 / pixels as f64;
    let shift = ((1.0 - kept) / kept / 12f64.sqrt()).min(0.5);
    let at = |rank: f64| values[(rank * last as f64).round() as usize];
    (at(0.5 + shift) - at(0.5 - shift)) / 2.0
}

fn median_sigma_px(pixels: &[KnownPixel]) -> f64 {
    let mut sigmas: Vec<f64> = pixels
        .iter()
        .map(|pixel| f64::from(pixel.sigma_px))
        .collect();
    median(&mut sigmas)
}

/// The pixels within three standard deviations of the densest half of the depths.
///
/// The deviation is that half's own, but never less than what the disparity's noise explains at
/// that depth: a flat object has no spread of its own.
fn without_outliers(
    known: &[KnownPixel],
    rig: &StereoRig,
) -> Result<Vec<KnownPixel>, WhyUnlocated> {
    let mut depths = depths_of(known);
    depths.sort_unstable_by(f64::total_cmp);
    let (centre_m, own_sigma_m) = densest_half(&depths);
    let seen_at = rig
        .back_project(median_pixel(known), centre_m)
        .ok_or(WhyUnlocated::NotInFront)?;
    let noise_m = rig.depth_sigma_m(seen_at, median_sigma_px(known));
    let cutoff_m = 3.0 * own_sigma_m.max(noise_m);
    Ok(known
        .iter()
        .filter(|pixel| (f64::from(pixel.depth_m) - centre_m).abs() <= cutoff_m)
        .copied()
        .collect())
}

fn depths_of(pixels: &[KnownPixel]) -> Vec<f64> {
    pixels
        .iter()
        .map(|pixel| f64::from(pixel.depth_m))
        .collect()
}

fn median_pixel(pixels: &[KnownPixel]) -> (f64, f64) {
    (median(&mut columns(pixels)), median(&mut rows(pixels)))
}

fn columns(pixels: &[KnownPixel]) -> Vec<f64> {
    pixels.iter().map(|pixel| f64::from(pixel.x)).collect()
}

fn rows(pixels: &[KnownPixel]) -> Vec<f64> {
    pixels.iter().map(|pixel| f64::from(pixel.y)).collect()
}

/// The covariance of `origin + depth / D_z D(pixel)` in the observer frame, `D` being the line of
/// sight: one independent term for the depth and one for either axis of the pixel. What a lens
/// stretches a pixel's angle by is left out. `None` where the eye sees nothing.
fn covariance(
    rig: &StereoRig,
    pixel: (f64, f64),
    depth_m: f64,
    depth_sigma_m: f64,
    [across_px, down_px]: [f64; 2],
) -> Option<[[f64; 3]; 3]> {
    let eye = rig.eyes().left;
    let (fx, fy) = eye.intrinsics.focal_px;
    let sight = eye.ray(pixel)?.direction;
    let along = sight.map(|component| component / sight[2]);
    let per_pixel = |step: [f64; 3]| -> [f64; 3] {
        let turn = eye.rotation.apply(step);
        std::array::from_fn(|i| depth_m / sight[2] * (turn[i] - along[i] * turn[2]))
    };
    let terms = [
        (along, depth_sigma_m),
        (per_pixel([1.0 / fx, 0.0, 0.0]), across_px),
        (per_pixel([0.0, 1.0 / fy, 0.0]), down_px),
    ]
    .map(|(derivative, sigma)| {
        rig.head_to_observer()
            .apply(derivative)
            .map(|component| component * sigma)
    });
    Some(std::array::from_fn(|i| {
        std::array::from_fn(|j| terms.iter().map(|term| term[i] * term[j]).sum())
    }))
}
