"""Where the head's pairs come from: an image folder, a recording of ROS 2, or a rendered room."""

import itertools
import math
import os
import pathlib
from collections.abc import Iterator
from dataclasses import dataclass

import dorsal
import numpy as np


@dataclass
class Pair:
    """What both eyes see at one time, `uint8` `[[y, x, channel]]`, and what the source knows beside it."""

    left: np.ndarray
    right: np.ndarray
    #: When it was taken, if the source says so.
    time_ms: int | None = None
    #: How the eyes stand, the text of a `rig.toml`.
    rig: str | None = None
    #: The label of every pixel of the left picture, `uint16`, and what they are called.
    labels: np.ndarray | None = None
    names: dict[int, str] | None = None


def noisy(picture: np.ndarray, sigma: float, seed: int) -> np.ndarray:
    """The picture as a camera with this much noise would give it, in codes; the same for the same seed."""
    if sigma == 0:
        return picture
    noise = np.random.default_rng(seed).normal(0, sigma, picture.shape)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)


def of_folder(folder: pathlib.Path, sigma: float) -> Iterator[Pair]:
    """The pair of a folder again and again, each time with other noise of so many codes."""
    eyes = [dorsal.read_picture(folder / f"{eye}.png") for eye in ("left", "right")]
    for number in itertools.count(1):
        left, right = (noisy(eye, sigma, 2 * number + side) for side, eye in enumerate(eyes))
        yield Pair(left, right)


def of_recording(path: pathlib.Path, topics: list[str]) -> Iterator[Pair]:
    """The pairs of a rosbag2 file in MCAP, with the rig of the cameras that it has recorded.

    `topics` are those of the left and the right picture, and of their cameras if these are not beside the pictures.
    """
    left, right = topics[:2]
    recording = dorsal.Recording(path, left, right)
    beside = [f"{topic.rsplit('/', 1)[0]}/camera_info" for topic in (left, right)]
    rig = recording.rig(*(topics[2:] or beside)).to_toml()
    for time_ns, left_eye, right_eye in recording:
        yield Pair(left_eye, right_eye, time_ns // 1_000_000, rig)


def of_room(name: str, sigma: float, size: tuple[int, int] | None) -> Iterator[Pair]:
    """A rendered room, whose head looks around its own point of fixation: the eyes pan and converge anew for each pair."""
    room = dorsal.Room(name)
    x, y, z = room.fixation_m
    for number in itertools.count():
        turn = 2.4 * number
        at = (x + 0.1 * math.cos(turn), y, z + 0.05 * math.sin(turn)) if number else (x, y, z)
        view = room.look(at, size=size, noise=sigma / 255, seed=number)
        yield Pair(view.left, view.right, None, view.rig.to_toml(), view.labels, view.names)


def pairs() -> Iterator[Pair]:
    """The pairs of the source that the environment names.

    `DORSAL_SOURCE` is `room:table` (or another room) or the path of an `.mcap`, whose topics are `DORSAL_TOPICS`;
    without it, the pair of the folder `DORSAL_PAIR`.
    """
    sigma = float(os.environ.get("DORSAL_NOISE", "0"))
    source = os.environ.get("DORSAL_SOURCE", "")
    if source.startswith("room:"):
        said = os.environ.get("DORSAL_SIZE")
        size = None if said is None else tuple(int(side) for side in said.split("x"))
        return of_room(source.removeprefix("room:"), sigma, size)
    if source:
        topics = os.environ.get("DORSAL_TOPICS", "/left/image_raw,/right/image_raw")
        return of_recording(pathlib.Path(source), topics.split(","))
    return of_folder(pathlib.Path(os.environ["DORSAL_PAIR"]), sigma)
