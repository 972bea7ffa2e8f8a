//! Several pictures side by side on one sheet, each over its number, to be seen at one look.

use ndarray::{Array2, ArrayView2, s};

use crate::scale_bar::{NUMBER_HEIGHT, write_number};

const MARGIN: usize = 4;
const PAPER: [u8; 3] = [255; 3];

/// A picture and the number that stands under it, such as an angle in degrees.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Digits, points and minus signs; nothing else is drawn.
    pub number: String,
    /// The picture `[[y, x]]`.
    pub picture: Array2<[u8; 3]>,
}

/// The sheet of these pictures, row by row, at most `columns` to a row.
///
/// Pictures wider or higher than `most` pixels are shrunk by the whole factor that makes them fit,
/// and every cell is as large as the largest one.
#[must_use]
pub fn sheet(tiles: &[Tile], columns: usize, most: usize) -> Array2<[u8; 3]> {
    let columns = columns.clamp(1, tiles.len().max(1));
    let pictures: Vec<_> = tiles
        .iter()
        .map(|tile| shrunk(tile.picture.view(), most.max(1)))
        .collect();
    let width = pictures.iter().map(Array2::ncols).max().unwrap_or(0);
    let height = pictures.iter().map(Array2::nrows).max().unwrap_or(0);
    let cell = (MARGIN + height + 2 + NUMBER_HEIGHT, MARGIN + width);
    let rows = tiles.len().div_ceil(columns);
    let dim = (rows * cell.0 + MARGIN, columns * cell.1 + MARGIN);
    let mut sheet = Array2::from_elem(dim, PAPER);
    for (place, (tile, picture)) in tiles.iter().zip(&pictures).enumerate() {
        let top = MARGIN + place / columns * cell.0;
        let left = MARGIN + place % columns * cell.1;
        let (rows, columns) = picture.dim();
        sheet
            .slice_mut(s![top..top + rows, left..left + columns])
            .assign(picture);
        write_number(&mut sheet, &tile.number, (left, top + height + 2));
    }
    sheet
}

/// The picture, its sides divided by the least whole number that brings both to `most` pixels:
/// means over squares, of which the last may be cut off.
fn shrunk(picture: ArrayView2<'_, [u8; 3]>, most: usize) -> Array2<[u8; 3]> {
    let (height, width) = picture.dim();
    let factor = width.max(height).div_ceil(most).max(1);
    let dim = (height.div_ceil(factor), width.div_ceil(factor));
    Array2::from_shape_fn(dim, |(y, x)| {
        let (top, left) = (y * factor, x * factor);
        let square = picture.slice(s![
            top..(top + factor).min(height),
            left..(left + factor).min(width)
        ]);
        let count = square.len() as u32;
        [0, 1, 2].map(|channel| {
            let sum: u32 = square.iter().map(|rgb| u32::from(rgb[channel])).sum();
            ((sum + count / 2) / count) as u8
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(width: usize, height: usize, grey: u8) -> Tile {
        Tile {
            number: "22.5".to_owned(),
            picture: Array2::from_elem((height, width), [grey; 3]),
        }
    }

    #[test]
    fn every_picture_has_its_place() {
        let tiles = [tile(20, 10, 1), tile(20, 10, 2), tile(20, 10, 3)];
        let sheet = sheet(&tiles, 2, 100);
        let cell = (MARGIN + 10 + 2 + NUMBER_HEIGHT, MARGIN + 20);
        assert_eq!(sheet.dim(), (2 * cell.0 + MARGIN, 2 * cell.1 + MARGIN));
        assert_eq!(sheet[[MARGIN, MARGIN]], [1; 3]);
        assert_eq!(sheet[[MARGIN, MARGIN + cell.1]], [2; 3]);
        assert_eq!(sheet[[MARGIN + cell.0, MARGIN]], [3; 3]);
        assert_eq!(sheet[[MARGIN + cell.0, MARGIN + cell.1]], PAPER);
    }

    #[test]
    fn large_and_slender_pictures_fit() {
        let sheet = sheet(&[tile(10_000, 2, 7)], 4, 320);
        assert_eq!(sheet.dim().1, 313 + 2 * MARGIN);
        assert_eq!(sheet[[MARGIN, MARGIN + 312]], [7; 3]);
        assert_eq!(super::sheet(&[], 4, 320).dim(), (MARGIN, 2 * MARGIN));
    }

    #[test]
    fn shrinking_takes_means() {
        let picture = Array2::from_shape_fn((2, 4), |(_, x)| [if x % 2 == 0 { 10 } else { 20 }; 3]);
        assert_eq!(
            shrunk(picture.view(), 2),
            Array2::from_elem((1, 2), [15; 3])
        );
    }
}
