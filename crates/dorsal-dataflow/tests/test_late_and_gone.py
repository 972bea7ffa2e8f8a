"""A robot that vanishes leaves its sightings; one that joins late gets a snapshot of them."""

import json

import dorsal
import graph

LOOKS, VANISHED_AFTER = 100, 30


def test_what_a_robot_saw_outlives_it_and_is_given_to_who_comes(tmp_path):
    running = graph.start("late-and-gone.yml", tmp_path, DORSAL_LOOKS=str(LOOKS), DORSAL_HZ="20")
    try:
        running.wait(90)
    finally:
        if running.poll() is None:
            running.kill()
    log = graph.logged(tmp_path)
    sent = graph.in_order(log["reports_b"])
    assert not (tmp_path / "robot-b.json").exists(), "b was to vanish without a word"
    # What it sent last may have died with it; what came is without a gap.
    assert VANISHED_AFTER - 1 <= len(sent) <= VANISHED_AFTER
    left = json.loads(graph.map_of(tmp_path))
    assert sorted(left["robots"]) == ["a", "b", "d"]
    # What b had sent is there to the last report, though it never heard of it.
    assert left["robots"]["b"]["seq"] == len(sent) and left["robots"]["b"]["lost"] == 0
    assert left["robots"]["b"]["memory"]["objects"] == graph.memory_alone(sent)
    # d got them when it joined, before it had seen anything.
    joined = graph.status(tmp_path, "robot-d")["snapshot"]
    assert joined["b"] == len(sent) and 0 < joined["a"] <= LOOKS and "d" not in joined
    for name in ("a", "d"):
        counted = graph.status(tmp_path, f"robot-{name}")
        assert counted["acknowledged"] == counted["reports"] == left["robots"][name]["seq"] == LOOKS
    # The map is that of one process, and all that b saw is placed for d.
    reports = graph.in_order(log["reports_a"] + log["reports_b"] + log["reports_d"])
    assert left == json.loads(graph.single_process(reports))
    shared = dorsal.SharedMap(tmp_path / "map")
    for thing in left["robots"]["b"]["memory"]["objects"]:
        shared.ask("d", f'where "{thing}"')
