"""Reports of many robots as they are replayed: the same for the same numbers."""

import json
import math
import pathlib
import random
import sys
from dataclasses import dataclass

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "nodes"))

import robot

#: Reports a second of a robot, and sightings in a report.
HZ, SEEN = 10, 5
ROBOTS_A_ROOM, THINGS = 10, 8
#: A question after every so many reports.
REPORTS_A_QUESTION = 10


@dataclass(frozen=True)
class Replay:
    """So many robots in rooms of ten, each with a frame of its own.

    With ``shards`` above one, the first robot of each room goes through a second room too, ten looks in each by turns, half
    of the house away: so it joins the rooms of two shards.
    """

    robots: int
    shards: int = 1

    @property
    def rooms(self) -> int:
        return max(self.shards, math.ceil(self.robots / ROBOTS_A_ROOM))

    def home(self, k: int) -> int:
        """The room of a robot."""
        return k // ROBOTS_A_ROOM if self.robots >= ROBOTS_A_ROOM * self.shards else k % self.shards

    def room(self, k: int, turn: int) -> int:
        """The room in which a robot takes its look number ``turn``, from 0 on."""
        first = k == 0 or self.home(k) != self.home(k - 1)
        away = self.shards > 1 and first and turn // 10 % 2 == 1
        return (self.home(k) + self.rooms // 2) % self.rooms if away else self.home(k)

    def shard(self, room: int) -> int:
        """The shard of a room: the first half of the house is the first one's."""
        return room * self.shards // self.rooms

    def reports(self, rounds: int, shard: int | None = None) -> list[list[tuple[int, int, str]]]:
        """Round by round, the robot, its room and its report as JSON; of one shard alone, if it is said."""
        chances = [random.Random(k) for k in range(self.robots)]
        frames = [(c.uniform(-1, 1), c.uniform(-1, 1), c.uniform(-math.pi, math.pi)) for c in chances]
        sent: dict[tuple[int, int], int] = {}
        made = []
        for turn in range(rounds):
            made.append([])
            for k, chance in enumerate(chances):
                room = self.room(k, turn)
                to = self.shard(room)
                line = robot.look_line(frames[k], 1000 // HZ * turn, chance)
                if shard not in (None, to):
                    continue
                for seen in line["look"]["seen"]:
                    seen["object"] = f"room {room} {seen['object']}"
                sent[k, to] = sent.get((k, to), 0) + 1
                report = {"robot": f"robot {k}", "run": 1, "seq": sent[k, to], "line": line}
                made[-1].append((k, room, json.dumps(report)))
        return made


def percentile(values_ms: list[float], part: float) -> float:
    """The value that this part of the values lies below; they need not be sorted, and there is one at least."""
    ordered = sorted(values_ms)
    return ordered[min(len(ordered) - 1, int(part * len(ordered)))]


def both(values_ms: list[float]) -> str:
    """The middle and the 99th percentile, for a table."""
    return f"{percentile(values_ms, 0.5):.2f} / {percentile(values_ms, 0.99):.2f}" if values_ms else "-"
