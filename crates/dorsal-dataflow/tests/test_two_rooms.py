"""Two rooms, two shards: relations across them are those of one map, and a shard may die."""

import json
import os
import signal
import time

import dorsal
import graph
import robot

FRAMES = {"a": (0.0, 0.0, 0.0), "b": (2.5, 1.0, 1.1), "c": (-2.0, 3.0, -1.9)}
ROOMS = {"a": [0], "b": [0, 1], "c": [1]}
ACROSS = 'relation "far thing 1" from "thing 2"'
LOOKS = 200


def one_map(tmp_path) -> dorsal.SharedMap:
    """One map of the same looks, none of which went through a graph."""
    whole = dorsal.SharedMap(tmp_path / "whole")
    for name, frame in FRAMES.items():
        lines = robot.lines(name, LOOKS, frame, ROOMS[name])
        whole.take({"robot": name, "run": 1, "seq": seq, "line": line} for seq, line in enumerate(lines, 1))
    return whole


def uncounted(data):
    """An answer without the numbers of looks, which each memory counts for itself."""
    if isinstance(data, dict):
        return {key: uncounted(value) for key, value in data.items() if key != "looks"}
    return [uncounted(value) for value in data] if isinstance(data, list) else data


def test_relations_across_shards_are_those_of_one_map(tmp_path):
    running = graph.start("two-rooms.yml", tmp_path, DORSAL_LOOKS=str(LOOKS), DORSAL_HZ="20", DORSAL_QUESTION=ACROSS)
    # A shard that is killed goes on from its folder, and tells the concourse anew what was seen.
    time.sleep(4.0)
    [shard] = [pid for pid in graph.processes_of(tmp_path, "map") if b"DORSAL_SHARD=1" in graph.variables(pid)]
    os.kill(shard, signal.SIGKILL)
    graph.finished(running, tmp_path, 90)
    for name, rooms in ROOMS.items():
        counted = graph.status(tmp_path, f"robot-{name}")
        assert counted["acknowledged"] == counted["reports"] == LOOKS
    asked = graph.status(tmp_path, "question")
    assert asked["answered"] == asked["asked"] > 0
    # Before b has seen both rooms nobody can know; from then on everybody does.
    assert asked["refused"] < asked["asked"] and "far thing 1" in asked["last"]["said"]
    assert graph.status(tmp_path, "concourse")["across"] > 0
    assert graph.status(tmp_path, "map-1")["restarts"] == 1
    shards = [dorsal.SharedMap(tmp_path / f"map-{shard}") for shard in range(2)]
    assert [sorted(json.loads(shard.to_json())["robots"]) for shard in shards] == [["a", "b"], ["b", "c"]]
    whole, concourse = one_map(tmp_path), dorsal.Concourse(2)
    for number, shard in enumerate(shards):
        for name, objects in shard.roster().items():
            concourse.saw(number, name, objects)
    for name in FRAMES:
        for words in (ACROSS, 'where "far thing 3"', 'where "thing 4"', "within f,vf of robot"):
            parts = [shard.part(concourse.route(name, words, across=True)) for shard in shards]
            together = concourse.ask(parts, name, words).data
            assert uncounted(together) == uncounted(whole.ask(name, words).data), (name, words)
    assert concourse.route("a", 'where "thing 1"') == 0 and isinstance(concourse.route("a", ACROSS), list)
