use std::collections::BTreeMap;

use dorsal::allocentric_qsr::{DepthReference, EgocentricPlace, Places, Relation, SceneMemory};
use dorsal::egocentric_depth::{EgocentricScene, Observer, Position, StereoRig};
use dorsal::v1_gabor::Size;
use dorsal::{Names, object_id};
use ndarray::ArrayView2;
use serde::Serialize;
use stereo_formats::picture;

use crate::base64::base64;
use crate::report::plane::{LabelPlane, Plane};

/// One look on the page.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Frame {
    pub(crate) title: String,
    pub(crate) why: String,
    pub(crate) notes: Vec<String>,
    /// Width and height of the pictures as they were taken.
    size: [usize; 2],
    pub(crate) images: BTreeMap<&'static str, Image>,
    pub(crate) planes: BTreeMap<&'static str, Plane>,
    pub(crate) labels: Option<LabelPlane>,
    /// Objects of the picture, and where in it.
    pub(crate) seen: Vec<Seen>,
    /// Objects from above.
    pub(crate) objects: Vec<Spot>,
    pub(crate) truth: Vec<TrueSpot>,
    /// Where the eyes fixate, `[right, forward]`.
    pub(crate) fixation: Option<[f64; 2]>,
    /// The ground in view, a polygon of `[right, forward]`.
    pub(crate) view: Option<Vec<[f64; 2]>>,
    /// Runs of squares seen free.
    pub(crate) free: Vec<[i32; 3]>,
    /// The side of those squares, in metres.
    pub(crate) cell: f64,
    pub(crate) ego: Vec<EgoRecord>,
    pub(crate) relations: Vec<RelationOnPage>,
    pub(crate) times: Vec<(&'static str, f64)>,
}

/// A picture inside the page.
#[derive(Debug, Serialize)]
pub(crate) struct Image {
    src: String,
    alt: String,
}

#[derive(Debug, Serialize)]
pub(crate) struct Seen {
    name: String,
    pixel: [f64; 2],
}

/// An object from above: metres to the right and ahead, `[xx, xz, zz]` of its covariance.
#[derive(Debug, Serialize)]
pub(crate) struct Spot {
    pub(crate) name: String,
    pub(crate) x: f64,
    pub(crate) z: f64,
    pub(crate) cov: [f64; 3],
    pub(crate) radius: f64,
    pub(crate) life: &'static str,
}

#[derive(Debug, Serialize)]
pub(crate) struct TrueSpot {
    pub(crate) name: String,
    pub(crate) x: f64,
    pub(crate) z: f64,
}

/// Where an object is for the robot, in a word.
#[derive(Debug, Serialize)]
pub(crate) struct EgoRecord {
    name: String,
    read: String,
}

/// A relation and its reasons.
#[derive(Debug, Serialize)]
pub(crate) struct RelationOnPage {
    from: String,
    to: String,
    depth: Vec<String>,
    orientation: Vec<&'static str>,
    read: Option<[String; 2]>,
    mode: String,
    why: Option<String>,
    truth: Option<String>,
    holds: Option<bool>,
}

impl Frame {
    pub(crate) fn new(title: impl Into<String>, size: Size) -> Self {
        Self {
            title: title.into(),
            size: [size.width, size.height],
            ..Self::default()
        }
    }

    /// Adds a picture, small.
    pub(crate) fn picture(
        &mut self,
        name: &'static str,
        rgb: ArrayView2<'_, [u8; 3]>,
        alt: &str,
    ) -> anyhow::Result<()> {
        let jpeg = picture::encode_preview(rgb, MOST_WIDTH)?;
        self.images.insert(
            name,
            Image {
                src: format!("data:image/jpeg;base64,{}", base64(&jpeg)),
                alt: alt.to_owned(),
            },
        );
        Ok(())
    }

    /// Adds where the objects are in the picture.
    pub(crate) fn see(&mut self, scene: &EgocentricScene, names: &Names) {
        let seen = scene.objects.iter().map(|object| Seen {
            name: object_id(object.label, names).to_string(),
            pixel: [object.pixel.0, object.pixel.1],
        });
        self.seen = seen.collect();
    }

    /// Adds where the objects are for the robot.
    pub(crate) fn egocentric(&mut self, place: &EgocentricPlace, reference: &DepthReference) {
        self.ego.push(EgoRecord {
            name: place.object.to_string(),
            read: format!(
                "{} {}",
                reference.short(place.read.depth),
                place.read.orientation.short()
            ),
        });
    }

    /// Adds a relation, what is so, and why it is believed.
    pub(crate) fn relate(
        &mut self,
        relation: &Relation,
        so: Option<Places>,
        why: Option<String>,
        reference: &DepthReference,
    ) {
        let depths = |places: Places| -> Vec<String> {
            let labels = reference.labels(places.depth).into_iter();
            labels.map(str::to_owned).collect()
        };
        let places = relation.places;
        self.relations.push(RelationOnPage {
            from: relation.from.to_string(),
            to: relation.to.to_string(),
            depth: depths(places),
            orientation: places.orientation.labels(),
            read: relation.read.map(|read| {
                [
                    reference.short(read.depth).to_owned(),
                    read.orientation.short().to_owned(),
                ]
            }),
            mode: format!("{:?}", relation.mode).to_lowercase(),
            why,
            truth: so.map(|so| {
                format!(
                    "{} {}",
                    depths(so).join("/"),
                    so.orientation.labels().join("/")
                )
            }),
            holds: so.map(|so| {
                places.depth & so.depth == so.depth
                    && places.orientation & so.orientation == so.orientation
            }),
        });
    }

    /// Adds what a memory keeps, from above.
    pub(crate) fn remember(&mut self, memory: &SceneMemory) {
        self.cell = f64::from(memory.params().cell_mm) / 1e3;
        self.free = memory.free_ground();
        for (name, kept) in memory.objects() {
            let Some(place) = memory.from_robot(name) else {
                continue;
            };
            let [[xx, xz], [_, zz]] = place.covariance_m2;
            self.objects.push(Spot {
                name: name.to_string(),
                x: place.right_m,
                z: place.forward_m,
                cov: [xx, xz, zz],
                radius: f64::from(kept.radius_mm) / 1e3,
                life: kept.life.label(),
            });
        }
    }

    /// The ground that the left eye sees, `down_m` below the eyes, out to [`FARTHEST_M`].
    pub(crate) fn look_over(&mut self, rig: &StereoRig, down_m: f64) {
        let [width, height] = self.size.map(|side| side as f64 - 1.0);
        let steps = 8;
        let along = |step: i32| f64::from(step) / f64::from(steps);
        let edges = (0..steps)
            .map(|step| (along(step) * width, 0.0))
            .chain((0..steps).map(|step| (width, along(step) * height)))
            .chain((0..steps).map(|step| ((1.0 - along(step)) * width, height)))
            .chain((0..steps).map(|step| (0.0, (1.0 - along(step)) * height)));
        let eye = rig.eyes().left;
        let ground = edges.filter_map(|pixel| {
            let ray = eye.ray(pixel)?;
            let [x, y, z] = rig
                .to_observer(Position::from_array(ray.direction))
                .to_array();
            let from = rig.to_observer(ray.origin);
            let level = x.hypot(z);
            // What does not come down to the ground before the farthest ends there.
            let farthest = FARTHEST_M / level;
            let reach = if y > 0.0 {
                (down_m / y).min(farthest)
            } else {
                farthest
            };
            let at: Position<Observer> =
                Position::new(from.x_m + reach * x, down_m, from.z_m + reach * z);
            Some([at.x_m, at.z_m])
        });
        self.view = Some(ground.collect());
    }

    /// Every place that the view from above must hold.
    pub(crate) fn spots(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let objects = self.objects.iter().map(|spot| [spot.x, spot.z]);
        objects.chain(self.truth.iter().map(|spot| [spot.x, spot.z]))
    }
}

/// The widest picture of a page, in pixels.
pub(crate) const MOST_WIDTH: usize = 640;

/// How far the ground in view is drawn, in metres.
const FARTHEST_M: f64 = 3.0;
