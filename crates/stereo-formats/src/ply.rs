//! Clouds of coloured points: binary little-endian PLY.

use std::convert::Infallible;
use std::path::Path;

use crate::file::{self, Unwritable};

/// One point of a cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Where it is: x right, y down, z forward, in metres.
    pub position_m: [f32; 3],
    /// The direction its surface faces, of length 1; zeros if it is unknown, as viewers have it.
    pub normal: [f32; 3],
    /// One standard deviation of its depth, in metres; infinite if nothing is known of it.
    pub sigma_m: f32,
    /// Red, green and blue, from 0 to 255.
    pub rgb: [u8; 3],
}

/// Bytes of one point: seven floats, three colours.
const POINT: usize = 31;

/// The PLY file of a cloud, readable by MeshLab, CloudCompare, Open3D and their like.
///
/// Positions stay in the library's frame (x right, y down, z forward), as cameras of computer
/// vision have it; viewers that hold y up show the cloud upside down until it is turned.
#[must_use]
pub fn encode(cloud: &[CloudPoint]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\n\
         format binary_little_endian 1.0\n\
         comment metres; x right, y down, z forward; sigma of depth\n\
         element vertex {}\n\
         property float x\n\
         property float y\n\
         property float z\n\
         property float nx\n\
         property float ny\n\
         property float nz\n\
         property float sigma\n\
         property uchar red\n\
         property uchar green\n\
         property uchar blue\n\
         end_header\n",
        cloud.len()
    )
    .into_bytes();
    bytes.reserve_exact(POINT * cloud.len());
    for point in cloud {
        let numbers = point.position_m.into_iter().chain(point.normal);
        for number in numbers.chain([point.sigma_m]) {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(point.rgb);
    }
    bytes
}

/// Writes a cloud, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(path: impl AsRef<Path>, cloud: &[CloudPoint]) -> Result<(), Unwritable<Infallible>> {
    file::write(path.as_ref(), Ok(encode(cloud)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_follow_the_header_as_it_says() {
        let cloud = [
            CloudPoint {
                position_m: [1.0, -2.0, 3.5],
                normal: [0.0, 0.6, -0.8],
                sigma_m: 0.01,
                rgb: [1, 2, 3],
            },
            CloudPoint {
                position_m: [0.0, 0.25, 9.0],
                normal: [0.0; 3],
                sigma_m: f32::INFINITY,
                rgb: [255, 0, 7],
            },
        ];
        let bytes = encode(&cloud);
        let end = b"end_header\n";
        let header = bytes
            .windows(end.len())
            .position(|part| part == end)
            .unwrap()
            + end.len();
        assert!(
            std::str::from_utf8(&bytes[..header])
                .unwrap()
                .contains("element vertex 2\n")
        );
        let (points, rest) = bytes[header..].as_chunks::<POINT>();
        assert!(rest.is_empty());
        for (point, want) in points.iter().zip(cloud) {
            let (numbers, rgb) = point.as_chunks::<4>();
            let numbers: Vec<f32> = numbers.iter().map(|n| f32::from_le_bytes(*n)).collect();
            assert_eq!(numbers[..3], want.position_m);
            assert_eq!(numbers[3..6], want.normal);
            assert_eq!(numbers[6], want.sigma_m);
            assert_eq!(rgb, want.rgb);
        }
    }
}
