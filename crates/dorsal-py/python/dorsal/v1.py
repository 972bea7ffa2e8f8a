"""Level 1: a picture as complex Gabor responses over scales and orientations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dorsal import _native
from dorsal._arrays import plain

__all__ = ["energy", "respond"]


def respond(
    image: Any,
    *,
    scales: int = 6,
    orientations: int = 8,
    peak_frequency: float = math.pi / 2,
    bandwidth: float = 1.0,
) -> list[np.ndarray]:
    """The responses of each scale, finest first: ``complex64`` of shape ``(orientations, height, width)``.

    Filter ``q`` has its wave vector along ``q pi / orientations``: 0 hears vertical bars. ``peak_frequency`` is in
    radians a pixel of each scale, ``bandwidth`` in octaves; every scale has half the size of the one before, and
    there are fewer where the picture is too small. ``image`` as in :func:`dorsal.look`.
    """
    return _native.respond(plain(image), scales, orientations, peak_frequency, bandwidth)


def energy(responses: np.ndarray) -> np.ndarray:
    """The squared modulus of responses, of the same shape, ``float32``."""
    return responses.real**2 + responses.imag**2
