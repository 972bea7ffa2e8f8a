use dorsal::v1_gabor::{MonogenicPlanes, Responses};
use ndarray::{Array2, Array3, Array4, Axis, stack};
use stereo_formats::{NotAPng, npy, picture, v1_picture};

use crate::outputs::Outputs;

/// How far a response may change, in half widths of its band, before its phase means nothing:
/// Fleet and Jepson's choice.
const TAU: f32 = 1.25;

/// Adds the files of one scale of oriented responses.
pub(crate) fn response_files<'a>(files: &mut Outputs<'a>, scale: usize, responses: &'a Responses) {
    let orientations = responses.orientations();
    let (height, width) = responses.size().dim();
    let mut add = Scale { files, scale };

    add.npy("responses", move || {
        let shape = (orientations, height, width);
        let array = Array3::from_shape_fn(shape, |(q, y, x)| responses.at(q, x, y));
        npy::encode(array.view())
    });
    for q in 0..orientations {
        add.png(format!("orientation{q}"), move || {
            v1_picture::response(responses, q)
        });
    }
    add.png("responses", || {
        v1_picture::by_orientation(v1_picture::responses(responses))
    });
    add.npy("energy", || {
        npy::encode(v1_picture::total_energy(responses).view())
    });
    add.png("energy", || {
        v1_picture::energy(&v1_picture::total_energy(responses))
    });
    add.npy("dominant", || {
        let dominant = responses.dominant_orientation();
        together(&[dominant.theta_rad, dominant.strength])
    });
    add.png("dominant", || {
        v1_picture::dominant_orientation(&responses.dominant_orientation())
    });
    add.npy("frequency", move || {
        let mut array = Array4::zeros((orientations, 2, height, width));
        for (q, mut both) in array.outer_iter_mut().enumerate() {
            let frequency = responses.instantaneous_frequency(q);
            both.index_axis_mut(Axis(0), 0).assign(&frequency.along_x);
            both.index_axis_mut(Axis(0), 1).assign(&frequency.along_y);
        }
        npy::encode(array.view())
    });
    add.png("frequency", || {
        v1_picture::instantaneous_frequency(responses, TAU)
    });
    add.npy("singular", move || {
        let mut array = Array3::from_elem((orientations, height, width), false);
        for (q, mut plane) in array.outer_iter_mut().enumerate() {
            plane.assign(&responses.singularities(q, TAU));
        }
        npy::encode(array.view())
    });
    add.png("singular", || v1_picture::singularities(responses, TAU));
}

/// Adds the files of the phase congruency over all scales.
pub(crate) fn congruency_files<'a>(files: &mut Outputs<'a>, congruency: &'a Array2<f32>) {
    files.add("congruency.npy", || {
        anyhow::Ok(npy::encode(congruency.view()))
    });
    files.add("congruency.png", || {
        picture::encode_rgb(v1_picture::phase_congruency(congruency).view())
    });
}

/// Adds the files of one scale of the monogenic signal.
pub(crate) fn monogenic_files<'a>(
    files: &mut Outputs<'a>,
    scale: usize,
    planes: &'a MonogenicPlanes,
) {
    let mut add = Scale { files, scale };
    add.npy("monogenic", || {
        together(&[planes.even(), planes.along_x(), planes.along_y()].map(|part| part.to_owned()))
    });
    add.png("monogenic", || v1_picture::monogenic_parts(planes));
    add.npy("local", || {
        let dim = planes.size().dim();
        let at = |(y, x)| planes.at(x, y);
        together(&[
            Array2::from_shape_fn(dim, |pixel| at(pixel).amplitude()),
            Array2::from_shape_fn(dim, |pixel| at(pixel).phase()),
            Array2::from_shape_fn(dim, |pixel| at(pixel).theta_rad().unwrap_or(f32::NAN)),
        ])
    });
    add.png("phase", || v1_picture::monogenic_phase(planes));
    add.png("orientation", || v1_picture::monogenic_orientation(planes));
}

/// Planes of one size as an array with one axis more in front.
fn together(planes: &[Array2<f32>]) -> Vec<u8> {
    let views: Vec<_> = planes.iter().map(|plane| plane.view()).collect();
    let stacked = stack(Axis(0), &views).expect("the planes of one scale have one size");
    npy::encode(stacked.view())
}

/// The files of one scale, under their common name.
struct Scale<'f, 'a> {
    files: &'f mut Outputs<'a>,
    scale: usize,
}

impl<'a> Scale<'_, 'a> {
    fn npy(&mut self, what: &str, encode: impl FnOnce() -> Vec<u8> + Send + 'a) {
        let name = format!("scale{}_{what}.npy", self.scale);
        self.files.add(name, move || anyhow::Ok(encode()));
    }

    fn png(&mut self, what: impl AsRef<str>, draw: impl FnOnce() -> Array2<[u8; 3]> + Send + 'a) {
        let name = format!("scale{}_{}.png", self.scale, what.as_ref());
        self.files.add(name, move || -> Result<_, NotAPng> {
            picture::encode_rgb(draw().view())
        });
    }
}
