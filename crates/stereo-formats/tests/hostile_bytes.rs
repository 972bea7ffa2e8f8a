//! Arbitrary bytes, and good files cut short or damaged, give an answer: never a panic, and never
//! an allocation out of proportion to their length.
#![allow(clippy::unwrap_used, reason = "what a test builds for itself is sound")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use ndarray::Array2;
use num_complex::Complex32;
use proptest::prelude::*;
use stereo_formats::middlebury_png::GreyScale;
use stereo_formats::{
    VectorPlanes, depth_png, flo, kalibr, kitti_png, label_png, label_polygons, mask_png,
    middlebury_calib, names, npy, opencv_storage, pfm, picture, points, rig_toml, ros_camera_info,
    scene_toml, validity_png,
};

/// The system's allocator, which notes the largest request of each thread.
struct Noting;

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

fn note(bytes: usize) {
    // A thread that is ending has no note to keep.
    let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(bytes)));
}

#[allow(
    unsafe_code,
    reason = "an allocator can be watched in no other way; every call goes on to the system's \
              allocator as it came, so its promises are the system's"
)]
unsafe impl GlobalAlloc for Noting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        note(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note(size);
        unsafe { System.realloc(old, layout, size) }
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        unsafe { System.dealloc(old, layout) }
    }
}

#[global_allocator]
static NOTING: Noting = Noting;

/// What decoders may ask for at once whatever the file: their windows and tables.
const TABLES: usize = 4 << 20;

/// What a compressed picture may ask for at once for each of its bytes: 8256 pixels (deflate's
/// best) of at most 16 bytes (four floats, or two planes of 64 bits).
const PICTURE: usize = 8 * 1032 * 16;

/// What a text or a plain plane may ask for at once for each of its bytes: a growing vector
/// doubles, and a parser keeps a few words a byte.
const PLAIN: usize = 256;

/// Runs one reader, and holds it to its proportion.
fn proportionate<T, E: std::fmt::Display>(
    bytes: &[u8],
    per_byte: usize,
    decode: impl FnOnce(&[u8]) -> Result<T, E>,
) {
    LARGEST.set(0);
    let answer = decode(bytes);
    let largest = LARGEST.get();
    assert!(
        largest <= TABLES + per_byte * bytes.len(),
        "{} bytes made a reader ask for {largest}",
        bytes.len()
    );
    if let Err(error) = answer {
        assert!(!error.to_string().is_empty());
    }
}

/// Every reader of the crate.
fn every_reader(bytes: &[u8]) {
    let grey = GreyScale::new(8.0, 0).unwrap();
    proportionate(bytes, PICTURE, picture::decode);
    proportionate(bytes, PICTURE, kitti_png::decode);
    proportionate(bytes, PICTURE, |bytes| grey.decode(bytes));
    proportionate(bytes, PICTURE, depth_png::decode);
    proportionate(bytes, PICTURE, validity_png::decode);
    proportionate(bytes, PICTURE, mask_png::decode);
    proportionate(bytes, PICTURE, label_png::decode);
    proportionate(bytes, PLAIN, pfm::decode);
    proportionate(bytes, PLAIN, flo::decode);
    proportionate(bytes, PLAIN, npy::decode::<f32>);
    proportionate(bytes, PLAIN, npy::decode::<Complex32>);
    proportionate(bytes, PLAIN, npy::decode::<bool>);
    proportionate(bytes, PLAIN, names::decode);
    proportionate(bytes, PLAIN, label_polygons::decode);
    proportionate(bytes, PLAIN, rig_toml::decode);
    proportionate(bytes, PLAIN, middlebury_calib::decode);
    proportionate(bytes, PLAIN, ros_camera_info::decode);
    proportionate(bytes, PLAIN, kalibr::decode);
    proportionate(bytes, PLAIN, |bytes| opencv_storage::decode(&[bytes], 1.0));
    proportionate(bytes, PLAIN, points::decode);
    proportionate(bytes, PLAIN, scene_toml::decode_stereo);
    proportionate(bytes, PLAIN, scene_toml::decode_flow);
}

/// A good file of every kind that is read.
fn good_files() -> Vec<Vec<u8>> {
    use image::{DynamicImage, ImageFormat};
    let rgb = Array2::from_shape_fn((9, 13), |(y, x)| {
        [x as u8 * 19, y as u8 * 28, (x * y) as u8]
    });
    let plane = Array2::from_shape_fn((9, 13), |(y, x)| (1 + x + y) as f32);
    let mut files =
        vec![
        picture::encode_rgb(rgb.view()).unwrap(),
        kitti_png::encode(plane.view()).unwrap(),
        GreyScale::new(8.0, 0).unwrap().encode(plane.view()).unwrap(),
        mask_png::encode(plane.mapv(|d| d > 9.0).view()).unwrap(),
        pfm::encode(plane.view()).unwrap(),
        npy::encode(plane.view()),
        npy::encode(plane.mapv(Complex32::from).view()),
        npy::encode(plane.mapv(|d| d > 9.0).view()),
        flo::encode(&VectorPlanes::new(plane.clone(), plane).unwrap()).unwrap(),
        b"P2\n3 2\n255\n0 1 2 3 4 5\n".to_vec(),
        b"P1\n3 2\n0 1 0 1 0 1\n".to_vec(),
        b"P7\nWIDTH 2\nHEIGHT 1\nDEPTH 1\nMAXVAL 9\nTUPLTYPE GRAYSCALE\nENDHDR\n12".to_vec(),
        include_bytes!("../../../fixtures/rigs/ros_left.yaml").to_vec(),
        include_bytes!("../../../fixtures/rigs/kalibr_camchain.yaml").to_vec(),
        opencv_storage::encode(
            &kalibr::decode(include_bytes!("../../../fixtures/rigs/kalibr_camchain.yaml")).unwrap(),
            opencv_storage::Form::Yaml,
        )
        .unwrap(),
        include_bytes!("../../../fixtures/rigs/opencv_stereo.xml").to_vec(),
        b"[names]\n1 = \"cup\"\n2 = \"pen\"\n".to_vec(),
        b"width = 9\nheight = 7\n[[object]]\nname = \"a\"\npolygon = [[1, 1], [4, 1], [2, 5.5]]\n"
            .to_vec(),
        b"baseline_m = 0.1\nvergence_deg = 3\n[left]\nfocal_px = 5\nprincipal_point_px = [2, 2]\n"
            .to_vec(),
        b"cam0=[9 0 3; 0 9 2; 0 0 1]\ncam1=[9 0 4; 0 9 2; 0 0 1]\ndoffs=1\nbaseline=3\nwidth=7\n\
          height=5\n"
            .to_vec(),
        b"x_left,y_left,x_right,y_right\n1,2,3,4\n5,6,7,8\n".to_vec(),
        b"name = 'n'\ndataset = 'd'\ncitation = 'c'\nterms = 't'\nwidth = 4\nheight = 3\n\
          left = 'l'\nright = 'r'\nrectified = true\ndisp_left = 'd.png'\ndisparity_scale = 8\n"
            .to_vec(),
    ];
    let samples = rgb.iter().flatten().copied().collect();
    let rgb = DynamicImage::ImageRgb8(image::RgbImage::from_raw(13, 9, samples).unwrap());
    for picture in [rgb.clone(), rgb.to_luma8().into(), rgb.to_luma16().into()] {
        for format in [ImageFormat::Png, ImageFormat::Tiff, ImageFormat::Pnm] {
            let mut bytes = std::io::Cursor::new(Vec::new());
            picture.write_to(&mut bytes, format).unwrap();
            files.push(bytes.into_inner());
        }
    }
    for picture in [rgb.clone(), rgb.to_luma8().into()] {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Jpeg).unwrap();
        files.push(bytes.into_inner());
    }
    files
}

/// The first bytes of every binary kind, so that arbitrary bytes get past the first look.
const BEGINNINGS: &[&[u8]] = &[
    b"",
    b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
    b"P1 ",
    b"P2 ",
    b"P3 ",
    b"P4 ",
    b"P5 99999 99999 255 ",
    b"P6 999999999 999999999 65535 ",
    b"P7\n",
    b"\xff\xd8\xff",
    b"II*\0\x08\0\0\0",
    b"MM\0*\0\0\0\x08",
    b"Pf\n",
    b"Pf\n4294967295 4294967295\n-1\n",
    b"PIEH",
    b"\x93NUMPY\x01\0\x46\0{'descr': '<f4', 'fortran_order': False, 'shape': (",
    b"\x93NUMPY\x02\0\xff\xff\xff\xff{'descr': '<f4'",
    b"\x93NUMPY\x01\0\x54\0{'descr': '<c8', 'fortran_order': False, 'shape': (4294967295, 2147483648, 2), }",
    b"PIEH\xff\xff\xff\x7f\xff\xff\xff\x7f",
    b"[names]\n",
    b"width = 99999999999\nheight = 9\n",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn arbitrary_bytes(
        beginning in prop::sample::select(BEGINNINGS),
        rest in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        every_reader(&[beginning, &rest].concat());
    }

    #[test]
    fn arbitrary_text(beginning in prop::sample::select(BEGINNINGS), rest in "[ -~\n]{0,200}") {
        every_reader(&[beginning, rest.as_bytes()].concat());
    }

    /// A good file with some bytes changed, four made a huge or odd number, and the end cut off.
    #[test]
    fn damaged_files(
        file in prop::sample::select(good_files()),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        number in prop::option::of((
            any::<prop::sample::Index>(),
            prop::sample::select(&[0u32, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x00ff_ff00][..]),
        )),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut file = file;
        for (at, value) in flips {
            let at = at.index(file.len());
            file[at] = value;
        }
        if let Some((at, number)) = number {
            let at = at.index(file.len());
            for (byte, value) in file[at..].iter_mut().zip(number.to_be_bytes()) {
                *byte = value;
            }
        }
        if let Some(cut) = cut {
            file.truncate(cut.index(file.len()));
        }
        every_reader(&file);
    }

    /// Decimal headers with numbers of any size.
    #[test]
    fn huge_decimal_headers(width: u64, height: u64, tail in prop::collection::vec(any::<u8>(), 0..64)) {
        for kind in ["Pf", "P2", "P5", "P6"] {
            let header = format!("{kind}\n{width} {height}\n255\n");
            every_reader(&[header.as_bytes(), &tail].concat());
        }
    }
}

/// Checksums guard the numbers of a PNG, so damage alone rarely reaches them: here the header lies
/// and its checksum agrees.
#[test]
fn a_png_that_lies_soundly() {
    for (width, height) in [
        (8_192u32, 8_192u32),
        (60_000, 60_000),
        (u32::MAX, 1),
        (1, 1 << 30),
    ] {
        for kind in [0u8, 2, 3, 4, 6] {
            let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
            png.extend(width.to_be_bytes());
            png.extend(height.to_be_bytes());
            png.extend([8, kind, 0, 0, 0]);
            let crc = !png[12..].iter().fold(!0u32, |crc, &byte| {
                (0..8).fold(crc ^ u32::from(byte), |crc, _| {
                    (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
                })
            });
            png.extend(crc.to_be_bytes());
            png.extend(b"\0\0\0\x02IDAT\x78\x01");
            every_reader(&png);
        }
    }
}

/// Every good file is read by some reader: the damaged ones above begin from what is whole.
#[test]
fn good_files_are_good() {
    for file in good_files() {
        let read = picture::decode(&file).is_ok()
            || pfm::decode(&file).is_ok()
            || flo::decode(&file).is_ok()
            || npy::decode::<f32>(&file).is_ok()
            || npy::decode::<Complex32>(&file).is_ok()
            || npy::decode::<bool>(&file).is_ok()
            || names::decode(&file).is_ok()
            || label_polygons::decode(&file).is_ok()
            || rig_toml::decode(&file).is_ok()
            || middlebury_calib::decode(&file).is_ok()
            || ros_camera_info::decode(&file).is_ok()
            || kalibr::decode(&file).is_ok()
            || opencv_storage::decode(&[&file], 1.0).is_ok()
            || points::decode(&file).is_ok()
            || scene_toml::decode_stereo(&file).is_ok();
        assert!(read, "{:?}", String::from_utf8_lossy(&file));
        every_reader(&file);
    }
}
