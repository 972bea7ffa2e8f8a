"""One machine: 200 looks through all nodes, and the map that one process makes of the same looks."""

import json

import dorsal
import numpy as np

import eyes
import graph
import head

LOOKS = 200


def test_the_map_is_that_of_one_process(tmp_path):
    running = graph.start("one-machine.yml", tmp_path, DORSAL_PAIRS=str(LOOKS), DORSAL_NOISE="1", DORSAL_INTERVAL_S="0.35")
    graph.finished(running, tmp_path, 300)
    graph.check_looks(tmp_path, LOOKS)


def test_the_eyes_report_what_one_process_sees():
    """The line of a look is made from the pair alone: the same bits here as in the graph."""
    rig = dorsal.Rig.read(graph.PAIR / "rig.toml")
    labels, names = dorsal.read_labels(graph.PAIR / "labels.toml")
    pair = [dorsal.read_picture(graph.PAIR / f"{eye}.png") for eye in ("left", "right")]
    noisy = [head.noisy(eye, 1, 2 + side) for side, eye in enumerate(pair)]
    assert not np.array_equal(noisy[0], pair[0])
    lines = [
        eyes.look_line(dorsal.look(*noisy, rig=rig, labels=labels, names=names), 5) for _ in range(2)
    ]
    assert json.dumps(lines[0]) == json.dumps(lines[1])
    assert len(lines[0]["look"]["seen"]) > 5
