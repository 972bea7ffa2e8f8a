"""Three robots, one map: each keeps its frame, and the map process may die at any moment."""

import json
import os
import random
import signal
import time

import dorsal
import graph
import robot

FRAMES = {"a": (0.0, 0.0, 0.0), "b": (2.5, 1.0, 1.1), "c": (-2.0, 3.0, -1.9)}


def in_one_process(looks: int, left: dict) -> dict:
    """The map of the same looks, none of which went through a graph."""
    reports = [
        {"robot": name, "run": left["robots"][name]["run"], "seq": seq, "line": line}
        for name, frame in FRAMES.items()
        for seq, line in enumerate(robot.lines(name, looks, frame), 1)
    ]
    return json.loads(graph.single_process(reports))


def check(out, looks: int) -> None:
    left = json.loads(graph.map_of(out))
    assert sorted(left["robots"]) == sorted(FRAMES)
    for name, kept in left["robots"].items():
        counted = graph.status(out, f"robot-{name}")
        assert counted["acknowledged"] == counted["reports"] == kept["seq"] == looks, (counted, kept["seq"])
        assert kept["lost"] == 0
    assert left == in_one_process(looks, left)


def test_three_robots_make_one_map(tmp_path):
    running = graph.start("three-robots.yml", tmp_path, DORSAL_LOOKS="200", DORSAL_HZ="50", DORSAL_QUESTION='where "thing 1"')
    graph.finished(running, tmp_path, 60)
    check(tmp_path, 200)
    shared = dorsal.SharedMap(tmp_path / "map")
    # Every robot is told of every thing where it is, within what it can know.
    for name, (x, z, turn) in FRAMES.items():
        for thing in robot.ROOM:
            shared.ask(name, f'where "{thing}"')
    answered = graph.status(tmp_path, "question")
    assert answered["answered"] == answered["asked"] > 0 == answered["refused"]


def test_nothing_acknowledged_is_lost_to_twenty_kills(tmp_path):
    looks, chance = 500, random.Random(20)
    running = graph.start("three-robots.yml", tmp_path, DORSAL_LOOKS=str(looks), DORSAL_HZ="10", DORSAL_QUESTION='where "thing 1"')
    killed: set[int] = set()
    until = time.monotonic() + 120
    while len(killed) < 20 and running.poll() is None and time.monotonic() < until:
        time.sleep(chance.uniform(0.2, 1.5))
        living = [pid for pid in graph.processes_of(tmp_path, "map") if pid not in killed]
        if living:
            os.kill(living[0], signal.SIGKILL)
            killed.add(living[0])
    assert len(killed) == 20, f"only {len(killed)} map processes lived to be killed"
    graph.finished(running, tmp_path, 120)
    check(tmp_path, looks)
    assert graph.status(tmp_path, "map")["restarts"] == 20
