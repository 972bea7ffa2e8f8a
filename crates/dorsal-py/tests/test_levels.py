"""Each level alone."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import dorsal


def test_v1_hears_a_grating():
    x = np.arange(64, dtype=np.float32)
    grating = np.tile(0.5 + 0.4 * np.sin(np.pi / 2 * x), (48, 1))
    finest = dorsal.v1.respond(grating, scales=2)[0]
    assert finest.dtype == np.complex64 and finest.shape == (8, 48, 64)
    energy = dorsal.v1.energy(finest)[:, 24, 32]
    # Vertical bars have their wave vector along orientation 0.
    assert energy.argmax() == 0
    assert len(dorsal.v1.respond(grating, scales=2)) == 2
    with pytest.raises(ValueError, match="orientation"):
        dorsal.v1.respond(grating, orientations=0)


def test_disparity_and_flow_alone(small_pair):
    field = dorsal.disparity.estimate(*small_pair)
    assert field.shape == (48, 64) and 0.5 < field.density <= 1
    assert np.nanmedian(field.dx) == pytest.approx(-5.0, abs=0.02)
    assert np.array_equal(np.isnan(field.dx), field.validity != 255)
    assert set(np.unique(field.validity)) <= set(dorsal.disparity.VALIDITY)
    assert np.isfinite(field.guess_dx).all() and np.isfinite(field.guess_dy).all()
    flow = dorsal.disparity.flow(*small_pair, scales=4)
    assert np.nanmedian(flow.dx) == pytest.approx(-5.0, abs=0.05)


def test_depth_of_other_estimators_and_sensors():
    rig = dorsal.Rig.parallel(100.0, (31.5, 23.5), 0.1)
    dx = np.full((48, 64), -5.0, np.float32)
    dx[0, 0] = np.nan
    depth = dorsal.depth.triangulate(dorsal.DisparityField.of_planes(dx), rig)
    assert np.isnan(depth.metres[0, 0]) and depth.metres[20, 20] == pytest.approx(2.0)
    points = depth.points(rig)
    assert points.shape == (48, 64, 3)
    assert points[20, 20, 2] == pytest.approx(2.0)
    # The middle of the head sees the left eye's centre half a baseline to the left.
    assert points[20, 20, 0] == pytest.approx((20 - 31.5) / 100 * 2.0 - 0.05, abs=1e-6)
    facing = depth.normals(rig)[20, 20]
    assert abs(facing[2]) == pytest.approx(1.0, abs=1e-3)
    labels = np.zeros((48, 64), np.uint8)
    labels[10:30, 10:30] = 1
    located, unlocated = dorsal.depth.locate(
        dorsal.DepthMap.of_metres(depth.metres), labels, rig, {1: "wall"}
    )
    assert [one.name for one in located] == ["wall"] and not unlocated
    with pytest.raises(ValueError, match="plane"):
        dorsal.depth.segment(depth, np.zeros((48, 64), np.uint8), rig)


def test_a_rig_is_a_value():
    matrix = [[100.0, 0.0, 31.5], [0.0, 100.0, 23.5], [0.0, 0.0, 1.0]]
    rig = dorsal.Rig.from_matrices(
        np.array(matrix), matrix, np.eye(3), np.array([[-0.1], [0.0], [0.0]])
    )
    assert rig.baseline_m == pytest.approx(0.1) and rig.is_rectified
    again = pickle.loads(pickle.dumps(rig))
    assert again.to_toml() == rig.to_toml()
    turned = dorsal.Rig.parallel((100.0, 101.0), (31.5, 23.5), 0.1, vergence_rad=0.1, tilt_rad=-0.2)
    assert turned.vergence_rad == pytest.approx(0.1) and not turned.is_rectified
    assert "tilt_rad=-0.2" in repr(turned)


def test_relations_without_eyes():
    seen = [
        dorsal.Sighting("cd_box", 0.80, np.radians(95), 0.01, 0.005),
        dorsal.Sighting("pc_screen", 0.92, np.radians(65), 0.01, 0.005),
    ]
    places, relations = dorsal.qsr.qualify(seen)
    assert [place.object for place in places] == ["cd_box", "pc_screen"]
    screen = next(one for one in relations if one.to == "pc_screen")
    assert screen.depth == ("vc",) and screen.reason["by"] == "measured"
    assert "pc_screen at cd_box" in str(screen)
    with pytest.raises(ValueError, match="distance of -1"):
        dorsal.qsr.qualify([dorsal.Sighting("cup", -1.0, 0.0)])
    with pytest.raises(ValueError, match="NaN"):
        dorsal.qsr.qualify([dorsal.Sighting("cup", float("nan"), 0.0)])


def test_composition():
    classes = [one["short"] for one in dorsal.qsr.system_classes("drs1")["class"]]
    table = dorsal.qsr.composition_table(case=1, mode="published")
    assert table["case"] == 1
    everything = dorsal.qsr.compose(classes, classes)
    assert everything == classes
    assert set(dorsal.qsr.compose(classes[0], classes[0])) <= set(everything)
    with pytest.raises(ValueError, match="CASE 5"):
        dorsal.qsr.compose(classes[0], classes[0], case=5)
    with pytest.raises(ValueError, match="`near`"):
        dorsal.qsr.compose("near", classes[0])


def test_matplotlib_is_not_imported():
    code = "import dorsal, sys; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_plot_needs_matplotlib(small_pair, tmp_path):
    look = dorsal.look(*small_pair)
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        with pytest.raises(ImportError, match="pip install matplotlib"):
            dorsal.plot(look)
    else:
        dorsal.plot(look, small_pair[0], path=tmp_path / "look.png")
        assert (tmp_path / "look.png").stat().st_size > 1000
