use dorsal::disparity_pyramid::ShiftCovariance;
use dorsal::egocentric_depth::{normals, point_cloud};
use dorsal::v1_gabor::Binocular;
use ndarray::ArrayView2;
use stereo_formats::colour::{self, ColourRange};
use stereo_formats::picture::{self, Picture};
use stereo_formats::ply::{self, CloudPoint};
use stereo_formats::rig_toml::{self, SizedRig};
use stereo_formats::{NotAPng, depth_png, file_sign, flo, label_png, pfm, scale_bar, validity_png};

use crate::label_picture::label_picture;
use crate::look_record::LookRecord;
use crate::outputs::Outputs;
use crate::plan::Plan;
use crate::scene_record::SceneRecord;
use crate::sight::Sight;

/// The files that a look leaves.
pub(crate) fn look_files<'a>(
    plan: &'a Plan,
    sight: &'a Sight,
    eyes: &'a Binocular<Picture>,
    mut record: LookRecord,
) -> Outputs<'a> {
    let mut files = Outputs::default();
    let (field, dense) = (&sight.disparity, record.dense);
    files.add("disparity.pfm", move || pfm::encode_disparity(field, dense));
    files.add("disparity.flo", move || flo::encode_disparity(field, dense));
    files.add("confidence.pfm", || pfm::encode(field.confidence()));
    if let Some(covariance) = field.covariance() {
        files.add("sigma_dx.pfm", move || {
            pfm::encode(covariance.mapv(ShiftCovariance::sigma_dx).view())
        });
        files.add("sigma_dy.pfm", move || {
            pfm::encode(covariance.mapv(ShiftCovariance::sigma_dy).view())
        });
    }
    files.add("validity.png", || validity_png::encode(field.validity()));
    files.add("disparity.png", move || {
        let d = file_sign::d_of_field(field, dense);
        coloured_png(d.view(), ColourRange::covering(d.view()), "px")
    });
    if let (Some(depth), Some(rig)) = (&sight.depth, &sight.rig) {
        files.add("depth.pfm", || pfm::encode(depth.metres()));
        if let Some(sigma_px) = depth.disparity_sigma_px() {
            files.add("sigma.pfm", move || pfm::encode(sigma_px));
        }
        files.add("depth.png", || {
            coloured_png(depth.metres(), ColourRange::covering(depth.metres()), "m")
        });
        // What has no code in whole millimetres is unknown there: the PFM has it.
        files.add("depth_mm.png", || {
            depth_png::encode(&depth.within(0.001, 65.535))
        });
        if plan.recalibrate {
            files.add("rig.fixed.toml", || {
                rig_toml::encode_sized(&SizedRig {
                    rig: *rig,
                    size: Some(depth.size()),
                })
            });
        }
        files.add("cloud.ply", || {
            let colours = eyes.left.rgb();
            let facing = normals(depth, rig);
            let own = depth.disparity_sigma_px();
            let any_px = plan.locating.disparity_sigma_px;
            let points = point_cloud(depth, rig).map(|point| {
                let at = [point.pixel.1, point.pixel.0];
                let normal = facing[at];
                let sigma_px = own.map_or(any_px, |own| f64::from(own[at]));
                CloudPoint {
                    position_m: point.position.to_array().map(|metres| metres as f32),
                    normal: if normal[0].is_nan() { [0.0; 3] } else { normal },
                    sigma_m: rig.depth_sigma_m(rig.to_head(point.position), sigma_px) as f32,
                    rgb: colours[at],
                }
            });
            let points: Vec<CloudPoint> = points.collect();
            anyhow::Ok(ply::encode(&points))
        });
    }
    if let (Some(scene), Some(rig), Some(objects)) = (&sight.scene, &sight.rig, &sight.objects) {
        files.add("scene.json", move || {
            serde_json::to_vec_pretty(&SceneRecord::new(scene, rig, &objects.names))
        });
    }
    if let (Some(_), Some(objects)) = (&sight.segmented, &sight.objects) {
        files.add("label_image.png", || label_png::encode(&objects.labels));
        files.add("labels.png", || {
            picture::encode_rgb(label_picture(eyes.left.rgb(), &objects.labels).view())
        });
    }
    record.files = files.names();
    record.files.push("look.json".into());
    record.files.push("index.html".into());
    files.add("look.json", move || serde_json::to_vec_pretty(&record));
    files
}

/// A plane in colours over its scale bar with the unit of its numbers, as a PNG.
pub(crate) fn coloured_png(
    plane: ArrayView2<'_, f32>,
    range: ColourRange,
    unit: &str,
) -> Result<Vec<u8>, NotAPng> {
    let painted = colour::paint(plane, range);
    picture::encode_rgb(scale_bar::beneath(painted.view(), range, unit).view())
}
