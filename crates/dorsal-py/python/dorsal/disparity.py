"""Level 2: two pictures as a field of disparities, each with confidence and the reason where there is none."""

from __future__ import annotations

from typing import Any

import numpy as np

from dorsal import _native
from dorsal._arrays import plain, plane

__all__ = ["VALIDITY", "DisparityField", "estimate", "flow"]

#: What the codes of :attr:`DisparityField.validity` mean.
VALIDITY = {
    255: "valid",
    200: "inconsistent",
    150: "occluded",
    100: "out of view",
    50: "incoherent",
    25: "singular",
    0: "no energy",
}


class DisparityField:
    """The disparity of every pixel of the left picture, ``[y, x]``, in pixels.

    Left ``(x, y)`` matches right ``(x + dx, y + dy)``.
    """

    def __init__(self, native: _native.Field) -> None:
        self._native = native

    @classmethod
    def of_planes(cls, dx: Any, dy: Any = None, confidence: Any = None) -> DisparityField:
        """A field of another estimator: ``dx`` right minus left, NaN where unknown.

        ``dy`` is 0 and ``confidence`` 1 if they are not given. OpenCV's matchers give ``-16 dx``.
        """
        dx = plane("dx", dx)
        dy = np.zeros_like(dx) if dy is None else plane("dy", dy)
        confidence = np.ones_like(dx) if confidence is None else plane("confidence", confidence)
        return cls(_native.Field.of_planes(dx, dy, confidence))

    @property
    def shape(self) -> tuple[int, int]:
        """``(height, width)``."""
        return self._native.shape

    @property
    def density(self) -> float:
        """The part of the pixels with an answer, from 0 to 1."""
        return self._native.density

    @property
    def d(self) -> np.ndarray:
        """``x_left - x_right``, nearer is larger; NaN unknown."""
        return self._native.d

    @property
    def dx(self) -> np.ndarray:
        """``x_right - x_left``; NaN unknown."""
        return self._native.dx

    @property
    def dy(self) -> np.ndarray:
        """``y_right - y_left``; NaN unknown."""
        return self._native.dy

    @property
    def guess_dx(self) -> np.ndarray:
        """``x_right - x_left``, with a best guess where there is no answer; read-only, no copy."""
        return self._native.guess_dx

    @property
    def guess_dy(self) -> np.ndarray:
        """``y_right - y_left``, with a best guess where there is no answer; read-only, no copy."""
        return self._native.guess_dy

    @property
    def confidence(self) -> np.ndarray:
        """From 0 to 1; read-only, no copy."""
        return self._native.confidence

    @property
    def validity(self) -> np.ndarray:
        """``uint8``: 255 where there is an answer, else the reason for none, as :data:`VALIDITY` names it."""
        return self._native.validity

    @property
    def sigma_dx(self) -> np.ndarray | None:
        """One standard deviation of ``dx``, in pixels, infinite where unknown; the vector pyramid's alone."""
        return self._native.sigma_dx

    @property
    def sigma_dy(self) -> np.ndarray | None:
        """One standard deviation of ``dy``, in pixels, infinite where unknown; the vector pyramid's alone."""
        return self._native.sigma_dy


def estimate(left: Any, right: Any, **how: Any) -> DisparityField:
    """The disparity of a pair; arguments as those of :func:`dorsal.look`."""
    from dorsal._look import look

    return look(left, right, **how).field


def flow(before: Any, after: Any, *, scales: int = 6) -> DisparityField:
    """Optic flow: where every point of ``before`` has gone, ``(x + dx, y + dy)`` in ``after``.

    ``scales`` of the pyramid find motion of up to ``0.75 * 2**scales`` pixels.
    """
    return DisparityField(_native.flow(plain(before), plain(after), scales))
