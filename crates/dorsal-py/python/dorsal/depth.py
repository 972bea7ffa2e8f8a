"""Level 3: disparity and a rig as metres, positions and objects."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from dorsal import _native
from dorsal._arrays import label_plane, names_of, plain, plane
from dorsal._native import Rig
from dorsal._records import LocatedObject, Unlocated
from dorsal.disparity import DisparityField

__all__ = ["DepthMap", "Rig", "locate", "segment", "triangulate"]


class DepthMap:
    """Depth at every pixel of the left picture, ``[y, x]``, in metres along the head's forward axis."""

    def __init__(self, native: _native.Depth) -> None:
        self._native = native

    @classmethod
    def of_metres(cls, metres: Any) -> DepthMap:
        """A depth map of another sensor; NaN, infinite and what is not positive is unknown."""
        return cls(_native.Depth.of_metres(plane("metres", metres)))

    @property
    def shape(self) -> tuple[int, int]:
        """``(height, width)``."""
        return self._native.shape

    @property
    def density(self) -> float:
        """The part of the pixels whose depth is known, from 0 to 1."""
        return self._native.density

    @property
    def metres(self) -> np.ndarray:
        """Metres; NaN unknown; read-only, no copy."""
        return self._native.metres

    @property
    def sigma_px(self) -> np.ndarray | None:
        """One standard deviation of the disparity behind each depth, in pixels, infinite where unknown; read-only."""
        return self._native.sigma_px

    def points(self, rig: Rig) -> np.ndarray:
        """Positions ``(height, width, 3)`` in the observer's level frame: x right, y down, z forward; metres."""
        return self._native.points(rig)

    def normals(self, rig: Rig) -> np.ndarray:
        """Unit normals ``(height, width, 3)`` of the surface, in the frame of :meth:`points`; NaN unknown."""
        return self._native.normals(rig)


def triangulate(field: DisparityField, rig: Rig) -> DepthMap:
    """The depth of every pixel whose disparity is known."""
    return DepthMap(_native.triangulate(field._native, rig))


def locate(
    depth: DepthMap, labels: Any, rig: Rig, names: dict[int, str] | None = None
) -> tuple[list[LocatedObject], list[Unlocated]]:
    """Where labelled objects are, and which have no place, and why."""
    text = _native.locate(depth._native, label_plane(labels), rig, names_of(names))
    located = json.loads(text)
    return (
        [LocatedObject._of(record) for record in located["objects"]],
        [Unlocated(**record) for record in located["unlocated"]],
    )


def segment(depth: DepthMap, image: Any, rig: Rig) -> np.ndarray:
    """Labels ``uint16`` ``(height, width)`` of what stands on a plane: 1, 2, ... from left to right, 0 for none.

    ``image`` is the left picture. ``ValueError`` if there is no plane to stand on.
    """
    return _native.segment(depth._native, plain(image), rig)
