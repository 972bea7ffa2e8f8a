"""One machine: 200 looks through all nodes, and the map that one process makes of the same looks."""

import graph

LOOKS = 200


def test_the_map_is_that_of_one_process(tmp_path):
    running = graph.start(
        "one-machine.yml", tmp_path, DORSAL_PAIRS=str(LOOKS), DORSAL_NOISE="1", DORSAL_INTERVAL_S="0.35"
    )
    graph.finished(running, tmp_path, 300)
    graph.check_looks(tmp_path, LOOKS)
