//! The evaluation data is read as its README describes it.
//!
//! The data is not part of the repository: the tests read the folder that `DORSAL_DATA` names, or
//! `shared/data` beside the checkout, and say so when there is none.
#![allow(clippy::print_stderr, reason = "a skipped test says that it was")]

use std::path::PathBuf;

use ndarray::Array2;
use stereo_formats::scene_folder::{self, Mask, StereoScene};
use stereo_formats::{label_png, middlebury_calib};

fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("DORSAL_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!(
        "skipped: no evaluation data in {}; set DORSAL_DATA to its folder",
        folder.display()
    );
    None
}

fn known(plane: &Array2<f32>) -> (f64, f32, f32) {
    let known: Vec<f32> = plane.iter().copied().filter(|d| d.is_finite()).collect();
    let lowest = known.iter().copied().fold(f32::INFINITY, f32::min);
    let highest = known.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    (known.len() as f64 / plane.len() as f64, lowest, highest)
}

#[test]
fn every_stereo_scene_opens_whole() {
    let Some(data) = data() else { return };
    let scenes = scene_folder::stereo_scenes(&data).unwrap();
    assert!(scenes.len() >= 18, "{} scenes", scenes.len());
    for scene in scenes {
        let name = &scene.description.name;
        let pair = scene.pair().unwrap();
        assert_eq!(pair.left.size(), scene.description.size, "{name}");
        assert!(!scene.description.citation.is_empty(), "{name}");
        match (scene.truth().unwrap(), scene.points().unwrap()) {
            (Some(truth), None) => {
                let (_, lowest, highest) = known(&truth);
                assert!(
                    0.0 < lowest && highest < 256.0,
                    "{name}: {lowest} to {highest}"
                );
                for mask in [Mask::Visible, Mask::Known, Mask::Edges] {
                    if let Some(mask) = scene.mask(mask).unwrap() {
                        assert!(mask.iter().any(|&counts| counts), "{name}");
                    }
                }
                assert_eq!(
                    scene.truth_dy().unwrap().is_some(),
                    name == "motorcycle-exposure"
                );
            }
            (None, Some(points)) => {
                assert!(points.len() >= 54, "{name}: {} points", points.len());
                let pose = scene.description.pose.unwrap();
                assert_eq!(pose.metric, name.starts_with("temple"), "{name}");
                // The rows of a rotation are of length one, to the nine printed digits.
                for row in pose.rotation {
                    let square: f64 = row.iter().map(|part| part * part).sum();
                    assert!((square - 1.0).abs() < 1e-7, "{name}: {row:?}");
                }
            }
            neither => panic!("{name} has {neither:?}"),
        }
    }
}

/// Ranges and densities as published in `scene.toml`, to the digits printed there.
#[test]
fn truth_is_in_pixels() {
    let Some(data) = data() else { return };
    for (scene, density, lowest, highest) in [
        ("middlebury2001/venus", 1.0, 3.0, 19.75),
        ("middlebury2001/tsukuba", 0.793, 5.0, 14.0),
        ("middlebury2003/teddy", 0.9798, 12.5, 52.75),
        ("middlebury2014/motorcycle", 0.9265, 7.1914, 59.909),
        ("eth3d/terrace", 0.5317, 8.1196, 17.4158),
    ] {
        let truth = StereoScene::open(data.join("stereo").join(scene))
            .unwrap()
            .truth();
        let (found, low, high) = known(&truth.unwrap().unwrap());
        assert!((found - density).abs() < 1e-3, "{scene}: density {found}");
        assert!((low - lowest).abs() < 1e-3, "{scene}: from {low}");
        assert!((high - highest).abs() < 1e-3, "{scene}: to {high}");
    }
}

/// The two spellings of one calibration agree.
#[test]
fn a_published_calibration_is_a_rig() {
    let Some(data) = data() else { return };
    let folder = data.join("stereo/eth3d/terrace");
    let scene = StereoScene::open(&folder).unwrap();
    let calib = middlebury_calib::read(folder.join("calib.txt")).unwrap();
    assert_eq!(calib.size, scene.description.size);
    assert_eq!(Some(calib.rig), scene.description.rig);

    let motorcycle = StereoScene::open(data.join("stereo/middlebury2014/motorcycle")).unwrap();
    let rig = motorcycle.description.rig.unwrap();
    let eyes = rig.intrinsics();
    let doffs = eyes.right.principal_point_px.0 - eyes.left.principal_point_px.0;
    assert!((doffs - 31.086).abs() < 1e-9 && (rig.baseline_m() - 0.193_001).abs() < 1e-9);
}

#[test]
fn every_flow_scene_opens_whole() {
    let Some(data) = data() else { return };
    let scenes = scene_folder::flow_scenes(&data).unwrap();
    assert!(scenes.len() >= 4);
    for scene in scenes {
        let frames = scene.frames().unwrap();
        assert_eq!(frames.first.size(), frames.second.size());
        let truth = scene.truth().unwrap();
        let (density, lowest, highest) = known(&truth.dx().to_owned());
        assert!(density > 0.95 && -25.0 < lowest && highest < 25.0);
    }
}

#[test]
fn labels_are_as_listed() {
    let Some(data) = data() else { return };
    let labels = label_png::read(data.join("labelled/arc2017/instances.png")).unwrap();
    let numbers: Vec<u16> = labels.labels().iter().map(|label| label.0.get()).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6, 7, 8]);
    // Visible pixels of the first and the last object, as the scene's own count has them.
    for (number, pixels) in [(1, 17_324), (8, 30_282)] {
        let found = labels
            .plane()
            .iter()
            .filter(|&&label| label == number)
            .count();
        assert_eq!(found, pixels);
    }
}
