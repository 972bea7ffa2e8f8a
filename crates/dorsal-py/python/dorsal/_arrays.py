"""Arrays of callers as the native half takes them: copied only where it could not read them."""

from __future__ import annotations

from typing import Any

import numpy as np


def plain(array: Any) -> np.ndarray:
    """The array in the byte order of this machine, aligned; views of any strides stay views."""
    array = np.asarray(array)
    if not array.dtype.isnative:
        array = array.astype(array.dtype.newbyteorder("="))
    return np.require(array, requirements="A")


def plane(name: str, array: Any) -> np.ndarray:
    """A plane ``(height, width)`` of numbers, as ``float32``."""
    array = np.asarray(array)
    if array.ndim != 2:
        raise ValueError(f"{name} has shape {array.shape}; a plane is (height, width)")
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name} holds {array.dtype}; wanted are numbers, such as float32")
    return plain(array.astype(np.float32, copy=False))


def label_plane(labels: Any) -> np.ndarray:
    """Labels ``(height, width)`` of any integer type or ``bool``, as ``uint16``; 0 is no object."""
    labels = np.asarray(labels)
    if labels.ndim != 2:
        raise ValueError(f"labels has shape {labels.shape}; labels are (height, width)")
    if labels.dtype.kind not in "biu":
        raise ValueError(f"labels holds {labels.dtype}; labels are whole numbers")
    if labels.dtype.itemsize > 1 and labels.dtype != np.uint16 and labels.size:
        least, most = int(labels.min()), int(labels.max())
        if least < 0 or most > 65535:
            raise ValueError(f"labels runs from {least} to {most}; labels are from 0 to 65535")
    elif labels.dtype.kind == "i" and labels.size and int(labels.min()) < 0:
        raise ValueError(f"labels runs from {int(labels.min())}; labels are from 0 to 65535")
    return plain(labels.astype(np.uint16, copy=False))


def names_of(names: dict[int, str] | None) -> dict[int, str]:
    """Names by label; no two labels may share one, for relations tell objects by their names."""
    names = {int(label): str(name) for label, name in (names or {}).items()}
    bearers: dict[str, int] = {}
    for label, name in names.items():
        if not 0 < label <= 65535:
            raise ValueError(f"{label} in names is no label; labels of objects are from 1 to 65535")
        if not name.strip():
            raise ValueError(f"label {label} has an empty name")
        if name in bearers:
            raise ValueError(f"labels {bearers[name]} and {label} are both named '{name}'")
        bearers[name] = label
    return names
