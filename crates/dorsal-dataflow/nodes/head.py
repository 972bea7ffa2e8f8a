"""The head: stereo pairs of a source, one message a pair so that its halves, its rig and its labels cannot part."""

import json
import os
import time

import numpy as np
import pyarrow as pa
from dora import Node

from source import pairs
from status import write_status


def main() -> None:
    most = int(os.environ.get("DORSAL_PAIRS", "200"))
    interval_s = float(os.environ.get("DORSAL_INTERVAL_S", "0.4"))
    node = Node()
    began = time.monotonic()
    sent = 0
    for seq, pair in zip(range(1, most + 1), pairs()):
        time.sleep(max(0.0, began + (seq - 1) * interval_s - time.monotonic()))
        height, width, channels = pair.left.shape
        taken_ms = time.time_ns() // 1_000_000 if pair.time_ms is None else pair.time_ms
        about = {"seq": seq, "time_ms": taken_ms, "height": height, "width": width, "channels": channels}
        parts = [pair.left.reshape(-1), pair.right.reshape(-1)]
        if pair.rig is not None:
            about["rig"] = pair.rig
        if pair.labels is not None:
            parts.append(pair.labels.astype("<u2").reshape(-1).view(np.uint8))
            about["names"] = json.dumps(pair.names)
        node.send_output("pair", pa.array(np.concatenate(parts)), about)
        sent = seq
    write_status("head", {"pairs": sent})


if __name__ == "__main__":
    main()
