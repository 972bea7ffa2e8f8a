use dorsal::egocentric_depth::StereoRig;
use dorsal::v1_gabor::Binocular;
use ndarray::Array2;
use stereo_formats::picture::Picture;

use crate::objects::Objects;
use crate::true_object::TrueObject;

/// A pair of pictures of which the truth is known.
#[derive(Debug)]
pub(crate) struct DemoScene {
    /// The name of its folder.
    pub(crate) name: &'static str,
    /// What it is, in a sentence.
    pub(crate) title: &'static str,
    pub(crate) eyes: Binocular<Picture>,
    pub(crate) rig: StereoRig,
    pub(crate) objects: Objects,
    /// The nearest and the farthest depth that the search has to reach, in metres.
    pub(crate) span_m: (f64, f64),
    /// The true disparity `[[y, x]]` in the sign of files, NaN where unknown.
    pub(crate) true_d: Array2<f32>,
    pub(crate) truth: Vec<TrueObject>,
    pub(crate) promise: Promise,
}

/// What a look at a scene must get right.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Promise {
    /// The depth of every object, within this part of the true one.
    DepthWithin {
        /// The part, such as 0.05.
        part: f64,
    },
    /// The depth of every object up to a distance within a number of metres, every egocentric
    /// relation and every published one.
    DepthAndRelations {
        /// How far a depth may be off, in metres.
        within_m: f64,
        /// For objects whose true depth is at most this, in metres.
        up_to_m: f64,
    },
}

impl Promise {
    /// Whether a depth is as promised; `None` where nothing is.
    pub(crate) fn keeps(self, depth_m: f64, true_m: f64) -> Option<bool> {
        let off_m = (depth_m - true_m).abs();
        match self {
            Self::DepthWithin { part } => Some(off_m <= part * true_m),
            Self::DepthAndRelations { within_m, up_to_m } => {
                (true_m <= up_to_m).then_some(off_m <= within_m)
            }
        }
    }

    /// The bound of the depths, for a sentence.
    pub(crate) fn depth_bound(self) -> String {
        match self {
            Self::DepthWithin { part } => format!("within {:.0} %", 100.0 * part),
            Self::DepthAndRelations { within_m, up_to_m } => {
                format!("within {:.0} cm (up to {up_to_m} m)", 100.0 * within_m)
            }
        }
    }

    /// Whether relations are promised too.
    pub(crate) const fn has_relations(self) -> bool {
        matches!(self, Self::DepthAndRelations { .. })
    }
}
