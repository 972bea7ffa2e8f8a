use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use anyhow::Context as _;
use dorsal::allocentric_qsr::RelationRecord;
use dorsal::egocentric_depth::{DepthMap, Eye, LocatedObject, StereoRig, point_cloud};
use dorsal::v1_gabor::Binocular;
use dorsal::{Names, object_id, radius_m};
use mcap::records::MessageHeader;
use ndarray::ArrayView2;
use serde_json::{Value, json};
use stereo_formats::picture;

use crate::base64::base64;

/// A log of looks in MCAP, which Foxglove and the Rerun viewer open: JSON messages of Foxglove's
/// well-known schemas, and one of our own for relations.
///
/// It is kept in memory and written whole, so that no half a log stands under its name.
pub(crate) struct RobotLog {
    writer: mcap::Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
}

/// What a look gives to a log.
pub(crate) struct LoggedLook<'a> {
    /// Nanoseconds of the log's clock.
    pub(crate) time_ns: u64,
    pub(crate) pictures: Binocular<ArrayView2<'a, [u8; 3]>>,
    pub(crate) rig: Option<&'a StereoRig>,
    pub(crate) depth: Option<&'a DepthMap>,
    pub(crate) objects: &'a [LocatedObject],
    pub(crate) names: &'a Names,
    pub(crate) relations: Vec<RelationRecord>,
}

/// Frames of the log: the level observer, and the two cameras.
const OBSERVER: &str = "observer";
const LEFT: &str = "left_eye";
const RIGHT: &str = "right_eye";

impl RobotLog {
    pub(crate) fn new() -> anyhow::Result<Self> {
        let writer = mcap::WriteOptions::new()
            .library(concat!("dorsal ", env!("CARGO_PKG_VERSION")))
            .create(Cursor::new(Vec::new()))?;
        Ok(Self {
            writer,
            channels: BTreeMap::new(),
            sequence: 0,
        })
    }

    /// Adds a look: pictures, cameras, depth, points, objects and relations, as far as it has them.
    pub(crate) fn look(&mut self, look: &LoggedLook<'_>) -> anyhow::Result<()> {
        self.sequence += 1;
        let time = look.time_ns;
        let stamp = json!({ "sec": time / 1_000_000_000, "nsec": time % 1_000_000_000 });
        for (topic, frame, rgb) in [
            ("/left/image", LEFT, look.pictures.left),
            ("/right/image", RIGHT, look.pictures.right),
        ] {
            let png = picture::encode_rgb(rgb)?;
            let message = json!({ "timestamp": stamp, "frame_id": frame, "format": "png",
                "data": base64(&png) });
            self.write(topic, "foxglove.CompressedImage", time, &message)?;
        }
        if let Some(rig) = look.rig {
            let eyes = rig.eyes();
            let (height, width) = look.pictures.left.dim();
            for (topic, frame, eye) in [
                ("/left/camera_info", LEFT, &eyes.left),
                ("/right/camera_info", RIGHT, &eyes.right),
            ] {
                let message = calibration(&stamp, frame, eye, (width, height));
                self.write(topic, "foxglove.CameraCalibration", time, &message)?;
            }
            for (frame, eye) in [(LEFT, &eyes.left), (RIGHT, &eyes.right)] {
                let message = transform(&stamp, frame, rig, eye);
                self.write("/tf", "foxglove.FrameTransform", time, &message)?;
            }
        }
        if let (Some(depth), Some(rig)) = (look.depth, look.rig) {
            let metres = depth.metres();
            let bytes: Vec<u8> = metres.iter().flat_map(|m| m.to_le_bytes()).collect();
            let (height, width) = metres.dim();
            let message = json!({ "timestamp": stamp, "frame_id": LEFT, "width": width,
                "height": height, "encoding": "32FC1", "step": 4 * width, "data": base64(&bytes) });
            self.write("/depth", "foxglove.RawImage", time, &message)?;
            let message = points(&stamp, depth, rig, look.pictures.left);
            self.write("/points", "foxglove.PointCloud", time, &message)?;
            let message = scene(&stamp, look, rig);
            self.write("/scene", "foxglove.SceneUpdate", time, &message)?;
        }
        if !look.relations.is_empty() {
            let message = json!({ "timestamp": stamp, "relations": look.relations });
            self.write("/relations", "dorsal.Relations", time, &message)?;
        }
        Ok(())
    }

    fn write(
        &mut self,
        topic: &'static str,
        schema: &'static str,
        time_ns: u64,
        message: &Value,
    ) -> anyhow::Result<()> {
        let channel_id = match self.channels.get(topic) {
            Some(&channel) => channel,
            None => {
                let text = schema_text(schema);
                let id = self
                    .writer
                    .add_schema(schema, "jsonschema", text.as_bytes())?;
                let channel = self
                    .writer
                    .add_channel(id, topic, "json", &BTreeMap::new())?;
                self.channels.insert(topic, channel);
                channel
            }
        };
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.writer
            .write_to_known_channel(&header, &serde_json::to_vec(message)?)
            .with_context(|| format!("{topic} cannot be logged"))
    }

    /// The bytes of the finished log.
    pub(crate) fn finish(mut self) -> anyhow::Result<Vec<u8>> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// A schema as far as a reader of JSON needs it: which field is bytes in base 64.
fn schema_text(name: &str) -> String {
    let bytes = json!({ "type": "string", "contentEncoding": "base64" });
    let time = json!({ "type": "object", "properties": { "sec": { "type": "integer" },
        "nsec": { "type": "integer" } } });
    let mut properties = json!({ "timestamp": time });
    if ["CompressedImage", "RawImage", "PointCloud"]
        .iter()
        .any(|kind| name.ends_with(kind))
    {
        properties["data"] = bytes;
    }
    json!({ "title": name, "type": "object", "properties": properties }).to_string()
}

/// The camera of an eye; a lens is named as ROS names it.
fn calibration(stamp: &Value, frame: &str, eye: &Eye, (width, height): (usize, usize)) -> Value {
    let (fx, fy) = eye.intrinsics.focal_px;
    let (cx, cy) = eye.intrinsics.principal_point_px;
    let terms = eye.lens.coefficients();
    let model = match terms.len() {
        4 => "kannala_brandt",
        8 => "rational_polynomial",
        _ => "plumb_bob",
    };
    json!({ "timestamp": stamp, "frame_id": frame, "width": width, "height": height,
        "distortion_model": model, "D": terms,
        "K": [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        "R": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        "P": [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0] })
}

/// Where an eye is for the level observer.
fn transform(stamp: &Value, frame: &str, rig: &StereoRig, eye: &Eye) -> Value {
    let [x, y, z] = rig.to_observer(eye.centre).to_array();
    // The columns of the turn from the eye to the observer are the eye's axes there.
    let axis = |axis: [f64; 3]| {
        let head = eye.rotation.apply(axis);
        let position = dorsal::egocentric_depth::Position::from_array(head);
        rig.to_observer(position).to_array()
    };
    let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(axis);
    let [qx, qy, qz, qw] = quaternion([a, b, c]);
    json!({ "timestamp": stamp, "parent_frame_id": OBSERVER, "child_frame_id": frame,
        "translation": { "x": x, "y": y, "z": z },
        "rotation": { "x": qx, "y": qy, "z": qz, "w": qw } })
}

/// The quaternion `x y z w` of a turn by less than half a circle, from its columns.
fn quaternion([a, b, c]: [[f64; 3]; 3]) -> [f64; 4] {
    let w = (1.0 + a[0] + b[1] + c[2]).max(1e-12).sqrt() / 2.0;
    let part = |difference: f64| difference / (4.0 * w);
    [part(b[2] - c[1]), part(c[0] - a[2]), part(a[1] - b[0]), w]
}

fn points(
    stamp: &Value,
    depth: &DepthMap,
    rig: &StereoRig,
    colours: ArrayView2<'_, [u8; 3]>,
) -> Value {
    let mut bytes = Vec::new();
    for point in point_cloud(depth, rig) {
        for metres in point.position.to_array() {
            bytes.extend((metres as f32).to_le_bytes());
        }
        let [red, green, blue] = colours[[point.pixel.1, point.pixel.0]];
        bytes.extend([red, green, blue, 255]);
    }
    // Foxglove's numbers of types: 7 is a float of 32 bits, 1 an unsigned byte.
    let field = |name: &str, offset: u32, kind: u32| json!({ "name": name, "offset": offset, "type": kind });
    json!({ "timestamp": stamp, "frame_id": OBSERVER, "pose": still(0.0, 0.0, 0.0),
        "point_stride": 16,
        "fields": [field("x", 0, 7), field("y", 4, 7), field("z", 8, 7), field("red", 12, 1),
            field("green", 13, 1), field("blue", 14, 1), field("alpha", 15, 1)],
        "data": base64(&bytes) })
}

fn still(x: f64, y: f64, z: f64) -> Value {
    json!({ "position": { "x": x, "y": y, "z": z },
        "orientation": { "x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0 } })
}

/// Every object as a ball with its name; its relations are its metadata.
fn scene(stamp: &Value, look: &LoggedLook<'_>, rig: &StereoRig) -> Value {
    let entities = look.objects.iter().map(|object| {
        let name = object_id(object.label, look.names);
        let [x, y, z] = object.position.to_array();
        let side = 2.0 * radius_m(object, rig);
        let own = look
            .relations
            .iter()
            .filter(|relation| relation.from == name);
        let metadata: Vec<Value> = own
            .map(|relation| {
                let labels = relation.orientation.labels().join(" ");
                let value = format!("{} | {labels}", relation.depth.join(" "));
                json!({ "key": relation.to, "value": value })
            })
            .collect();
        let ink = json!({ "r": 0.1, "g": 0.5, "b": 0.9, "a": 0.5 });
        let black = json!({ "r": 0.0, "g": 0.0, "b": 0.0, "a": 1.0 });
        json!({ "timestamp": stamp, "frame_id": OBSERVER, "id": name,
            "lifetime": { "sec": 0, "nsec": 0 }, "frame_locked": false, "metadata": metadata,
            "arrows": [], "cubes": [], "cylinders": [], "lines": [], "triangles": [],
            "models": [],
            "spheres": [{ "pose": still(x, y, z), "size": { "x": side, "y": side, "z": side },
                "color": ink }],
            "texts": [{ "pose": still(x, y - side, z), "billboard": true, "font_size": 14.0,
                "scale_invariant": true, "color": black, "text": name }] })
    });
    json!({ "deletions": [], "entities": entities.collect::<Vec<Value>>() })
}

/// Writes a finished log, whole or not at all.
pub(crate) fn write_log(path: &Path, log: RobotLog) -> anyhow::Result<()> {
    stereo_formats::replace(path, &log.finish()?).with_context(|| {
        format!(
            "{} cannot be written; its folder must exist, allow writing and have room",
            path.display()
        )
    })
}
