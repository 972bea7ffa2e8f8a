use std::num::NonZeroU16;
use std::ops::Range;

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
    let mut scene = EgocentricScene::default();
    let mut workspace = LocateWorkspace::default();
    locate_into(depth, labels, rig, params, (&mut workspace, &mut scene))?;
    Ok(scene)
}

/// Buffers that [`locate_into`] works in, kept from look to look: about 40 bytes for every pixel that bears
/// a label.
#[derive(Clone, Debug, Default)]
pub struct LocateWorkspace {
    /// How many pixels bear each number that there can be, and then where the next of them goes.
    count_of_label: Vec<u32>,
    objects: Vec<LabelledPixels>,
    /// The pixels with a known depth, object by object, in the order of the rows.
    known: Vec<KnownPixel>,
    agreeing: Vec<KnownPixel>,
    keys: Vec<u32>,
    numbers: Vec<f64>,
}

/// The same, written over what an earlier look found, in buffers that are kept.
///
/// # Errors
/// [`NotLocatable`] as [`locate`]; the scene stays as it is then.
pub fn locate_into(
    depth: &DepthMap,
    labels: &LabelImage,
    rig: &StereoRig,
    params: &LocateParams,
    (workspace, scene): (&mut LocateWorkspace, &mut EgocentricScene),
) -> Result<(), NotLocatable> {
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
    workspace.gather(depth, labels, params);
    scene.objects.clear();
    scene.unlocated.clear();
    for object in 0..workspace.objects.len() {
        let labelled = workspace.objects[object].clone();
        match workspace.place(&labelled, rig, params) {
            Ok(object) => scene.objects.push(object),
            Err(reason) => scene.unlocated.push(UnlocatedObject {
                label: labelled.label,
                pixels: labelled.pixels,
                reliable_pixels: labelled.known.len(),
                reason,
            }),
        }
    }
    Ok(())
}

/// Which pixels bear one label.
#[derive(Clone, Debug)]
struct LabelledPixels {
    label: Label,
    pixels: usize,
    /// Where its known pixels lie among all.
    known: Range<usize>,
}

#[derive(Clone, Copy, Debug)]
struct KnownPixel {
    x: u32,
    y: u32,
    depth_m: f32,
    sigma_px: f32,
}

/// Makes room for so many, and for as many again as may come with the next look, so that an object that
/// grows by a pixel asks for no memory.
fn make_room<T>(buffer: &mut Vec<T>, needed: usize) {
    buffer.clear();
    if buffer.capacity() < needed {
        buffer.reserve_exact(needed.next_power_of_two());
    }
}

impl LocateWorkspace {
    /// What the depth map says about each label, by ascending label: one walk over the labels to count
    /// them, one to take their depths.
    fn gather(&mut self, depth: &DepthMap, labels: &LabelImage, params: &LocateParams) {
        let Self {
            count_of_label,
            objects,
            known,
            agreeing,
            keys,
            numbers,
        } = self;
        count_of_label.clear();
        count_of_label.resize(usize::from(u16::MAX) + 1, 0);
        for &number in labels.plane() {
            count_of_label[usize::from(number)] += 1;
        }
        objects.clear();
        let (mut first, mut most) = (0, 0);
        for number in 1..=u16::MAX {
            let count = &mut count_of_label[usize::from(number)];
            if let (1.., Some(number)) = (*count, NonZeroU16::new(number)) {
                let pixels = *count as usize;
                objects.push(LabelledPixels {
                    label: Label(number),
                    pixels,
                    known: first..first,
                });
                *count = first as u32;
                first += pixels;
                most = most.max(pixels);
            }
        }
        make_room(known, first);
        let silent = KnownPixel {
            x: 0,
            y: 0,
            depth_m: 0.0,
            sigma_px: 0.0,
        };
        known.resize(first, silent);
        make_room(agreeing, most);
        make_room(keys, most);
        make_room(numbers, most);
        let sigma_px = depth.disparity_sigma_px();
        let (labels, depth) = (labels.plane(), depth.metres());
        for (y, (labels, depth)) in labels.rows().into_iter().zip(depth.rows()).enumerate() {
            for (x, (&number, &depth_m)) in labels.iter().zip(depth).enumerate() {
                if number == 0 || !depth_m.is_finite() {
                    continue;
                }
                let next = &mut count_of_label[usize::from(number)];
                known[*next as usize] = KnownPixel {
                    x: x as u32,
                    y: y as u32,
                    depth_m,
                    sigma_px: sigma_px
                        .map_or(params.disparity_sigma_px as f32, |plane| plane[[y, x]]),
                };
                *next += 1;
            }
        }
        for object in objects {
            let number = usize::from(object.label.0.get());
            object.known.end = count_of_label[number] as usize;
        }
    }

    /// The robust place of one object.
    fn place(
        &mut self,
        labelled: &LabelledPixels,
        rig: &StereoRig,
        params: &LocateParams,
    ) -> Result<LocatedObject, WhyUnlocated> {
        let Self {
            known,
            agreeing,
            keys,
            numbers,
            ..
        } = self;
        let known = &known[labelled.known.clone()];
        // Without a single depth there is no median, however few the caller asks for.
        let needed = params.least_reliable_pixels.max(1);
        if known.len() < needed {
            return Err(WhyUnlocated::TooFewReliablePixels { needed });
        }
        let (centre_m, cutoff_m) = outliers_beyond(known, rig, (keys, numbers))?;
        agreeing.clear();
        let agree = |pixel: &&KnownPixel| (f64::from(pixel.depth_m) - centre_m).abs() <= cutoff_m;
        agreeing.extend(known.iter().filter(agree));
        let agreeing: &[KnownPixel] = agreeing;
        let depth_m = median(of_all(agreeing, DEPTH, numbers));
        let spread_m = robust_sigma(of_all(agreeing, DEPTH, numbers), depth_m);
        let pixel = median_pixel(agreeing, numbers);
        let in_head = rig
            .back_project(pixel, depth_m)
            .ok_or(WhyUnlocated::NotInFront)?;

        // Errors of neighbouring disparities go together, so the mean over an object does not shrink
        // them; only what its own spread adds to the median does shrink with the number of pixels.
        let of_median_m = MEDIAN_OVER_MEAN * spread_m / (agreeing.len() as f64).sqrt();
        let of_left_out_m = left_out_sigma(of_all(agreeing, DEPTH, numbers), labelled.pixels);
        let depth_sigma_m = rig
            .depth_sigma_m(in_head, median(of_all(agreeing, SIGMA, numbers)))
            .hypot(of_median_m)
            .hypot(of_left_out_m);
        // The pixels that are left out may lie on one side of the object as well as before or behind it.
        let pixel_sigma_px = [COLUMN, ROW].map(|side| {
            left_out_sigma(of_all(agreeing, side, numbers), labelled.pixels)
                .hypot(params.label_sigma_px)
        });
        Ok(LocatedObject {
            label: labelled.label,
            position: rig.to_observer(in_head),
            covariance_m2: covariance(rig, pixel, depth_m, depth_sigma_m, pixel_sigma_px)
                .ok_or(WhyUnlocated::NotInFront)?,
            pixel,
            depth_m,
            spread_m,
            pixels: labelled.pixels,
            reliable_pixels: known.len(),
            agreeing_pixels: agreeing.len(),
        })
    }
}

/// How far the median of all pixels' depths, columns or rows may be from that of those that agree: one
/// standard deviation. It reorders the values.
///
/// The part of those left out that lie below it may be anything from none to all, a uniform distribution
/// with a standard deviation of `1 / sqrt(12)`. With a part `u` of all left out, that moves the rank of
/// the median among those that agree by `u / (1 - u)` of it.
fn left_out_sigma(values: &mut [f64], pixels: usize) -> f64 {
    let last = values.len() - 1;
    let kept = values.len() as f64 / pixels as f64;
    let shift = ((1.0 - kept) / kept / 12f64.sqrt()).min(0.5);
    let mut at = |rank: f64| {
        let rank = (rank * last as f64).round() as usize;
        *values.select_nth_unstable_by(rank, f64::total_cmp).1
    };
    (at(0.5 + shift) - at(0.5 - shift)) / 2.0
}

/// The centre of the densest half of the depths, and how far from it a depth is an outlier: three standard
/// deviations.
///
/// The deviation is that half's own, but never less than what the disparity's noise explains at
/// that depth: a flat object has no spread of its own.
fn outliers_beyond(
    known: &[KnownPixel],
    rig: &StereoRig,
    (keys, numbers): (&mut Vec<u32>, &mut Vec<f64>),
) -> Result<(f64, f64), WhyUnlocated> {
    keys.clear();
    // Depths are positive, so that their bits are in their own order, and faster to sort.
    keys.extend(known.iter().map(|pixel| pixel.depth_m.to_bits()));
    keys.sort_unstable();
    numbers.clear();
    numbers.extend(keys.iter().map(|&bits| f64::from(f32::from_bits(bits))));
    let (centre_m, own_sigma_m) = densest_half(numbers);
    let seen_at = rig
        .back_project(median_pixel(known, numbers), centre_m)
        .ok_or(WhyUnlocated::NotInFront)?;
    let noise_m = rig.depth_sigma_m(seen_at, median(of_all(known, SIGMA, numbers)));
    Ok((centre_m, 3.0 * own_sigma_m.max(noise_m)))
}

/// One number of a pixel.
type Number = fn(&KnownPixel) -> f64;

const DEPTH: Number = |pixel| f64::from(pixel.depth_m);
const SIGMA: Number = |pixel| f64::from(pixel.sigma_px);
const COLUMN: Number = |pixel| f64::from(pixel.x);
const ROW: Number = |pixel| f64::from(pixel.y);

/// That number of all pixels.
fn of_all<'a>(pixels: &[KnownPixel], number: Number, numbers: &'a mut Vec<f64>) -> &'a mut [f64] {
    numbers.clear();
    numbers.extend(pixels.iter().map(number));
    numbers
}

fn median_pixel(pixels: &[KnownPixel], numbers: &mut Vec<f64>) -> (f64, f64) {
    let column = median(of_all(pixels, COLUMN, numbers));
    (column, median(of_all(pixels, ROW, numbers)))
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
