"""How much a map process takes, and two shards: replayed sightings of many robots at 10 Hz, without a dataflow around them.

    python crates/dorsal-dataflow/scale 1 10 100 1000            prints the tables
    python crates/dorsal-dataflow/scale 1 10 100 1000 --write    writes them into docs/scale.md, with the date and the machine

A report is due every 100 ms of each robot, evenly spread; latency is from when it was due to when its receipt was there, and the
question after every 10th report answered, so that waiting in line counts. Where one process saturates is looked for between the
numbers that were given, by halves.
"""

import argparse
import datetime
import os
import pathlib
import platform
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "nodes"))

import measure
from replay import HZ, SEEN, both, percentile

PAGE = pathlib.Path(__file__).resolve().parents[3] / "docs" / "scale.md"
BEGIN, END = "<!-- written by crates/dorsal-dataflow/scale -->\n", "<!-- end of what it writes -->\n"
#: What a map process must keep to be said to hold so many robots.
BOUND_MS, LEAST_TAKEN = 50.0, 0.99


def machine() -> str:
    """What this ran on, and how busy it was."""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    return f"{name}, {os.cpu_count()} processors, CPython {platform.python_version()}"


def load() -> str:
    return f"{os.getloadavg()[0]:.1f}"


def holds(robots: int, measured: dict, seconds: float) -> bool:
    """Whether it took what was sent, with answers in time."""
    enough = measured["taken"] >= LEAST_TAKEN * robots * HZ * seconds
    return enough and percentile(measured["answers_ms"] or measured["receipts_ms"], 0.99) < BOUND_MS


def one_process(numbers: list[int], seconds: float) -> tuple[str, dict[int, bool]]:
    text = "| robots | sightings a second, of those sent | sighting to receipt, p50 / p99 ms | sighting to answer, p50 / p99 ms "
    text += "| CPU of a core | MB that the map added | bytes a second a robot | load of the machine |\n|---|---|---|---|---|---|---|---|\n"
    kept = {}
    for robots in numbers:
        m = measure.one(robots, seconds)
        kept[robots] = holds(robots, m, seconds)
        text += (
            f"| {robots} | {SEEN * m['taken'] / m['seconds']:.0f} of {SEEN * HZ * robots} | {both(m['receipts_ms'])} "
            f"| {both(m['answers_ms'])} | {100 * m['cpu_s'] / m['seconds']:.0f} % | {m['mb']:.1f} "
            f"| {HZ * m['bytes'] / m['taken']:.0f} | {load()} |\n"
        )
        print(text.splitlines()[-1], flush=True)
    return text, kept


def saturation(kept: dict[int, bool], seconds: float) -> str:
    """Where one process ceases to hold, between two numbers that were measured, to a tenth."""
    good = max((robots for robots, held in kept.items() if held), default=0)
    bad = min((robots for robots, held in kept.items() if not held and robots > good), default=0)
    if not bad:
        return f"One process held all of {good} robots.\n"
    tried = []
    while bad - good > max(1, good // 10):
        middle = (good + bad) // 2
        m = measure.one(middle, seconds)
        held = holds(middle, m, seconds)
        tried.append(f"{middle} {'held' if held else 'not held'} (p99 {percentile(m['answers_ms'] or m['receipts_ms'], 0.99):.0f} ms)")
        good, bad = (middle, bad) if held else (good, middle)
        print(tried[-1], flush=True)
    return (
        f"One process held {good} robots and not {bad}: to hold is to take {100 * LEAST_TAKEN:.0f} % of what is sent in time, with a 99th "
        f"percentile of answers below {BOUND_MS:.0f} ms. Tried between: {', '.join(tried)}.\n"
    )


def two_shards(numbers: list[int], seconds: float) -> str:
    text = "| robots | sightings a second, of those sent | sighting to receipt, p50 / p99 ms | answer of one shard, p50 / p99 ms "
    text += "| answer across shards, p50 / p99 ms | asked across, refused | CPU of a core: each shard, the concourse | load |\n"
    text += "|---|---|---|---|---|---|---|---|\n"
    for robots in numbers:
        each, across = measure.shards(robots, seconds)
        taken = sum(SEEN * m["taken"] / m["seconds"] for m in each)
        cpu = ", ".join(f"{100 * m['cpu_s'] / m['seconds']:.0f} %" for m in each)
        text += (
            f"| {robots} | {taken:.0f} of {SEEN * HZ * robots} | {both([t for m in each for t in m['receipts_ms']])} "
            f"| {both([t for m in each for t in m['answers_ms']])} | {both(across['took_ms'])} "
            f"| {across['asked']}, {across['refused']} | {cpu}, {100 * across['cpu']:.0f} % | {load()} |\n"
        )
        print(text.splitlines()[-1], flush=True)
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robots", type=int, nargs="+", help="how many robots, one row each")
    parser.add_argument("--seconds", type=float, default=10.0, help="how long each row is replayed")
    parser.add_argument("--write", action="store_true", help="write the tables into docs/scale.md")
    arguments = parser.parse_args()
    text = f"Measured on {datetime.date.today()} on {machine()}, {arguments.seconds:.0f} seconds a row.\n\n### One map process\n\n"
    table, kept = one_process(arguments.robots, arguments.seconds)
    text += table + "\n" + saturation(kept, arguments.seconds)
    text += "\n### Two shards and a concourse\n\n" + two_shards([n for n in arguments.robots if n > 1], arguments.seconds)
    if arguments.write:
        page = PAGE.read_text()
        before, rest = page.split(BEGIN)
        part = PAGE.with_suffix(".part")
        part.write_text(before + BEGIN + text + END + rest.split(END)[1])
        part.replace(PAGE)
    else:
        print("\n" + text, end="")


if __name__ == "__main__":
    main()
