use egocentric_depth::LabelImage;
use ndarray::{Array2, ArrayView2, s};

/// How many pixels of a picture make one of the sheet, along either side.
const SHRINK: usize = 3;

/// Levels of grey between two that the sheet tells apart: noise that nobody sees makes most of its bytes.
const STEP: u8 = 8;

/// Several labellings of one picture on one sheet, two beside each other: the picture in grey, each
/// label in a colour of its own. A pixel of the sheet has the mean grey of its block and the label of the
/// block's middle.
pub(crate) fn label_sheet(rgb: ArrayView2<'_, [u8; 3]>, all: &[&LabelImage]) -> Array2<[u8; 3]> {
    let (height, width) = (rgb.nrows() / SHRINK, rgb.ncols() / SHRINK);
    let rows = all.len().div_ceil(2);
    Array2::from_shape_fn((rows * height, 2 * width), |(y, x)| {
        let place = y / height * 2 + x / width;
        let (y, x) = (y % height * SHRINK, x % width * SHRINK);
        let block = rgb.slice(s![y..y + SHRINK, x..x + SHRINK]);
        let grey: f32 = block.iter().map(|&pixel| luma(pixel)).sum();
        let grey = f32::from((grey / block.len() as f32) as u8 / STEP * STEP);
        let middle = [y + SHRINK / 2, x + SHRINK / 2];
        let label = all.get(place).map_or(0, |labels| labels.plane()[middle]);
        if label == 0 {
            return [(0.7 * grey) as u8; 3];
        }
        colour(label).map(|ink| (0.55 * ink + 0.45 * grey) as u8)
    })
}

fn luma(pixel: [u8; 3]) -> f32 {
    let [red, green, blue] = pixel.map(f32::from);
    0.299 * red + 0.587 * green + 0.114 * blue
}

/// Hues that lie apart for neighbouring labels: the golden angle never comes back near where it was.
fn colour(label: u16) -> [f32; 3] {
    let hue = (0.381_966 * f32::from(label)).fract() * 6.0;
    [5.0f32, 3.0, 1.0].map(|channel| {
        let along = (channel + hue) % 6.0;
        let dip = along.min(4.0 - along).clamp(0.0, 1.0);
        245.0 * (1.0 - 0.85 * dip)
    })
}
