"""How much one map process takes: replayed sightings of many robots at 10 Hz, without a dataflow around it.

    python crates/dorsal-dataflow/scale.py 1 10 100 1000

Prints a row of a Markdown table for each number of robots. A report is due every 100 ms of each robot, evenly spread; the
latency is from when it was due to when its receipt was there, the question (one after every 10th report) answered
with it, so that waiting in line counts. Five sightings a report, eight things a room, ten robots a room.
Once a report is more than five seconds late, the rest of its round is given up.
"""

import json
import math
import pathlib
import random
import resource
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "nodes"))

import dorsal
import robot

SECONDS = 10.0
ROBOTS_A_ROOM = 10


def reports_of(robots: int, rounds: int) -> list[list[str]]:
    """The reports of all robots, round by round."""
    chances = [random.Random(k) for k in range(robots)]
    frames = [(chance.uniform(-1, 1), chance.uniform(-1, 1), chance.uniform(-math.pi, math.pi)) for chance in chances]
    made = []
    for turn in range(rounds):
        made.append([])
        for k, chance in enumerate(chances):
            line = robot.look_line(frames[k], 100 * turn, chance)
            for seen in line["look"]["seen"]:
                seen["object"] = f"room {k // ROBOTS_A_ROOM} {seen['object']}"
            report = {"robot": f"robot {k}", "run": 1, "seq": turn + 1, "line": line}
            made[-1].append(json.dumps(report))
    return made


def percentile(sorted_ms: list[float], part: float) -> float:
    return sorted_ms[min(len(sorted_ms) - 1, int(part * len(sorted_ms)))]


def measure(robots: int) -> str:
    rounds = int(SECONDS * 10)
    reports = reports_of(robots, rounds)
    taken_ms: list[float] = []
    answered_ms: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        shared = dorsal.SharedMap(folder)
        began, cpu = time.perf_counter(), time.process_time()
        step, done = 0.1 / robots, 0
        for turn in range(rounds):
            for k, text in enumerate(reports[turn]):
                due = began + (turn * robots + k) * step
                wait = due - time.perf_counter()
                if wait > 0:
                    time.sleep(wait)
                elif -wait > 5.0:
                    break
                shared.take([text])
                taken_ms.append(1e3 * (time.perf_counter() - due))
                done += 1
                if done % 10 == 0:
                    room = k // ROBOTS_A_ROOM
                    try:
                        shared.ask(f"robot {k}", f'where "room {room} thing {turn % 8}"')
                    except dorsal.Refused:
                        continue
                    answered_ms.append(1e3 * (time.perf_counter() - due))
        took, used = time.perf_counter() - began, time.process_time() - cpu
    taken_ms.sort()
    answered_ms.sort()
    mean_bytes = sum(map(len, reports[0])) / robots
    rss = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    cells = [
        f"{robots}",
        f"{5 * done / took:.0f} of {50 * robots}",
        f"{percentile(taken_ms, 0.5):.2f} / {percentile(taken_ms, 0.99):.2f}",
        f"{percentile(answered_ms, 0.5):.2f} / {percentile(answered_ms, 0.99):.2f}" if answered_ms else "-",
        f"{100 * used / took:.0f} %",
        f"{rss:.0f}",
        f"{10 * mean_bytes:.0f}",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    print("| robots | sightings a second, of those sent | receipt p50 / p99 ms | answer p50 / p99 ms | CPU of a core | largest memory so far, MB, reports held for replay included | bytes a second a robot |")
    print("|---|---|---|---|---|---|---|")
    for robots in map(int, sys.argv[1:]):
        print(measure(robots), flush=True)


if __name__ == "__main__":
    main()
