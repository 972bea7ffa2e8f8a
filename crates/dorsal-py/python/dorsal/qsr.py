"""Level 4: sightings as relations, and a memory of them; needs no eyes."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterable

from dorsal import _native
from dorsal._native import Refused
from dorsal._records import Answer, Place, Relation

if TYPE_CHECKING:
    from dorsal._look import Look

__all__ = [
    "Refused",
    "SceneMemory",
    "Sighting",
    "compose",
    "composition_table",
    "qualify",
    "system_classes",
]


@dataclass(frozen=True)
class Sighting:
    """Where an observer sees an object, over the ground."""

    object: str
    #: Metres over the ground, never the range along the line of sight.
    distance_m: float
    #: Radians, counter-clockwise seen from above: 0 is right, pi / 2 front.
    bearing_rad: float
    #: One standard error each; 0 claims that it is exact.
    sigma_distance_m: float = 0.0
    sigma_bearing_rad: float = 0.0
    #: Of the circle on the ground it stands in, and of its middle above the ground, in millimetres.
    radius_mm: int = 0
    height_mm: int = 0


def qualify(
    sightings: Iterable[Sighting], *, system: str = "robot-120"
) -> tuple[list[Place], list[Relation]]:
    """Sightings of one look in symbols: the places for the observer, and the sound relations between the objects."""
    record = json.loads(_native.qualify(_dumps([_seen(one) for one in sightings]), system))
    return (
        [Place._of(place) for place in record["places"]],
        [Relation._of(relation) for relation in record["relations"]],
    )


def compose(
    first: str | Iterable[str],
    second: str | Iterable[str],
    *,
    case: int = 1,
    system: str = "drs1",
    mode: str = "sound",
) -> list[str]:
    """What two distances say about a third, in one of the paper's four cases: labels, nearest first.

    Each distance is a label or a set of labels; ``mode`` is ``"sound"`` or ``"published"``.
    """
    one = [first] if isinstance(first, str) else list(first)
    other = [second] if isinstance(second, str) else list(second)
    return _native.compose(one, other, case, system, mode)


def composition_table(*, case: int = 1, system: str = "drs1", mode: str = "sound") -> dict[str, Any]:
    """A whole composition table, as data."""
    return json.loads(_native.composition_table(case, system, mode))


def system_classes(system: str) -> dict[str, Any]:
    """The distance classes of a reference system, as data."""
    return json.loads(_native.system(system))


class SceneMemory:
    """What a robot remembers of the things around it, look after look; see docs/calculus.md.

    ``policy``: ``"refuse"`` refuses a look that contradicts the memory, ``"follow"`` believes what is seen. Several
    threads may hold one memory: each call sees it whole. What is refused raises :class:`Refused` and leaves the memory
    as it was.
    """

    def __init__(self, *, system: str = "robot-120", policy: str = "refuse") -> None:
        self._native = _native.Memory(system, policy)

    @classmethod
    def from_json(cls, text: str) -> SceneMemory:
        """The memory of a snapshot, the command's too (``dorsal memory``)."""
        memory = cls.__new__(cls)
        memory._native = _native.Memory.from_json(text)
        return memory

    def to_json(self) -> str:
        """A snapshot: one line of JSON, the same for the same memory."""
        return self._native.to_json()

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> SceneMemory:
        """Reads a snapshot from a file."""
        with open(path, encoding="utf-8") as file:
            return cls.from_json(file.read())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a snapshot, whole or not at all, and returns when it is on the disk."""
        folder = os.path.dirname(os.path.abspath(path))
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=folder, delete=False) as file:
            try:
                file.write(self.to_json() + "\n")
                file.flush()
                os.fsync(file.fileno())
                os.replace(file.name, path)
            except BaseException:
                os.unlink(file.name)
                raise

    def observe(
        self,
        sightings: Iterable[Sighting],
        *,
        time_ms: int,
        pose: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
        pose_sigma_m: float = 0.0,
        pose_sigma_rad: float = 0.0,
        view: tuple[float, float] | None = None,
    ) -> list[dict[str, Any]]:
        """Takes in what one look shows, and says what became different.

        ``pose`` is ``(x_m, z_m, heading_rad)`` in the map: right and forward of its origin, turned to the left;
        ``None`` if the robot lost it. ``view`` is ``(half_rad, reach_m)``, the sector in which everything that stands
        would have been reported; without it a look says nothing of what it does not show.
        """
        look = {
            "time_ms": time_ms,
            "pose": _pose(pose, pose_sigma_m, pose_sigma_rad),
            "seen": [_seen(one) for one in sightings],
            "view": None if view is None else {"half_rad": view[0], "reach_m": view[1]},
        }
        return self._line({"look": look})["changes"]

    def remember(
        self,
        look: Look,
        *,
        time_ms: int,
        pose: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
        pose_sigma_m: float = 0.0,
        pose_sigma_rad: float = 0.0,
        eyes_above_ground_m: float = 0.0,
    ) -> list[dict[str, Any]]:
        """Takes in a look of the eyes, whose depth is evidence for what it does not show."""
        pose_line = _pose(pose, pose_sigma_m, pose_sigma_rad)
        pose_text = None if pose_line is None else _dumps(pose_line)
        return json.loads(self._native.remember(look._native, time_ms, pose_text, eyes_above_ground_m))

    def ask(self, words: str) -> Answer:
        """Answers a question, such as ``"relation cup from box seen from robot"``, ``"within vc,c of robot"``,
        ``"between a and b"``, ``"reachable cup within 0.8"``, ``"free_path from robot to cup radius 0.05"``,
        ``"last_seen cup"``, ``"where cup"`` or ``"explain cup from box"``.

        ``ValueError`` for words that are no question, :class:`Refused` where the memory does not know.
        """
        said, data = self._native.ask(words)
        return Answer(said, json.loads(data))

    def explain(self, to: str, from_: str) -> Answer:
        """Why the distance of ``to`` from ``from_`` is what it is: a proof, step by step."""
        return self.ask(f"explain {_word(to)} from {_word(from_)}")

    def tell(self, fact: str) -> list[dict[str, Any]]:
        """Takes in a told fact, such as ``"lamp within vc of cup"``."""
        return self._line({"tell": fact})["changes"]

    def retract(self, fact: str) -> list[dict[str, Any]]:
        """Takes a told fact back."""
        return self._line({"retract": fact})["changes"]

    @property
    def objects(self) -> dict[str, dict[str, Any]]:
        """What is kept of every object, tombstones included, by name."""
        return json.loads(self.to_json())["objects"]

    def _line(self, line: dict[str, Any]) -> dict[str, Any]:
        return json.loads(self._native.take_line(_dumps(line)))


def _seen(sighting: Sighting) -> dict[str, Any]:
    return dict(vars(sighting))


def _pose(
    pose: tuple[float, float, float] | None, sigma_m: float, sigma_rad: float
) -> dict[str, float] | None:
    if pose is None:
        return None
    x_m, z_m, heading_rad = (float(number) for number in pose)
    return {
        "x_m": x_m,
        "z_m": z_m,
        "heading_rad": heading_rad,
        "sigma_m": sigma_m,
        "sigma_heading_rad": sigma_rad,
    }


def _word(name: str) -> str:
    return f'"{name}"'


def _dumps(record: Any) -> str:
    try:
        return json.dumps(record, allow_nan=False)
    except ValueError:
        raise ValueError("a number of the look is NaN or infinite; every one must be finite") from None
    except TypeError as why:
        raise ValueError(f"a value of the look is no plain number or text: {why}") from None
