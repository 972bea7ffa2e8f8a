use anyhow::Context as _;
use dorsal::disparity_pyramid::{DisparityField, Validity};
use dorsal::egocentric_depth::{DepthMap, StereoRig, triangulate};
use dorsal::v1_gabor::Binocular;
use ndarray::{Array2, ArrayView2};
use stereo_formats::{file_sign, label_polygons, pfm, picture, rig_toml};

use crate::demo_scene::{DemoScene, Promise};
use crate::objects::Objects;
use crate::true_object::TrueObject;

/// A file of the fixture, part of this program.
macro_rules! fixture {
    ($name:literal) => {
        include_bytes!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../fixtures/motorcycle/",
            $name
        ))
    };
}

/// The real pair: Motorcycle of Middlebury 2014 at a quarter of its size, with structured-light
/// truth and objects outlined by hand.
///
/// D. Scharstein et al., "High-resolution stereo datasets with subpixel-accurate ground truth",
/// GCPR 2014; from scikit-image 0.26.0.
pub(crate) fn motorcycle() -> anyhow::Result<DemoScene> {
    let eyes = Binocular {
        left: picture::decode(fixture!("left.png"))?,
        right: picture::decode(fixture!("right.png"))?,
    };
    let rig = rig_toml::decode(fixture!("rig.toml"))?;
    let polygons = label_polygons::decode(fixture!("labels.toml"))?;
    let objects = Objects {
        labels: polygons.fill()?,
        names: polygons.names(),
    };
    let true_d = pfm::decode(fixture!("disp_left.pfm"))?;
    let depth = true_depth(true_d.view(), &rig).context("the truth of the motorcycle")?;
    Ok(DemoScene {
        name: "motorcycle",
        title: "a real pair: Motorcycle, Middlebury 2014, quarter size",
        truth: TrueObject::all(&depth, &objects, &rig),
        eyes,
        rig,
        objects,
        // The workshop from the floor in front to the wall behind.
        span_m: (1.8, 6.0),
        true_d,
        promise: Promise::DepthWithin { part: 0.05 },
    })
}

/// The depth of a true disparity in the sign of files; unknown stays unknown.
fn true_depth(d: ArrayView2<'_, f32>, rig: &StereoRig) -> anyhow::Result<DepthMap> {
    let known = d.mapv(f32::is_finite);
    let field = DisparityField::new(
        file_sign::dx_of_d(d).mapv(|dx| if dx.is_finite() { dx } else { 0.0 }),
        Array2::zeros(d.dim()),
        known.mapv(|known| f32::from(u8::from(known))),
        known.mapv(|known| {
            if known {
                Validity::Valid
            } else {
                Validity::NoEnergy
            }
        }),
    )?;
    Ok(triangulate(&field, rig))
}
