"""A robot of sightings alone: what it sees of rooms of known things, at a steady rate.

`DORSAL_ROOMS`, such as "0,1", names the rooms that it goes through, ten looks in each; each room has a shard of the map, to
which its looks go (`reports_0`, `receipts_0`). Without it there is one room and one map (`reports`, `receipts`).

`DORSAL_VANISH_AFTER` ends the process by SIGKILL after so many looks; `DORSAL_JOIN_S` lets it join so many seconds late, with
a snapshot of the whole map, which it asks for first."""

import json
import math
import os
import random
import signal
import time
from collections.abc import Sequence

from dora import Node

from message import send, text_of
from outbox import Outbox
from status import write_status

#: The things of each room, `(right, forward)` in metres of the house; the second room lies beyond the first.
ROOMS = [
    {f"{name} {k}": (2.5 * math.cos(2.4 * k), ahead + 2.5 + 0.3 * k * math.sin(2.4 * k)) for k in range(8)}
    for name, ahead in (("thing", 0.0), ("far thing", 6.0))
]
ROOM = ROOMS[0]
#: Looks in a room before the next.
STAY = 10


def look_line(
    frame: tuple[float, float, float], time_ms: int, chance: random.Random, room: dict[str, tuple[float, float]] = ROOM
) -> dict:
    """A look of a robot whose frame lies at `(x, z, turn)` of the room, at five of a room's things, with its errors."""
    x, z, turn = frame
    seen = []
    for name in sorted(chance.sample(sorted(room), 5)):
        right, forward = room[name][0] - x, room[name][1] - z
        seen.append(
            {
                "object": name,
                "distance_m": max(0.01, math.hypot(right, forward) + chance.gauss(0, 0.01)),
                "bearing_rad": (math.atan2(forward, right) - turn + chance.gauss(0, 0.005)) % math.tau,
                "sigma_distance_m": 0.01,
                "sigma_bearing_rad": 0.005,
            }
        )
    pose = {"x_m": 0.0, "z_m": 0.0, "heading_rad": 0.0}
    return {"look": {"time_ms": time_ms, "pose": pose, "seen": seen, "view": None}}


def room_of(look: int, rooms: Sequence[int]) -> int:
    """The room in which a robot takes this look, counted from 0."""
    return rooms[look // STAY % len(rooms)]


def lines(robot: str, looks: int, frame: tuple[float, float, float], rooms: Sequence[int] = (0,)) -> list[dict]:
    """The lines of a robot, the same for the same name."""
    chance = random.Random(robot)
    return [look_line(frame, 100 * k, chance, ROOMS[room_of(k, rooms)]) for k in range(looks)]


def snapshot(node: Node, robot: str) -> str | None:
    """The whole map, as the map node gives it to one that joins late."""
    send(node, "questions", {"id": f"{robot} joins", "robot": robot, "words": None})
    until = time.monotonic() + 10
    while time.monotonic() < until:
        event = node.next(timeout=1.0)
        if event is not None and event["type"] == "INPUT" and event["id"] == "answers":
            document = json.loads(text_of(event))
            if document["id"] == f"{robot} joins":
                return document["snapshot"]
    return None


def main() -> None:
    robot = os.environ["DORSAL_ROBOT"]
    looks = int(os.environ.get("DORSAL_LOOKS", "200"))
    vanish_after = int(os.environ.get("DORSAL_VANISH_AFTER", "0"))
    join_s = float(os.environ.get("DORSAL_JOIN_S", "0"))
    interval_s = 1 / float(os.environ.get("DORSAL_HZ", "10"))
    x, z, turn = (float(part) for part in os.environ.get("DORSAL_FRAME", "0,0,0").split(","))
    said = os.environ.get("DORSAL_ROOMS")
    rooms = [0] if said is None else [int(room) for room in said.split(",")]
    # A shard numbers what it gets, so each has an outbox of its own.
    ends = {room: "" if said is None else f"_{room}" for room in rooms}
    outboxes = {room: Outbox(robot) for room in rooms}
    node = Node()
    counts: dict = {}
    if join_s > 0:
        time.sleep(join_s)
        text = snapshot(node, robot)
        robots = {} if text is None else json.loads(text)["robots"]
        counts["snapshot"] = {name: kept["seq"] for name, kept in robots.items()}
    to_send = lines(robot, looks, (x, z, turn), rooms)
    began = time.monotonic()
    sent = 0
    while sent < looks or not all(outbox.empty for outbox in outboxes.values()):
        now = time.monotonic()
        if sent < looks and now >= began + sent * interval_s:
            if vanish_after and sent == vanish_after:
                os.kill(os.getpid(), signal.SIGKILL)
            room = room_of(sent, rooms)
            report = outboxes[room].add(to_send[sent])
            if report is not None:
                send(node, f"reports{ends[room]}", report)
                sent += 1
        for room, outbox in outboxes.items():
            for report in outbox.due():
                send(node, f"reports{ends[room]}", report)
        next_s = began + sent * interval_s - time.monotonic() if sent < looks else 0.1
        event = node.next(timeout=max(0.001, next_s))
        if event is None:
            break
        if event["type"] == "INPUT" and event["id"].startswith("receipts"):
            [outbox] = [outboxes[room] for room in rooms if event["id"] == f"receipts{ends[room]}"]
            outbox.take(json.loads(text_of(event)))
    for outbox in outboxes.values():
        for name, count in outbox.counts().items():
            counts[name] = counts.get(name, 0) + count
    write_status(f"robot-{robot}", counts)


if __name__ == "__main__":
    main()
