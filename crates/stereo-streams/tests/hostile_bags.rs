//! Whatever bytes a bag has, reading it ends, with messages or with an error, and never with a panic.
use std::path::Path;

use proptest::prelude::*;
use stereo_streams::{Bag, decode_camera, decode_image, image_stamp_ns};

const TOPICS: [&str; 6] = [
    "/left/image_raw",
    "/rgb/left",
    "/deep/right",
    "/png/left",
    "/bayer/left",
    "/left/camera_info",
];

fn recorded() -> Vec<u8> {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/bags/pair.mcap");
    std::fs::read(fixture).expect("the fixture")
}

/// Reads everything there is, and says how many pictures were whole.
fn read(bytes: &[u8]) -> usize {
    let mut whole = 0;
    for message in Bag::new(bytes, TOPICS).map_while(Result::ok) {
        let _ = image_stamp_ns(&message.bytes);
        let _ = decode_camera(&message.bytes);
        whole += usize::from(decode_image(&message.kind, &message.bytes).is_ok());
    }
    whole
}

#[test]
fn a_whole_bag_has_all_its_pictures() {
    // Five mono, one in colour, one deep and one compressed; Bayer patterns are none.
    assert_eq!(read(&recorded()), 8);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Bytes that are changed anywhere, and an end that comes anywhere.
    #[test]
    fn a_damaged_bag_ends(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        // Lengths and names are at the beginning: half of the changes go there.
        early in prop::collection::vec((0usize..4000, any::<u8>()), 0..12),
        end in any::<prop::sample::Index>(),
    ) {
        let mut bytes = recorded();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        for (at, byte) in early {
            bytes[at] = byte;
        }
        bytes.truncate(end.index(bytes.len()));
        read(&bytes);
    }

    /// Bytes that are no message at all.
    #[test]
    fn any_bytes_are_a_message_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = image_stamp_ns(&bytes);
        let _ = decode_camera(&bytes);
        for kind in stereo_streams::IMAGE_TYPES {
            let _ = decode_image(kind, &bytes);
        }
    }
}
