"""The head: stereo pairs of a folder, again and again, one message a pair so that its halves cannot part."""

import os
import pathlib
import time

import dorsal
import numpy as np
import pyarrow as pa
from dora import Node

from status import write_status


def noisy(picture: np.ndarray, sigma: float, seed: int) -> np.ndarray:
    """The picture as a camera with this much noise would give it, in codes; the same for the same seed."""
    if sigma == 0:
        return picture
    noise = np.random.default_rng(seed).normal(0, sigma, picture.shape)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)


def main() -> None:
    folder = pathlib.Path(os.environ["DORSAL_PAIR"])
    pairs = int(os.environ.get("DORSAL_PAIRS", "200"))
    interval_s = float(os.environ.get("DORSAL_INTERVAL_S", "0.4"))
    sigma = float(os.environ.get("DORSAL_NOISE", "0"))
    eyes = [dorsal.read_picture(folder / f"{eye}.png") for eye in ("left", "right")]
    height, width, channels = eyes[0].shape
    node = Node()
    began = time.monotonic()
    for seq in range(1, pairs + 1):
        time.sleep(max(0.0, began + (seq - 1) * interval_s - time.monotonic()))
        pair = np.stack([noisy(eye, sigma, 2 * seq + side) for side, eye in enumerate(eyes)])
        about = {"seq": seq, "time_ms": time.time_ns() // 1_000_000}
        shape = {"height": height, "width": width, "channels": channels}
        node.send_output("pair", pa.array(pair.reshape(-1)), about | shape)
    write_status("head", {"pairs": pairs})


if __name__ == "__main__":
    main()
