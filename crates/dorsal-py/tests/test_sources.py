"""Recordings and rendered rooms give pairs that a look understands."""

import numpy as np
import pytest

import dorsal
from conftest import ROOT

BAG = ROOT / "fixtures" / "bags" / "pair.mcap"


def test_a_recording_gives_its_pairs_and_counts_what_stays_alone():
    recording = dorsal.Recording(BAG, "/left/image_raw", "/right/image_raw")
    pairs = list(recording)
    came, dropped = recording.came, recording.dropped
    # Each eye misses a frame: every picture is in a pair or counted.
    assert len(pairs) > 1 and sum(came) == 2 * len(pairs) + sum(dropped) and sum(dropped) > 0
    assert [time for time, _, _ in pairs] == sorted(time for time, _, _ in pairs)
    _, left, right = pairs[0]
    assert left.dtype == np.uint8 and left.shape == right.shape and left.shape[2] == 3
    rig = recording.rig("/left/camera_info", "/right/camera_info")
    look = dorsal.look(left, right, rig=rig)
    assert look.field.density > 0.2
    assert recording.topics["/left/image_raw"] == "sensor_msgs/msg/Image"


def test_recordings_are_refused_in_words(tmp_path):
    with pytest.raises(FileNotFoundError, match="none.mcap"):
        dorsal.Recording("none.mcap", "/a", "/b")
    with pytest.raises(ValueError, match="topics of their own"):
        dorsal.Recording(BAG, "/a", "/a")
    with pytest.raises(ValueError, match="no message on /none"):
        dorsal.Recording(BAG, "/a", "/b").rig("/left/camera_info", "/none")
    other = tmp_path / "other.mcap"
    other.write_bytes(b"no bag at all, and longer than a header")
    with pytest.raises(ValueError, match="no MCAP file"):
        list(dorsal.Recording(other, "/a", "/b"))


def test_a_rendered_room_is_seen_as_it_is():
    room = dorsal.Room()
    view = room.look(size=(256, 192))
    assert view.left.shape == (192, 256, 3) and view.labels.shape == (192, 256)
    look = dorsal.look(view.left, view.right, rig=view.rig, labels=view.labels, names=view.names)
    assert {one.name for one in look.objects} <= set(room.names.values()) and len(look.objects) >= 3
    again, noisy = (room.look(size=(256, 192), noise=noise, seed=3) for noise in (0.0, 0.02))
    assert np.array_equal(again.left, view.left) and not np.array_equal(noisy.left, view.left)
    # The eyes turn to another point: another rig, and another picture.
    x, y, z = room.fixation_m
    other = room.look((x + 0.2, y, z), size=(256, 192))
    assert other.rig.to_toml() != view.rig.to_toml()
    for wrong in (lambda: dorsal.Room("cellar"), lambda: room.look((x, -9.0, z)), lambda: dorsal.Room("x = ")):
        with pytest.raises(ValueError):
            wrong()
