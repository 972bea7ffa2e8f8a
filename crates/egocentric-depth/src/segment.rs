use std::collections::BTreeSet;

use ndarray::{Array2, ArrayView2, Zip, s};
use v1_gabor::Size;

use crate::appearance::Contrast;
use crate::footprint::Footprint;
use crate::grown_regions::{Ground, grow};
use crate::joined_regions::{Joints, join};
use crate::rotation::{cross, dot};
use crate::support_plane::parallax_of_a_metre;
use crate::{
    DepthMap, Head, LabelImage, NoSupport, Position, StereoRig, SupportParams, SupportPlane,
};

/// What [`segment`] takes for an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentParams {
    /// The plane that objects stand on.
    pub support: SupportParams,
    /// How high above the plane a surface has to be to be an object's, in metres.
    pub least_height_m: f64,
    /// One standard deviation of a disparity, in pixels: heights within three of it lie on the plane.
    pub disparity_sigma_px: f64,
    /// How far the foot of a surface may be outside of the plane's visible part, in metres.
    pub margin_m: f64,
    /// Between neighbours of one object depth changes by no more than this, in metres; where the colours
    /// change too, by less.
    pub gap_m: f32,
    /// The same in pixels of disparity, where that is more: no step so small tells two surfaces apart.
    pub step_px: f32,
    /// The change of colour, of 1 from black to white, that halves both.
    pub colour_step: f32,
    /// How far a region grows over pixels of unknown depth, in pixels, fewer where the colours change.
    pub reach_px: u16,
    /// How many pixels an object has, as a part of the image.
    pub least_part: f64,
}

impl Default for SegmentParams {
    /// For objects of centimetres on a table; `cargo xtask eval-segment` says what it finds.
    fn default() -> Self {
        Self {
            support: SupportParams::default(),
            least_height_m: 0.012,
            disparity_sigma_px: 0.25,
            margin_m: 0.01,
            gap_m: 0.015,
            step_px: 1.0,
            colour_step: 0.25,
            reach_px: 8,
            least_part: 5e-4,
        }
    }
}

/// Why a view falls into no objects.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotSegmentable {
    /// The picture is not that of this depth map.
    #[error("a depth map of {depth} pixels cannot be divided by the colours of {picture}")]
    Sizes {
        /// Size of the depth map.
        depth: Size,
        /// Size of the picture.
        picture: Size,
    },
    /// Nothing to stand on.
    #[error(transparent)]
    NoSupport(#[from] NoSupport),
}

/// Objects that were found without labels.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// Which object each pixel shows: 1, 2, ... from left to right, 0 for none.
    pub labels: LabelImage,
    /// What they stand on.
    pub support: SupportPlane,
}

/// Divides a view into the objects that stand on a plane.
///
/// The support plane is found first ([`SupportPlane::find`]). What is above it and over its visible
/// part falls into connected regions: neighbours belong together unless their depths part, and where
/// the colours change a smaller step of depth parts them. The regions then grow over the
/// pixels beside them whose depth is unknown, not far, and less so across changes of colour.
///
/// `rgb` is the left picture, `[[y, x]]`; one without colours has three equal channels. `rig` is the one
/// the map was triangulated with. A view with a plane and nothing on it has no objects, which is no
/// error.
///
/// # Errors
/// [`NotSegmentable`] if the sizes differ or no plane is found.
pub fn segment(
    depth: &DepthMap,
    rgb: ArrayView2<'_, [u8; 3]>,
    rig: &StereoRig,
    params: &SegmentParams,
) -> Result<Segmentation, NotSegmentable> {
    let sizes = (depth.size(), Size::of_dim(rgb.dim()));
    if sizes.0 != sizes.1 {
        return Err(NotSegmentable::Sizes {
            depth: sizes.0,
            picture: sizes.1,
        });
    }
    let support = SupportPlane::find(depth, rig, &params.support)?;
    let places = places(depth, rig);
    let parallax = places.mapv(|place| {
        place.map_or(f32::NAN, |place| {
            (parallax_of_a_metre(rig) / place.z_m) as f32
        })
    });
    let ground = ground(&places, &support, rig, params);
    let contrast = Contrast::of(rgb);
    let joints = Joints {
        parallax_px: parallax.view(),
        contrast: &contrast,
        of_a_metre_px: parallax_of_a_metre(rig) as f32,
        gap_m: params.gap_m,
        step_px: params.step_px,
        colour_step: params.colour_step,
    };
    let least = params.least_part * sizes.0.area() as f64;
    let regions = join(&ground, &joints);
    // A region that is too small by itself may still be a part of its neighbour.
    let regions = only_large(regions, least / 2.0);
    let regions = grow(regions, &ground, &joints, params.reach_px);
    let regions = only_narrow(only_large(regions, least));
    Ok(Segmentation {
        labels: LabelImage::new(from_left_to_right(&regions)),
        support,
    })
}

/// Where the surface of every pixel lies; `None` where its depth is unknown.
fn places(depth: &DepthMap, rig: &StereoRig) -> Array2<Option<Position<Head>>> {
    let eye = rig.eyes().left;
    let mut places = Array2::from_elem(depth.size().dim(), None);
    Zip::indexed(&mut places)
        .and(depth.metres())
        .par_for_each(|(y, x), place, &z_m| {
            if z_m.is_finite() {
                *place = eye.at_depth((x as f64, y as f64), f64::from(z_m));
            }
        });
    places
}

/// What every pixel shows.
fn ground(
    places: &Array2<Option<Position<Head>>>,
    support: &SupportPlane,
    rig: &StereoRig,
    params: &SegmentParams,
) -> Array2<Ground> {
    let scale = parallax_of_a_metre(rig);
    // One pixel of disparity is `z^2 / (f b)` of depth.
    let per_px = |place: Position<Head>| {
        (support.height_per_depth(place) * place.z_m * place.z_m / scale).abs()
    };
    let axes = axes(support.up());
    let foot = |place: Position<Head>| axes.map(|axis| dot(axis, place.to_array()));
    let lies = places.mapv(|place| {
        place.map(|place| support.height_m(place).abs() <= params.support.off_px * per_px(place))
    });
    // An outline needs no more than every third row and column.
    let some = places
        .indexed_iter()
        .filter(|((y, x), _)| y % 3 == 0 && x % 3 == 0);
    let visible =
        some.filter_map(|((y, x), place)| is_broad(&lies, (x, y)).then_some(foot((*place)?)));
    let footprint = Footprint::about(visible.collect());
    let mut ground = Array2::from_elem(places.dim(), Ground::Unknown);
    Zip::from(&mut ground)
        .and(places)
        .par_for_each(|ground, place| {
            let Some(place) = *place else { return };
            let height_m = support.height_m(place);
            let noise_m = 3.0 * params.disparity_sigma_px * per_px(place);
            *ground = if height_m.abs() <= params.least_height_m.max(noise_m) {
                Ground::Support
            } else if height_m > 0.0 && footprint.holds(foot(place), params.margin_m) {
                Ground::Above
            } else {
                Ground::Elsewhere
            };
        });
    ground
}

/// Two directions along a plane, square to each other.
fn axes(up: [f64; 3]) -> [[f64; 3]; 2] {
    let across = cross(up, [0.0, 0.0, 1.0]);
    let length = dot(across, across).sqrt();
    // A plane that faces the head straight has any axes.
    let across = if length > 1e-6 {
        across.map(|component| component / length)
    } else {
        [1.0, 0.0, 0.0]
    };
    [across, cross(up, across)]
}

/// Whether the plane is seen at a pixel and all around it. A wall crosses the plane in a line, which is
/// not.
fn is_broad(lies: &Array2<Option<bool>>, (x, y): (usize, usize)) -> bool {
    const REACH: usize = 4;
    if lies[[y, x]] != Some(true) {
        return false;
    }
    let around = |at: usize, length: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(length);
    let (height, width) = lies.dim();
    let window = lies.slice(s![around(y, height), around(x, width)]);
    let known = window.iter().flatten().count();
    let on = window.iter().flatten().filter(|lies| **lies).count();
    5 * on > 4 * known
}

/// Regions of at least so many pixels, the others given up; 0 is no region.
fn only_large(mut regions: Array2<u32>, least: f64) -> Array2<u32> {
    let sizes = sizes(&regions);
    regions.mapv_inplace(|region| {
        if f64::from(sizes[region as usize]) < least {
            0
        } else {
            region
        }
    });
    regions
}

/// Regions that do not reach from one side of the picture to the other, the others given up: what does is no
/// thing on the table but what ends the view behind it, such as the foot of a wall.
fn only_narrow(mut regions: Array2<u32>) -> Array2<u32> {
    let sides = [regions.column(0), regions.column(regions.ncols() - 1)];
    let [left, right] = sides.map(|side| side.iter().copied().collect::<BTreeSet<u32>>());
    regions.mapv_inplace(|region| {
        if left.contains(&region) && right.contains(&region) {
            0
        } else {
            region
        }
    });
    regions
}

fn sizes(regions: &Array2<u32>) -> Vec<u32> {
    let most = regions.iter().copied().max().unwrap_or(0);
    let mut sizes = vec![0u32; most as usize + 1];
    for &region in regions {
        sizes[region as usize] += 1;
    }
    sizes
}

/// The regions as labels from 1 in the order of their middle columns.
fn from_left_to_right(regions: &Array2<u32>) -> Array2<u16> {
    let sizes = sizes(regions);
    let mut columns = vec![0u64; sizes.len()];
    for ((_, x), &region) in regions.indexed_iter() {
        columns[region as usize] += x as u64;
    }
    let mut order: Vec<usize> = (1..sizes.len())
        .filter(|&region| sizes[region] > 0)
        .collect();
    order.sort_by(|&a, &b| {
        let middle = |region: usize| columns[region] as f64 / f64::from(sizes[region]);
        middle(a).total_cmp(&middle(b))
    });
    let mut label = vec![0u16; sizes.len()];
    for (place, region) in order.into_iter().enumerate() {
        // An image has no room for more regions than labels: each has a part of its pixels.
        label[region] = u16::try_from(place + 1).unwrap_or(0);
    }
    regions.mapv(|region| label[region as usize])
}
