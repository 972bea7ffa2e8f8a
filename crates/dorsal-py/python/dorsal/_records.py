"""What a look or a memory says of objects, as plain objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class LocatedObject:
    """Where an object is, in the observer's level frame: x right, y down, z forward over the ground."""

    name: str
    label: int
    #: Metres ``(x, y, z)`` from the observer.
    position_m: tuple[float, float, float]
    #: One standard deviation along each axis, in metres.
    sigma_m: tuple[float, float, float]
    #: The median depth along the head's forward axis, in metres.
    depth_m: float
    #: Over the ground, in metres, and one standard deviation.
    distance_m: float
    distance_sigma_m: float
    #: Over the ground, in radians: 0 is right, pi / 2 front; and one standard deviation.
    bearing_rad: float
    bearing_sigma_rad: float
    #: Of the disc that covers as many pixels at this range, in metres.
    radius_m: float
    #: The median pixel ``(x, y)`` of the left picture.
    pixel: tuple[float, float]
    #: How many pixels bear the label, have a known depth, and agree on it.
    pixels: int
    reliable_pixels: int
    agreeing_pixels: int

    @classmethod
    def _of(cls, record: dict[str, Any]) -> LocatedObject:
        for key in ("position_m", "sigma_m", "pixel"):
            record[key] = tuple(record[key])
        return cls(**record)


@dataclass(frozen=True)
class Unlocated:
    """A labelled object without a place, and why."""

    name: str
    label: int
    pixels: int
    reliable_pixels: int
    reason: str


@dataclass(frozen=True)
class Place:
    """Where an object is for the observer, in symbols: every label that may hold."""

    object: str
    #: Short labels of the distance classes, nearest first.
    depth: tuple[str, ...]
    #: Short labels of the orientations: ``fl sf fr l n r bl sb br``.
    orientation: tuple[str, ...]
    #: What a person reads: one distance class and one orientation.
    read: tuple[str, str]
    #: ``sound`` or ``published``.
    mode: str

    @classmethod
    def _of(cls, record: dict[str, Any]) -> Place:
        return cls(
            object=record["object"],
            depth=tuple(record["depth"]),
            orientation=tuple(record["orientation"]),
            read=_read(record["read"]),
            mode=record["mode"],
        )


@dataclass(frozen=True)
class Relation:
    """Where the object ``to`` is at the object ``from_``: every label that may hold, and why."""

    from_: str
    to: str
    depth: tuple[str, ...]
    orientation: tuple[str, ...]
    #: What a person reads; ``None`` where nothing was measured.
    read: tuple[str, str] | None
    mode: str
    #: ``{"by": "measured", "looks": [..]}`` or ``{"by": "composed", "look": .., "through": [..]}``.
    reason: dict[str, Any]

    @classmethod
    def _of(cls, record: dict[str, Any]) -> Relation:
        return cls(
            from_=record["from"],
            to=record["to"],
            depth=tuple(record["depth"]),
            orientation=tuple(record["orientation"]),
            read=_read(record["read"]) if record["read"] else None,
            mode=record["mode"],
            reason=record["reason"],
        )

    def __str__(self) -> str:
        words = f"{self.to} at {self.from_}: {{{', '.join(self.depth)}}}, {{{', '.join(self.orientation)}}}"
        return words + (f"; read {' '.join(self.read)}" if self.read else "")


@dataclass(frozen=True)
class Answer:
    """The answer of a memory: ``str`` of it is for a person, ``data`` for a program."""

    words: str
    #: ``data["answer"]`` names its kind; what belongs to it stands beside.
    data: dict[str, Any]

    def __str__(self) -> str:
        return self.words


def _read(record: dict[str, str]) -> tuple[str, str]:
    return (record["depth"], record["orientation"])
