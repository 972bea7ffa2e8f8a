"""What a call of the wheel costs beyond the look, and what results cost on their way to NumPy.

    python crates/dorsal-py/overhead.py            prints a table
    python crates/dorsal-py/overhead.py --write    writes it into docs/python.md, with the date and the machine

A look is timed from outside and by the wheel itself (`Look.seconds`, the levels alone); the difference is the door's:
reading the arguments, copying and checking the arrays, planning the filters. Each figure is the least and the median
of many calls, in milliseconds.
"""

import datetime
import gc
import os
import pathlib
import platform
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np

import dorsal

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "python.md"
BEGIN, END = "<!-- written by overhead.py -->\n", "<!-- end of what overhead.py writes -->\n"
WIDTH, HEIGHT = 1024, 768


def pair_of(dtype: type, colours: bool) -> tuple[np.ndarray, np.ndarray]:
    """The Motorcycle pair, made 1024 x 768 by repeating it."""
    eyes = []
    for eye in ("left", "right"):
        picture = dorsal.read_picture(ROOT / "fixtures" / "motorcycle" / f"{eye}.png")
        tiled = np.tile(picture, (2, 2, 1))[:HEIGHT, :WIDTH]
        tiled = tiled if colours else tiled[:, :, 1]
        if dtype is np.float32:
            tiled = tiled.astype(np.float32) / 255
        elif dtype is np.uint16:
            tiled = tiled.astype(np.uint16) * 257
        eyes.append(np.ascontiguousarray(tiled))
    return eyes[0], eyes[1]


def timed(call: Callable[[], float | None], rounds: int) -> str:
    """The least and the median of what the rounds took, or of what the call says that they took, in milliseconds."""
    took = []
    for _ in range(rounds):
        began = time.perf_counter()
        said = call()
        took.append(1e3 * (time.perf_counter() - began if said is None else said))
    return f"{min(took):.2f} / {statistics.median(took):.2f}"


def beyond(left: np.ndarray, right: np.ndarray) -> float:
    """Seconds of a call beyond its look."""
    began = time.perf_counter()
    look = dorsal.look(left, right, range="near")
    return time.perf_counter() - began - look.seconds


def rows() -> list[tuple[str, str]]:
    kinds = [
        ("`uint8` RGB", np.uint8, True),
        ("`uint8` grey", np.uint8, False),
        ("`uint16` grey", np.uint16, False),
        ("`float32` luma", np.float32, False),
    ]
    found = []
    for name, dtype, colours in kinds:
        left, right = pair_of(dtype, colours)
        beyond(left, right)
        found.append((f"`dorsal.look` beyond the look, {name}", timed(lambda: beyond(left, right), 12)))
    left, right = pair_of(np.uint8, True)
    view = np.concatenate([left, right], axis=1)
    halves = view[:, :WIDTH], view[:, WIDTH:]
    found.append(("the same, two halves of one wide RGB picture (views)", timed(lambda: beyond(*halves), 12)))
    small = [eye[:16, :16].copy() for eye in (left, right)]
    found.append(("the same, 16 x 16 pixels", timed(lambda: beyond(*small), 300)))
    look = dorsal.look(left, right, rig=dorsal.Rig.parallel(900.0, (511.5, 383.5), 0.1), range="near")
    for name in ("confidence", "dx", "validity", "d", "depth_m"):
        getattr(look, name)
        found.append((f"`look.{name}`", timed(lambda name=name: getattr(look, name) is None or None, 60)))
    return found


def machine() -> str:
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    return f"{name}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}"


def main() -> None:
    gc.disable()
    text = f"Read on {datetime.date.today()} on {machine()} (CPython {platform.python_version()}, NumPy {np.__version__}), "
    text += f"for pictures of {WIDTH} x {HEIGHT} pixels:\n\n| what | ms, least / median |\n|---|---|\n"
    text += "".join(f"| {name} | {took} |\n" for name, took in rows())
    print(text, end="")
    if "--write" in sys.argv[1:]:
        page = PAGE.read_text()
        before, rest = page.split(BEGIN)
        after = rest.split(END)[1]
        part = PAGE.with_suffix(".part")
        part.write_text(before + BEGIN + text + END + after)
        part.replace(PAGE)


if __name__ == "__main__":
    main()
