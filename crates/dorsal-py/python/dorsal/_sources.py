"""Where stereo pairs come from when no camera is at hand: recordings of ROS 2, and rendered rooms."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from dorsal import _native
from dorsal.depth import Rig


class Recording:
    """The stereo pairs of a rosbag2 file in MCAP, in the order of the file: what ``ros2 bag record -s mcap`` writes.

    ``left`` and ``right`` are the topics of the eyes' pictures, ``sensor_msgs/msg/Image`` or ``CompressedImage``; pictures
    whose stamps are at most ``tolerance_ms`` apart are a pair. Iterating gives ``(time_ns, left, right)``: the left
    eye's stamp, and ``uint8`` arrays ``(height, width, 3)``, RGB. Nothing is read ahead. ``ValueError`` at the pair that is
    damaged; the next one may be whole. ``OSError`` if the file does not open.
    """

    def __init__(
        self, path: str | os.PathLike[str], left: str, right: str, *, tolerance_ms: float = 5.0
    ) -> None:
        if not 0 <= tolerance_ms < 1e12:
            raise ValueError(f"tolerance_ms is {tolerance_ms}; it is a time, in milliseconds")
        self._path = path
        self._native = _native.Recording(path, left, right, round(tolerance_ms * 1e6))

    def __iter__(self) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
        return iter(self._native)

    def rig(self, left: str, right: str, *, rectified: bool = False) -> Rig:
        """The rig that the recording has of its cameras: of the ``sensor_msgs/msg/CameraInfo`` on these topics.

        ``rectified`` if the pictures were rectified before they were recorded.
        """
        return _native.rig_of_recording(self._path, left, right, rectified)

    @property
    def came(self) -> tuple[int, int]:
        """How many pictures of the left eye and of the right one came so far."""
        return self._native.counts()[0]

    @property
    def dropped(self) -> tuple[int, int]:
        """How many of them stayed without a partner."""
        return self._native.counts()[1]

    @property
    def topics(self) -> dict[str, str]:
        """The topics that were met so far, each with its type."""
        return dict(self._native.topics())


@dataclass(frozen=True, eq=False)
class RoomView:
    """What a head sees of a rendered room, and what is so."""

    #: What each eye sees, ``(height, width, 3)``, ``uint8``.
    left: np.ndarray
    right: np.ndarray
    #: The two cameras as they stand while the head looks there.
    rig: Rig
    #: The true labels of the left picture, ``(height, width)``, ``uint16``; 0 is no object.
    labels: np.ndarray
    #: What the labels are called.
    names: dict[int, str]


class Room:
    """A room that is rendered, with a head in it whose eyes pan, tilt and converge.

    ``room`` is ``"table"``, ``"shelf"``, ``"scan"``, or the text of a TOML as in ``fixtures/rooms``.
    """

    def __init__(self, room: str = "table") -> None:
        self._native = _native.Room(room)

    @property
    def names(self) -> dict[int, str]:
        """What the labels of the room's things are called."""
        return self._native.names

    @property
    def fixation_m(self) -> tuple[float, float, float]:
        """The point that the head looks at if nothing else is said: right, away and up in the room, in metres."""
        return tuple(self._native.fixation_m)

    def look(
        self,
        at_m: tuple[float, float, float] | None = None,
        *,
        size: tuple[int, int] | None = None,
        noise: float = 0.0,
        seed: int = 0,
    ) -> RoomView:
        """Renders what the head sees that fixates the point ``at_m`` of the room, in metres.

        ``size`` is ``(width, height)`` in pixels over the same field of view; ``noise`` the standard deviation of
        Gaussian noise where white is 1, the same for the same ``seed``.
        """
        at: Any = self.fixation_m if at_m is None else at_m
        left, right, rig, labels = self._native.render(tuple(map(float, at)), size, noise, seed)
        return RoomView(left, right, rig, labels, self.names)
