"""From what two eyes see to depth a robot can act on and relations it can remember.

>>> import dorsal
>>> left = dorsal.read_picture("left.png")                       # doctest: +SKIP
>>> right = dorsal.read_picture("right.png")                     # doctest: +SKIP
>>> rig = dorsal.Rig.read("rig.toml")                            # doctest: +SKIP
>>> look = dorsal.look(left, right, rig=rig, segment=True)       # doctest: +SKIP
>>> look.depth_m                                                 # doctest: +SKIP

Four levels, each usable alone: :mod:`dorsal.v1`, :mod:`dorsal.disparity`, :mod:`dorsal.depth` and
:mod:`dorsal.qsr`. Arrays are ``[y, x]``, y down; metres, radians and pixels; NaN is unknown.
"""

from dorsal import depth, disparity, qsr, v1
from dorsal._look import Look, look
from dorsal._native import Refused, __version__, luma, read_labels, read_picture, set_threads
from dorsal._records import Answer, LocatedObject, Place, Relation, Unlocated
from dorsal.depth import DepthMap, Rig
from dorsal.disparity import DisparityField
from dorsal._plot import plot
from dorsal._shared import Concourse, SharedMap
from dorsal._sources import Recording, Room, RoomView
from dorsal.qsr import SceneMemory, Sighting

__all__ = [
    "Answer",
    "Concourse",
    "DepthMap",
    "DisparityField",
    "LocatedObject",
    "Look",
    "Place",
    "Recording",
    "Refused",
    "Relation",
    "Rig",
    "Room",
    "RoomView",
    "SceneMemory",
    "SharedMap",
    "Sighting",
    "Unlocated",
    "__version__",
    "depth",
    "disparity",
    "look",
    "luma",
    "plot",
    "qsr",
    "read_labels",
    "read_picture",
    "set_threads",
    "v1",
]
