"""The eyes: levels 1 to 3 beside the camera. A pair in, sightings out, kept until the map has acknowledged them.

The rig and the labels are those that come with a pair. Where the head's source is a folder (no
`DORSAL_SOURCE`) they are its `rig.toml` and `labels.toml`; `DORSAL_LABELS` names the labels of a source that has none. Without any, what stands on a table or the
ground is found, and called by its number in the look. A pair in which nothing can be looked for is counted and not reported."""

import json
import os
import pathlib
from typing import Any

import dorsal
import numpy as np
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


class Sight:
    """What a pair is looked at with: its own rig and labels, or those of files."""

    def __init__(self) -> None:
        self.rig = self.labels = None
        self.names: dict[int, str] = {}
        labels = os.environ.get("DORSAL_LABELS")
        if (folder := os.environ.get("DORSAL_PAIR")) and not os.environ.get("DORSAL_SOURCE"):
            self.rig = dorsal.Rig.read(pathlib.Path(folder) / "rig.toml")
            labels = labels or pathlib.Path(folder) / "labels.toml"
        if labels:
            self.labels, self.names = dorsal.read_labels(labels)

    def look(self, codes: np.ndarray, about: dict[str, Any]) -> dorsal.Look:
        """Looks at the bytes of a `pair`, as its metadata say what they are."""
        height, width, channels = about["height"], about["width"], about["channels"]
        pixels = 2 * height * width * channels
        left, right = codes[:pixels].reshape(2, height, width, channels)
        rig, labels, names = self.rig, self.labels, self.names
        if "rig" in about:
            rig = dorsal.Rig.from_toml(about["rig"])
        if "names" in about:
            labels = codes[pixels:].view("<u2").reshape(height, width)
            names = {int(label): name for label, name in json.loads(about["names"]).items()}
        return dorsal.look(left, right, rig=rig, labels=labels, names=names, segment=labels is None)


def main() -> None:
    sight = Sight()
    unseen = 0
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
            try:
                look = sight.look(event["value"].to_numpy(), about)
            except ValueError as why:
                unseen += 1
                print(f"pair {about['seq']}: {why}", flush=True)
                continue
            report = outbox.add(look_line(look, about["time_ms"]))
            if report is not None:
                send(node, "reports", report)
    write_status("eyes", {"pairs": gaps.came, "pairs_lost": gaps.lost, "pairs_unseen": unseen} | outbox.counts())


if __name__ == "__main__":
    main()
