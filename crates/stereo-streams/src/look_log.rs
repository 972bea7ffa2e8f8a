use std::io::{Seek, Write};
use std::sync::Arc;

use dorsal::Names;
use dorsal::allocentric_qsr::RelationRecord;
use dorsal::egocentric_depth::{DepthMap, LocatedObject, StereoRig};
use dorsal::v1_gabor::Binocular;
use foxglove::messages::{
    CameraCalibration, CompressedImage, FrameTransform, PointCloud, RawImage, SceneUpdate,
};
use foxglove::{
    Channel, Context, Encode, FoxgloveError, McapWriterHandle, PartialMetadata, RawChannel, Schema,
};
use ndarray::ArrayView2;
use serde_json::json;
use stereo_formats::{NotAPng, picture};

use crate::log_messages::{self, LEFT, RIGHT};

/// Why a look is not logged.
#[derive(Debug, thiserror::Error)]
pub enum NotLogged {
    /// The log takes no more bytes.
    #[error("the log cannot be written: {0}; is there room on the disk?")]
    Log(#[from] FoxgloveError),
    /// A picture has no pixel.
    #[error(transparent)]
    Picture(#[from] NotAPng),
    /// A relation is no JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}

/// What a look gives to a log.
#[derive(Debug)]
pub struct LoggedLook<'a> {
    /// When the pictures were taken, in nanoseconds of the log's clock.
    pub time_ns: u64,
    /// What the eyes saw.
    pub pictures: Binocular<ArrayView2<'a, [u8; 3]>>,
    /// The two cameras.
    pub rig: Option<&'a StereoRig>,
    /// The depth of the left picture's pixels.
    pub depth: Option<&'a DepthMap>,
    /// The objects that have a place.
    pub objects: &'a [LocatedObject],
    /// What the objects are called.
    pub names: &'a Names,
    /// What holds between the objects.
    pub relations: Vec<RelationRecord>,
}

/// A log of looks in MCAP, in Foxglove's own schemas, which the Rerun viewer reads too.
///
/// | topic | schema | what |
/// |---|---|---|
/// | `/left/image`, `/right/image` | `foxglove.CompressedImage` | the pictures, PNG |
/// | `/left/camera_info`, `/right/camera_info` | `foxglove.CameraCalibration` | the rig's cameras |
/// | `/tf` | `foxglove.FrameTransform` | `world` (x forward, z up), `observer`, `left_eye`, `right_eye` |
/// | `/depth` | `foxglove.RawImage` | metres along the head's axis, 32FC1, NaN unknown |
/// | `/points` | `foxglove.PointCloud` | every pixel of known depth in the observer's frame, with its colour |
/// | `/scene` | `foxglove.SceneUpdate` | a ball and a name an object, its relations as its metadata |
/// | `/relations` | `dorsal.Relations` (JSON) | every relation with its reason |
///
/// Every look ends its chunk, so what was logged before a power cut can be recovered.
#[derive(Debug)]
pub struct LookLog<W: Write + Seek + Send + 'static> {
    writer: McapWriterHandle<W>,
    // Channels log for as long as their context lives.
    _context: Arc<Context>,
    images: Binocular<Channel<CompressedImage>>,
    cameras: Binocular<Channel<CameraCalibration>>,
    transforms: Channel<FrameTransform>,
    depth: Channel<RawImage>,
    points: Channel<PointCloud>,
    scene: Channel<SceneUpdate>,
    relations: Arc<RawChannel>,
}

impl<W: Write + Seek + Send + 'static> LookLog<W> {
    /// An empty log.
    ///
    /// # Errors
    /// [`NotLogged::Log`] if its first bytes are not taken.
    pub fn begin(writer: W) -> Result<Self, NotLogged> {
        // A context of its own: two logs of one process do not mix.
        let context = Context::new();
        let writer = context.mcap_writer().create(writer)?;
        let schema = json!({
            "title": "dorsal.Relations",
            "type": "object",
            "properties": { "relations": { "type": "array", "items": { "type": "object" } } },
        });
        let relations = context
            .channel_builder("/relations")
            .message_encoding("json")
            .schema(Schema::new(
                "dorsal.Relations",
                "jsonschema",
                schema.to_string().into_bytes(),
            ))
            .build_raw()?;
        Ok(Self {
            writer,
            images: Binocular {
                left: context.channel_builder("/left/image").build(),
                right: context.channel_builder("/right/image").build(),
            },
            cameras: Binocular {
                left: context.channel_builder("/left/camera_info").build(),
                right: context.channel_builder("/right/camera_info").build(),
            },
            transforms: context.channel_builder("/tf").build(),
            depth: context.channel_builder("/depth").build(),
            points: context.channel_builder("/points").build(),
            scene: context.channel_builder("/scene").build(),
            relations,
            _context: context,
        })
    }

    /// Adds a look, as far as it has pictures, cameras, depth, objects and relations.
    ///
    /// # Errors
    /// [`NotLogged`] if the look has no form in a log, or the log takes no more bytes.
    pub fn look(&self, look: &LoggedLook<'_>) -> Result<(), NotLogged> {
        let time_ns = look.time_ns;
        let eyes = [
            (&self.images.left, LEFT, look.pictures.left),
            (&self.images.right, RIGHT, look.pictures.right),
        ];
        for (channel, frame, rgb) in eyes {
            let png = picture::encode_rgb(rgb)?;
            log(channel, time_ns, &log_messages::image(time_ns, frame, png));
        }
        if let Some(rig) = look.rig {
            let (height, width) = look.pictures.left.dim();
            let eyes = rig.eyes();
            let eyes = [
                (&self.cameras.left, LEFT, &eyes.left),
                (&self.cameras.right, RIGHT, &eyes.right),
            ];
            log(
                &self.transforms,
                time_ns,
                &log_messages::observer_in_world(time_ns),
            );
            for (channel, frame, eye) in eyes {
                let camera = log_messages::calibration(time_ns, frame, eye, (width, height));
                log(channel, time_ns, &camera);
                let placed = log_messages::eye_in_observer(time_ns, frame, rig, eye);
                log(&self.transforms, time_ns, &placed);
            }
        }
        if let (Some(depth), Some(rig)) = (look.depth, look.rig) {
            log(&self.depth, time_ns, &log_messages::depth(time_ns, depth));
            let points = log_messages::points(time_ns, depth, rig, look.pictures.left);
            log(&self.points, time_ns, &points);
            log(&self.scene, time_ns, &log_messages::scene(look, rig));
        }
        if !look.relations.is_empty() {
            let text = serde_json::to_vec(&json!({
                "timestamp": { "sec": time_ns / 1_000_000_000, "nsec": time_ns % 1_000_000_000 },
                "relations": look.relations,
            }))?;
            self.relations
                .log_with_meta(&text, PartialMetadata::with_log_time(time_ns));
        }
        // A channel says nothing of bytes that were not taken; the log does here.
        Ok(self.writer.flush()?)
    }

    /// Ends the log with its index, and gives back what it was written to.
    ///
    /// # Errors
    /// [`NotLogged::Log`] if the last bytes are not taken.
    pub fn finish(self) -> Result<W, NotLogged> {
        Ok(self.writer.close()?)
    }
}

fn log<T: Encode>(channel: &Channel<T>, time_ns: u64, message: &T) {
    channel.log_with_meta(message, PartialMetadata::with_log_time(time_ns));
}
