//! Stereo pairs that come one after another, and logs of what was seen in them.
//!
//! In come robots' recordings and cameras' streams; out goes a log that Foxglove and the Rerun viewer open. The
//! formats' own crates, `mcap` and `foxglove`, are dependencies of this crate and of nothing below it.
//!
//! - [`Bag`]: the messages of a rosbag2 file in MCAP; [`decode_image`] and [`decode_camera`] read the CDR of
//!   `sensor_msgs`; [`StampPairs`] pairs what two cameras took at the same time,
//!   and [`BagPairs`] does so with the messages of a bag.
//! - [`SideBySide`]: Y4M or raw grey frames whose halves are the two eyes' pictures.
//! - `LookLog`: pictures, cameras, depth, points, objects and relations of looks, in MCAP (feature `log`, which is on
//!   unless it is turned off).
//!
//! ```
//! use stereo_streams::SideBySide;
//!
//! // Two frames of 4 x 1 pixels: the left half is the left eye's.
//! let stream = b"YUV4MPEG2 W4 H1 F30:1 Cmono\nFRAME\nabcdFRAME\nefgh";
//! let second = SideBySide::y4m(&stream[..])?.nth(1).expect("two frames")?;
//! assert_eq!(second.right.rgb()[[0, 0]], [b'g'; 3]);
//! # Ok::<(), stereo_streams::NotAStream>(())
//! ```

mod bag;
mod bag_pairs;
mod cdr;
#[cfg(feature = "log")]
mod log_messages;
#[cfg(feature = "log")]
mod look_log;
mod ros_camera;
mod ros_image;
mod side_by_side;
mod stamp_pairs;

pub use bag::{Bag, BagMessage, NotABag};
pub use bag_pairs::{BagPairs, NoPair};
pub use cdr::NotCdr;
#[cfg(feature = "log")]
pub use look_log::{LoggedLook, LookLog, NotLogged};
pub use ros_camera::{CAMERA_TYPE, NotARosCamera, decode_camera, recorded_rig};
pub use ros_image::{IMAGE_TYPES, NotARosImage, decode_image, image_stamp_ns};
pub use side_by_side::{NotAStream, SideBySide};
pub use stamp_pairs::{Side, StampPairs};
