"""One look: from two pictures to disparity, depth, objects and relations."""

from __future__ import annotations

import json
import os
from functools import cached_property
from typing import Any

import numpy as np

from dorsal import _native
from dorsal._arrays import label_plane, names_of, plain
from dorsal._records import LocatedObject, Place, Relation, Unlocated
from dorsal.depth import DepthMap, Rig
from dorsal.disparity import DisparityField


class Look:
    """What one look gave. Arrays are ``[y, x]`` over the left picture; NaN is unknown.

    ``d``, ``dx``, ``dy``, ``confidence``, ``validity`` and ``depth_m`` are those of :attr:`field` and
    :attr:`depth`; ``depth``, ``depth_m`` are ``None`` without a rig. ``objects``, ``unlocated``, ``places``,
    ``relations`` and ``inferred`` are empty without labels.
    """

    def __init__(self, native: _native.Look) -> None:
        self._native = native

    @cached_property
    def field(self) -> DisparityField:
        """The disparity of every pixel, with the estimator's own word on each."""
        return DisparityField(self._native.field)

    @cached_property
    def depth(self) -> DepthMap | None:
        """The depth of every pixel whose disparity is known; ``None`` without a rig."""
        native = self._native.depth
        return None if native is None else DepthMap(native)

    @property
    def d(self) -> np.ndarray:
        """``x_left - x_right`` in pixels, nearer is larger, as OpenCV and disparity files have it."""
        return self.field.d

    @property
    def dx(self) -> np.ndarray:
        """``x_right - x_left`` in pixels: left ``(x, y)`` matches right ``(x + dx, y + dy)``."""
        return self.field.dx

    @property
    def dy(self) -> np.ndarray:
        """``y_right - y_left`` in pixels."""
        return self.field.dy

    @property
    def confidence(self) -> np.ndarray:
        """From 0 to 1, at every pixel; read-only."""
        return self.field.confidence

    @property
    def validity(self) -> np.ndarray:
        """Why a pixel has no answer; see :attr:`DisparityField.validity`."""
        return self.field.validity

    @property
    def depth_m(self) -> np.ndarray | None:
        """Metres along the head's forward axis; read-only."""
        return None if self.depth is None else self.depth.metres

    @property
    def labels(self) -> np.ndarray | None:
        """The labels by which objects were placed, given or found; ``uint16``, read-only."""
        return self._native.labels

    @property
    def seconds(self) -> float:
        """How long the levels took, from the planes of both eyes to the relations; the rest of the call is the door's."""
        return self._native.seconds

    @property
    def objects(self) -> list[LocatedObject]:
        """Where the objects are, in metres and radians, by ascending label."""
        return self._scene["objects"]

    @property
    def unlocated(self) -> list[Unlocated]:
        """The objects that have no place, and why."""
        return self._scene["unlocated"]

    @property
    def places(self) -> list[Place]:
        """Where the objects are for the observer, in symbols."""
        return self._scene["places"]

    @property
    def relations(self) -> list[Relation]:
        """Every relation between two objects, from the intervals around both positions: sound."""
        return self._scene["relations"]

    @property
    def inferred(self) -> list[Relation]:
        """The same by the paper's own composition of places."""
        return self._scene["inferred"]

    def relation(self, from_: str, to: str) -> Relation | None:
        """Where ``to`` is at ``from_``; ``None`` if one of them was not placed."""
        return self._related.get((from_, to))

    @cached_property
    def _related(self) -> dict[tuple[str, str], Relation]:
        return {(relation.from_, relation.to): relation for relation in self.relations}

    @cached_property
    def _scene(self) -> dict[str, list[Any]]:
        text = self._native.scene_json()
        scene = json.loads(text) if text else {}
        return {
            "objects": [LocatedObject._of(record) for record in scene.get("objects", [])],
            "unlocated": [Unlocated(**record) for record in scene.get("unlocated", [])],
            "places": [Place._of(record) for record in scene.get("places", [])],
            "relations": [Relation._of(record) for record in scene.get("relations", [])],
            "inferred": [Relation._of(record) for record in scene.get("inferred", [])],
        }

    def __repr__(self) -> str:
        height, width = self.field.shape
        depth = "" if self.depth is None else f", depth at {self.depth.density:.1%}"
        return f"<Look {width} x {height}: disparity at {self.field.density:.1%}{depth}, {len(self.objects)} objects>"


def look(
    left: Any,
    right: Any,
    *,
    rig: Rig | str | os.PathLike[str] | None = None,
    labels: Any = None,
    names: dict[int, str] | None = None,
    segment: bool = False,
    estimator: str = "vector",
    system: str = "robot-120",
    range: str = "auto",
    scales: int | None = None,
    zero_disparity: float | None = None,
    published: bool = False,
    rows_only: bool = False,
    max_disparity: int | None = None,
    min_disparity: int | None = None,
    rectify: str | None = None,
) -> Look:
    """Looks once at what two eyes see; the same bits as the command ``dorsal look``.

    ``left``, ``right``: ``(height, width)`` or ``(height, width, 3)``, ``uint8`` or ``uint16`` codes of a camera
    (RGB, not BGR), or ``(height, width)`` floats from 0 (black) to 1 (white). Views of any strides will do.

    ``rig``: the two cameras, or a file that :meth:`Rig.read` reads; gives depth in metres.

    ``labels``: ``(height, width)`` whole numbers over the left picture, 0 for none; gives objects and relations,
    called by ``names``. ``segment=True`` finds what stands on a table or the ground instead. Both need ``rig``.

    ``estimator``: ``"vector"`` assumes no rectification and sees ``(dx, dy)``; ``"dense"`` gives an answer at every
    pixel of a rectified pair, ``"dense-fast"`` in a fraction of the time. With ``segment`` dense is the better choice.

    ``system``: the distance classes, ``drs1``, ``drs2``, ``robot-150``, ``robot-120``, or the text of a TOML.

    For the vector pyramid: ``range`` is ``"near"``, ``"auto"`` or ``"wide"``, unless ``scales`` or
    ``zero_disparity`` (pixels, ``x_left - x_right``) say where it searches; ``published`` matches by the paper's own
    steps, ``rows_only`` holds the vertical shift at 0. For the dense estimators: ``max_disparity`` and
    ``min_disparity`` in pixels, and ``rectify``: ``"none"``, ``"auto"`` or ``"rig"``.

    Raises ``ValueError``, in the library's words, for what cannot be looked at. Other Python threads run meanwhile.
    """
    if labels is not None and segment:
        raise ValueError("labels says where the objects are and segment finds them; give one of the two")
    if rig is not None and not isinstance(rig, Rig):
        rig = Rig.read(rig)
    native = _native.look(
        plain(left),
        plain(right),
        rig,
        None if labels is None else label_plane(labels),
        names_of(names),
        {
            "estimator": estimator,
            "range": range,
            "scales": scales,
            "zero_disparity": zero_disparity,
            "published": published,
            "rows_only": rows_only,
            "max_disparity": max_disparity,
            "min_disparity": min_disparity,
            "rectify": rectify,
            "segment": segment,
            "system": system,
        },
    )
    return Look(native)
