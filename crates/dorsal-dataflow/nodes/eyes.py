"""The eyes: levels 1 to 3 beside the camera. A pair in, sightings out, kept until the map has acknowledged them."""

import json
import os
import pathlib

import dorsal
from dora import Node

from gaps import Gaps
from message import send, text_of
from outbox import Outbox
from status import write_status


def look_line(look: dorsal.Look, time_ms: int) -> dict:
    """What a look shows as a line of the memory. What it does not show is no evidence: `view` stays out."""
    seen = [
        {
            "object": one.name,
            "distance_m": one.distance_m,
            "bearing_rad": one.bearing_rad,
            "sigma_distance_m": one.distance_sigma_m,
            "sigma_bearing_rad": one.bearing_sigma_rad,
            "radius_mm": round(1000 * one.radius_m),
        }
        for one in look.objects
    ]
    pose = {"x_m": 0.0, "z_m": 0.0, "heading_rad": 0.0}
    return {"look": {"time_ms": time_ms, "pose": pose, "seen": seen, "view": None}}


def main() -> None:
    folder = pathlib.Path(os.environ["DORSAL_PAIR"])
    rig = dorsal.Rig.read(folder / "rig.toml")
    labels, names = dorsal.read_labels(folder / "labels.toml")
    # Receipts are read between looks, and a look takes a good part of a second.
    outbox = Outbox(os.environ.get("DORSAL_ROBOT", "robot"), again_after_s=3.0)
    gaps = Gaps()
    node = Node()
    seeing = True
    while seeing or not outbox.empty:
        event = node.next(timeout=0.2)
        for report in outbox.due():
            send(node, "reports", report)
        if event is None:
            break
        if event["type"] == "STOP" and not seeing:
            break
        if event["type"] == "INPUT_CLOSED" and event["id"] == "pair":
            seeing = False
        elif event["type"] == "INPUT" and event["id"] == "receipts":
            outbox.take(json.loads(text_of(event)))
        elif event["type"] == "INPUT" and event["id"] == "pair":
            about = event["metadata"]
            gaps.take(about["seq"])
            shape = (2, about["height"], about["width"], about["channels"])
            left, right = event["value"].to_numpy().reshape(shape)
            look = dorsal.look(left, right, rig=rig, labels=labels, names=names)
            report = outbox.add(look_line(look, about["time_ms"]))
            if report is not None:
                send(node, "reports", report)
    write_status("eyes", {"pairs": gaps.came, "pairs_lost": gaps.lost} | outbox.counts())


if __name__ == "__main__":
    main()
