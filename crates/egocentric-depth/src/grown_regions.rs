use std::cmp::Reverse;
use std::collections::BinaryHeap;

use ndarray::Array2;

use crate::joined_regions::Joints;

/// What a pixel shows, as far as its depth tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    /// Its depth is unknown.
    Unknown,
    /// The support plane.
    Support,
    /// Something above the visible part of the plane.
    Above,
    /// Something below the plane or beside it.
    Elsewhere,
}

/// The price of one pixel where the colours do not change.
const PIXEL: f32 = 16.0;

/// Regions grown over unknown pixels, and over such of the same depth that belong to no region, as far
/// as `reach_px`; the cheapest way to a pixel decides, and a change of colour makes a way dearer.
pub(crate) fn grow(
    mut regions: Array2<u32>,
    ground: &Array2<Ground>,
    joints: &Joints<'_>,
    reach_px: u16,
) -> Array2<u32> {
    let (height, width) = regions.dim();
    let most = u32::from(reach_px) * PIXEL as u32;
    // The last known parallax on the way to a pixel.
    let mut parallax = joints.parallax_px.to_owned();
    let mut price = regions.mapv(|region| if region > 0 { 0 } else { u32::MAX });
    // Ties go to the earlier pixel, so that the answer is one.
    let mut front: BinaryHeap<Reverse<(u32, usize)>> = regions
        .iter()
        .enumerate()
        .filter(|(_, region)| **region > 0)
        .map(|(at, _)| Reverse((0, at)))
        .collect();
    while let Some(Reverse((paid, at))) = front.pop() {
        let (x, y) = (at % width, at / width);
        if paid > price[[y, x]] {
            continue;
        }
        let beside = [
            (x.wrapping_sub(1), y),
            (x + 1, y),
            (x, y.wrapping_sub(1)),
            (x, y + 1),
        ];
        for (to_x, to_y) in beside {
            if to_x >= width || to_y >= height {
                continue;
            }
            let (here, there) = ([y, x], [to_y, to_x]);
            let fits = match ground[there] {
                Ground::Unknown => true,
                Ground::Above => {
                    let known = joints.parallax_px[there];
                    (known - parallax[here]).abs() <= joints.most_step_px(known)
                }
                Ground::Support | Ground::Elsewhere => false,
            };
            let sum = paid + (PIXEL * joints.weight((x, y), (to_x, to_y))) as u32;
            if fits && sum <= most && sum < price[there] {
                price[there] = sum;
                regions[there] = regions[here];
                if ground[there] == Ground::Unknown {
                    parallax[there] = parallax[here];
                }
                front.push(Reverse((sum, to_y * width + to_x)));
            }
        }
    }
    regions
}
