use dorsal::egocentric_depth::{Label, LabelImage};
use ndarray::{Array2, ArrayView2};

/// The left picture in grey with every object in a colour of its own: tinted, its outline full.
pub(crate) fn label_picture(
    picture: ArrayView2<'_, [u8; 3]>,
    labels: &LabelImage,
) -> Array2<[u8; 3]> {
    let present = labels.labels();
    let order = |label: Label| present.iter().position(|&other| other == label);
    Array2::from_shape_fn(picture.dim(), |(y, x)| {
        let [red, green, blue] = picture[[y, x]].map(f32::from);
        let grey = 0.299 * red + 0.587 * green + 0.114 * blue;
        let Some((label, order)) = labels
            .at(x, y)
            .and_then(|label| Some((label, order(label)?)))
        else {
            // Darker than the objects, so that these stand out.
            return [(0.65 * grey) as u8; 3];
        };
        let colour = colour(order);
        let share = if borders(labels, label, (x, y)) {
            1.0
        } else {
            0.45
        };
        colour.map(|ink| (share * ink + (1.0 - share) * grey).round() as u8)
    })
}

/// A colour for the object of this number: neighbours in order lie far apart on the wheel, because
/// the golden angle never comes back near where it was.
fn colour(order: usize) -> [f32; 3] {
    let hue = (0.381_966 * order as f32).fract() * 6.0;
    // Offsets of the three channels on the wheel of hues, at nearly full brightness.
    [5.0f32, 3.0, 1.0].map(|channel| {
        let along = (channel + hue) % 6.0;
        let dip = along.min(4.0 - along).clamp(0.0, 1.0);
        245.0 * (1.0 - 0.85 * dip)
    })
}

/// Whether a pixel within two of this one shows something else.
fn borders(labels: &LabelImage, label: Label, (x, y): (usize, usize)) -> bool {
    let near = |at: usize| at.saturating_sub(2)..=at + 2;
    near(y).any(|row| near(x).any(|column| labels.at(column, row) != Some(label)))
}
