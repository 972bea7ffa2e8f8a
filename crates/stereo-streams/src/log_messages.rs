//! A look in the messages that Foxglove knows.
use dorsal::egocentric_depth::{DepthMap, Eye, Position, StereoRig, point_cloud};
use dorsal::{object_id, radius_m};
use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{
    CameraCalibration, Color, CompressedImage, FrameTransform, KeyValuePair, LinePrimitive,
    PackedElementField, Point3, PointCloud, Pose, Quaternion, RawImage, SceneEntity,
    SceneEntityDeletion, SceneUpdate, SpherePrimitive, TextPrimitive, Timestamp, Vector3,
    line_primitive, scene_entity_deletion,
};
use ndarray::ArrayView2;

use crate::look_log::LoggedLook;

/// The frame whose x points forward, y left and z up, as ROS has it.
const WORLD: &str = "world";
/// The level observer: x right, y down, z forward.
const OBSERVER: &str = "observer";
/// The left camera: x right, y down, z along its axis.
pub(crate) const LEFT: &str = "left_eye";
/// The right camera.
pub(crate) const RIGHT: &str = "right_eye";

const SECOND_NS: u64 = 1_000_000_000;

fn stamp(time_ns: u64) -> Option<Timestamp> {
    // Both casts hold: a second has fewer nanoseconds, and seconds overflow in the year 2106.
    Some(Timestamp::new(
        (time_ns / SECOND_NS) as u32,
        (time_ns % SECOND_NS) as u32,
    ))
}

pub(crate) fn image(time_ns: u64, frame: &str, png: Vec<u8>) -> CompressedImage {
    CompressedImage {
        timestamp: stamp(time_ns),
        frame_id: frame.to_owned(),
        data: png.into(),
        format: "png".to_owned(),
    }
}

/// The camera of an eye; a lens is named as ROS names it.
pub(crate) fn calibration(
    time_ns: u64,
    frame: &str,
    eye: &Eye,
    (width, height): (usize, usize),
) -> CameraCalibration {
    let (fx, fy) = eye.intrinsics.focal_px;
    let (cx, cy) = eye.intrinsics.principal_point_px;
    let terms = eye.lens.coefficients();
    let model = match terms.len() {
        4 => "kannala_brandt",
        8 => "rational_polynomial",
        _ => "plumb_bob",
    };
    CameraCalibration {
        timestamp: stamp(time_ns),
        frame_id: frame.to_owned(),
        width: width as u32,
        height: height as u32,
        distortion_model: model.to_owned(),
        d: terms.to_vec(),
        k: vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        r: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: vec![fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    }
}

/// The observer as the world has it, so that a viewer shows up as up.
pub(crate) fn observer_in_world(time_ns: u64) -> FrameTransform {
    FrameTransform {
        timestamp: stamp(time_ns),
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: OBSERVER.to_owned(),
        translation: Some(vector([0.0; 3])),
        // Right, down and forward are -y, -z and x.
        rotation: Some(Quaternion {
            x: -0.5,
            y: 0.5,
            z: -0.5,
            w: 0.5,
        }),
    }
}

/// Where an eye is for the level observer.
pub(crate) fn eye_in_observer(
    time_ns: u64,
    frame: &str,
    rig: &StereoRig,
    eye: &Eye,
) -> FrameTransform {
    // The columns of the turn from the eye to the observer are the eye's axes there.
    let axis = |axis: [f64; 3]| {
        let in_head = Position::from_array(eye.rotation.apply(axis));
        rig.to_observer(in_head).to_array()
    };
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(axis);
    FrameTransform {
        timestamp: stamp(time_ns),
        parent_frame_id: OBSERVER.to_owned(),
        child_frame_id: frame.to_owned(),
        translation: Some(vector(rig.to_observer(eye.centre).to_array())),
        rotation: Some(quaternion(columns)),
    }
}

/// The quaternion of a turn by less than half a circle, from its columns: eyes look forward.
fn quaternion([a, b, c]: [[f64; 3]; 3]) -> Quaternion {
    let w = (1.0 + a[0] + b[1] + c[2]).max(1e-12).sqrt() / 2.0;
    let part = |difference: f64| difference / (4.0 * w);
    Quaternion {
        x: part(b[2] - c[1]),
        y: part(c[0] - a[2]),
        z: part(a[1] - b[0]),
        w,
    }
}

pub(crate) fn depth(time_ns: u64, depth: &DepthMap) -> RawImage {
    let metres = depth.metres();
    let (height, width) = metres.dim();
    let bytes: Vec<u8> = metres.iter().flat_map(|m| m.to_le_bytes()).collect();
    RawImage {
        timestamp: stamp(time_ns),
        frame_id: LEFT.to_owned(),
        width: width as u32,
        height: height as u32,
        encoding: "32FC1".to_owned(),
        step: 4 * width as u32,
        data: bytes.into(),
    }
}

/// Three floats and four bytes of colour.
const POINT_BYTES: u32 = 16;

pub(crate) fn points(
    time_ns: u64,
    depth: &DepthMap,
    rig: &StereoRig,
    colours: ArrayView2<'_, [u8; 3]>,
) -> PointCloud {
    let mut bytes = Vec::new();
    for point in point_cloud(depth, rig) {
        for metres in point.position.to_array() {
            bytes.extend((metres as f32).to_le_bytes());
        }
        let [red, green, blue] = colours[[point.pixel.1, point.pixel.0]];
        bytes.extend([red, green, blue, u8::MAX]);
    }
    let field = |name: &str, offset: u32, kind: NumericType| PackedElementField {
        name: name.to_owned(),
        offset,
        r#type: kind as i32,
    };
    PointCloud {
        timestamp: stamp(time_ns),
        frame_id: OBSERVER.to_owned(),
        pose: Some(at([0.0; 3])),
        point_stride: POINT_BYTES,
        fields: vec![
            field("x", 0, NumericType::Float32),
            field("y", 4, NumericType::Float32),
            field("z", 8, NumericType::Float32),
            field("red", 12, NumericType::Uint8),
            field("green", 13, NumericType::Uint8),
            field("blue", 14, NumericType::Uint8),
            field("alpha", 15, NumericType::Uint8),
        ],
        data: bytes.into(),
    }
}

/// Every object as a ball with its name and its relations, and lines between those that are related; the
/// objects of the look before leave first.
pub(crate) fn scene(look: &LoggedLook<'_>, rig: &StereoRig) -> SceneUpdate {
    let time_ns = look.time_ns;
    let placed: Vec<(String, [f64; 3], f64)> = look
        .objects
        .iter()
        .map(|object| {
            let name = object_id(object.label, look.names).to_string();
            (name, object.position.to_array(), radius_m(object, rig))
        })
        .collect();
    let mut entities: Vec<SceneEntity> = placed
        .iter()
        .map(|(name, [x, y, z], radius_m)| {
            let own = look.relations.iter().filter(|r| r.from.as_str() == name);
            let metadata = own.map(|relation| {
                let labels = relation.orientation.labels().join(" ");
                KeyValuePair {
                    key: relation.to.to_string(),
                    value: format!("{} | {labels}", relation.depth.join(" ")),
                }
            });
            SceneEntity {
                metadata: metadata.collect(),
                spheres: vec![SpherePrimitive {
                    pose: Some(at([*x, *y, *z])),
                    size: Some(vector([2.0 * radius_m; 3])),
                    color: Some(colour([0.1, 0.5, 0.9, 0.5])),
                }],
                texts: vec![TextPrimitive {
                    // Above the ball: y points down.
                    pose: Some(at([*x, y - 1.5 * radius_m, *z])),
                    billboard: true,
                    font_size: 14.0,
                    scale_invariant: true,
                    color: Some(colour([0.0, 0.0, 0.0, 1.0])),
                    text: name.clone(),
                }],
                ..entity(time_ns, name)
            }
        })
        .collect();
    let place = |name: &str| placed.iter().find(|(own, _, _)| own == name);
    let ends = look.relations.iter().filter_map(|relation| {
        // Each pair is drawn once; its converse is the same line.
        (relation.from < relation.to).then_some(())?;
        Some([
            place(relation.from.as_str())?.1,
            place(relation.to.as_str())?.1,
        ])
    });
    let points: Vec<Point3> = ends.flatten().map(|[x, y, z]| Point3 { x, y, z }).collect();
    if !points.is_empty() {
        entities.push(SceneEntity {
            lines: vec![LinePrimitive {
                r#type: line_primitive::Type::LineList as i32,
                pose: Some(at([0.0; 3])),
                thickness: 1.0,
                scale_invariant: true,
                points,
                color: Some(colour([0.3, 0.3, 0.3, 0.4])),
                colors: Vec::new(),
                indices: Vec::new(),
            }],
            ..entity(time_ns, "relations")
        });
    }
    SceneUpdate {
        deletions: vec![SceneEntityDeletion {
            timestamp: stamp(time_ns),
            r#type: scene_entity_deletion::Type::All as i32,
            id: String::new(),
        }],
        entities,
    }
}

fn entity(time_ns: u64, id: &str) -> SceneEntity {
    SceneEntity {
        timestamp: stamp(time_ns),
        frame_id: OBSERVER.to_owned(),
        id: id.to_owned(),
        ..SceneEntity::default()
    }
}

const fn vector([x, y, z]: [f64; 3]) -> Vector3 {
    Vector3 { x, y, z }
}

fn at(position: [f64; 3]) -> Pose {
    Pose {
        position: Some(vector(position)),
        orientation: Some(Quaternion {
            x: 0.0,
            y: 0.0,
            z: 0.0,
            w: 1.0,
        }),
    }
}

const fn colour([r, g, b, a]: [f64; 4]) -> Color {
    Color { r, g, b, a }
}
