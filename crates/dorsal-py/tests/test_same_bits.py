"""A look from Python and one of the command are the same bits."""

import json
import pathlib

import numpy as np
import pytest

import dorsal

from conftest import MOTORCYCLE


def read_pfm(path: pathlib.Path) -> np.ndarray:
    kind, size, scale, samples = path.read_bytes().split(b"\n", 3)
    assert kind == b"Pf" and float(scale) < 0
    width, height = map(int, size.split())
    return np.frombuffer(samples, "<f4").reshape(height, width)[::-1]


def same(file: np.ndarray, array: np.ndarray) -> bool:
    """Whether a file and an array hold the same bits; unknown is +inf in files, NaN or +inf in arrays."""
    known = np.isfinite(file)
    return np.array_equal(known, np.isfinite(array)) and np.array_equal(
        file[known].view(np.uint32), array[known].view(np.uint32)
    )


HOW = {
    "vector": ({}, []),
    "published rows": ({"published": True, "rows_only": True}, ["--published", "--rows-only"]),
    "told": ({"scales": 5, "zero_disparity": 20.0}, ["--scales", "5", "--zero-disparity", "20"]),
    "dense": ({"estimator": "dense"}, ["--estimator", "dense"]),
    "dense-fast": (
        {"estimator": "dense-fast", "max_disparity": 64},
        ["--estimator", "dense", "--preset", "fast", "--max-disparity", "64"],
    ),
}


@pytest.mark.parametrize("how", HOW)
def test_disparity(how, pair, command, tmp_path):
    options, arguments = HOW[how]
    out = command(tmp_path, *arguments)
    look = dorsal.look(*pair, **options)
    assert same(read_pfm(out / "disparity.pfm"), look.d)
    assert same(read_pfm(out / "confidence.pfm"), look.confidence)
    validity = dorsal.read_picture(out / "validity.png")[:, :, 0]
    assert np.array_equal(validity, look.validity)
    if options.get("estimator", "vector") == "vector":
        assert same(read_pfm(out / "sigma_dx.pfm"), look.field.sigma_dx)
        assert same(read_pfm(out / "sigma_dy.pfm"), look.field.sigma_dy)
    else:
        assert look.field.sigma_dx is None


def test_depth_objects_and_relations(pair, rig, command, tmp_path):
    labelled = MOTORCYCLE / "labels.toml"
    out = command(tmp_path, "--rig", str(MOTORCYCLE / "rig.toml"), "--labels", str(labelled))
    labels, names = dorsal.read_labels(labelled)
    look = dorsal.look(*pair, rig=rig, labels=labels, names=names)
    agrees_with_scene(out, look)
    assert {thing.name for thing in look.objects} <= set(names.values())


def test_what_is_segmented(pair, rig, command, tmp_path):
    out = command(tmp_path, "--rig", str(MOTORCYCLE / "rig.toml"), "--segment")
    look = dorsal.look(*pair, rig=rig, segment=True, estimator="dense")
    agrees_with_scene(out, look)
    labels, _ = dorsal.read_labels(out / "label_image.png")
    assert np.array_equal(labels, look.labels)


def agrees_with_scene(out: pathlib.Path, look: dorsal.Look) -> None:
    assert same(read_pfm(out / "disparity.pfm"), look.d)
    assert same(read_pfm(out / "depth.pfm"), look.depth_m)
    assert same(read_pfm(out / "sigma.pfm"), look.depth.sigma_px)
    scene = json.loads((out / "scene.json").read_text())
    assert look.objects
    assert [thing["name"] for thing in scene["objects"]] == [thing.name for thing in look.objects]
    for theirs, ours in zip(scene["objects"], look.objects):
        for key, value in vars(ours).items():
            expected = tuple(theirs[key]) if isinstance(theirs[key], list) else theirs[key]
            assert value == expected, key
    assert [one["name"] for one in scene["unlocated"]] == [one.name for one in look.unlocated]
    for theirs, ours in [
        (scene["allocentric"]["measured"], look.relations),
        (scene["allocentric"]["inferred"]["relations"], look.inferred),
    ]:
        assert [
            (one["from"], one["to"], tuple(one["depth"]), tuple(one["orientation"]), one["reason"])
            for one in theirs
        ] == [(one.from_, one.to, one.depth, one.orientation, one.reason) for one in ours]
