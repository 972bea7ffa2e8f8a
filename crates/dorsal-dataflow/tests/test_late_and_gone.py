"""A robot that vanishes leaves its sightings; one that joins late gets a snapshot of them."""

import json

import dorsal
import graph
import robot

FRAMES = {"a": (0.0, 0.0, 0.0), "b": (2.5, 1.0, 1.1), "d": (-2.0, 3.0, -1.9)}
LOOKS, VANISHED_AFTER = 100, 30


def test_what_a_robot_saw_outlives_it_and_is_given_to_who_comes(tmp_path):
    running = graph.start("late-and-gone.yml", tmp_path, DORSAL_LOOKS=str(LOOKS), DORSAL_HZ="20")
    try:
        running.wait(90)
    finally:
        if running.poll() is None:
            running.kill()
    assert not (tmp_path / "robot-b.json").exists(), "b was to vanish without a word"
    left = json.loads(graph.map_of(tmp_path))
    assert sorted(left["robots"]) == sorted(FRAMES)
    # What b sent last may have died with it; what came is without a gap, though b never heard of it again.
    came = left["robots"]["b"]["seq"]
    assert VANISHED_AFTER - 1 <= came <= VANISHED_AFTER and left["robots"]["b"]["lost"] == 0
    # d got them when it joined, before it had seen anything.
    joined = graph.status(tmp_path, "robot-d")["snapshot"]
    assert joined["b"] == came and 0 < joined["a"] <= LOOKS and "d" not in joined
    for name in ("a", "d"):
        counted = graph.status(tmp_path, f"robot-{name}")
        assert counted["acknowledged"] == counted["reports"] == left["robots"][name]["seq"] == LOOKS
    # The map is that of one process, and all that b saw is placed for d.
    reports = [
        {"robot": name, "run": kept["run"], "seq": seq, "line": line}
        for name, kept in left["robots"].items()
        for seq, line in enumerate(robot.lines(name, kept["seq"], FRAMES[name]), 1)
    ]
    assert left == json.loads(graph.single_process(reports))
    shared = dorsal.SharedMap(tmp_path / "map")
    for thing in left["robots"]["b"]["memory"]["objects"]:
        shared.ask("d", f'where "{thing}"')
