"""A robot of sightings alone: what it sees of a room of known things, or the lines of a file, at a steady rate."""

import json
import math
import os
import random
import time

from dora import Node

from message import send, text_of
from outbox import Outbox
from status import write_status

#: The things of the room, `(right, forward)` in metres.
ROOM = {f"thing {k}": (2.5 * math.cos(2.4 * k), 2.5 + 0.3 * k * math.sin(2.4 * k)) for k in range(8)}


def look_line(frame: tuple[float, float, float], time_ms: int, chance: random.Random) -> dict:
    """A look of a robot whose frame lies at `(x, z, turn)` of the room, at five of the things, with its errors."""
    x, z, turn = frame
    seen = []
    for name in sorted(chance.sample(sorted(ROOM), 5)):
        right, forward = ROOM[name][0] - x, ROOM[name][1] - z
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


def lines(robot: str, looks: int, frame: tuple[float, float, float]) -> list[dict]:
    """The lines of a robot, the same for the same name."""
    chance = random.Random(robot)
    return [look_line(frame, 100 * k, chance) for k in range(looks)]


def main() -> None:
    robot = os.environ["DORSAL_ROBOT"]
    looks = int(os.environ.get("DORSAL_LOOKS", "200"))
    interval_s = 1 / float(os.environ.get("DORSAL_HZ", "10"))
    x, z, turn = (float(part) for part in os.environ.get("DORSAL_FRAME", "0,0,0").split(","))
    outbox = Outbox(robot)
    node = Node()
    to_send = lines(robot, looks, (x, z, turn))
    began = time.monotonic()
    sent = 0
    while sent < looks or not outbox.empty:
        now = time.monotonic()
        if sent < looks and now >= began + sent * interval_s:
            report = outbox.add(to_send[sent])
            if report is not None:
                send(node, "reports", report)
                sent += 1
        for report in outbox.due():
            send(node, "reports", report)
        next_s = began + sent * interval_s - time.monotonic() if sent < looks else 0.1
        event = node.next(timeout=max(0.001, next_s))
        if event is None:
            break
        if event["type"] == "INPUT":
            outbox.take(json.loads(text_of(event)))
    write_status(f"robot-{robot}", outbox.counts())


if __name__ == "__main__":
    main()
