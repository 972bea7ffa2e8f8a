"""The head's other sources: a recording of ROS 2, and a rendered head whose eyes turn from look to look."""

import json

import graph
import source

BAG = graph.ROOT / "fixtures" / "bags" / "pair.mcap"


#: A part of the wall that the recording shows, 1.2 m away.
PANEL = """width = 96
height = 72

[[object]]
name = "panel"
polygon = [[30, 20], [66, 20], [66, 52], [30, 52]]
"""


def test_a_recording_is_looked_at(tmp_path):
    labels = tmp_path / "panel.toml"
    labels.write_text(PANEL)
    more = {"DORSAL_SOURCE": str(BAG), "DORSAL_LABELS": str(labels), "DORSAL_INTERVAL_S": "0.3"}
    running = graph.start("one-machine.yml", tmp_path, **more)
    graph.finished(running, tmp_path, 60)
    recorded = list(source.of_recording(BAG, ["/left/image_raw", "/right/image_raw"]))
    seen = graph.status(tmp_path, "eyes")
    assert graph.status(tmp_path, "head")["pairs"] == len(recorded) > 0
    assert seen["pairs"] + seen["pairs_lost"] == len(recorded) and seen["acknowledged"] == seen["pairs"] > 0
    reports = graph.in_order(graph.logged(tmp_path)["reports"])
    # The looks bear the recording's time, not that of the graph.
    times = [report["line"]["look"]["time_ms"] for report in reports]
    assert set(times) <= {pair.time_ms for pair in recorded} and times == sorted(times)
    panels = [seen for report in reports for seen in report["line"]["look"]["seen"]]
    assert len(panels) == len(reports) and all(abs(one["distance_m"] - 1.2) < 0.06 for one in panels), panels
    assert json.loads(graph.map_of(tmp_path)) == json.loads(graph.single_process(reports))


def test_nothing_to_be_seen_is_counted(tmp_path):
    """Without labels the eyes look for what stands on the ground, and the recorded wall shows none."""
    running = graph.start("one-machine.yml", tmp_path, DORSAL_SOURCE=str(BAG), DORSAL_INTERVAL_S="0.1")
    graph.finished(running, tmp_path, 60)
    seen = graph.status(tmp_path, "eyes")
    assert seen["pairs_unseen"] == seen["pairs"] > 0 == seen["reports"]


def test_a_rendered_head_places_what_is_in_the_room(tmp_path):
    looks = 6
    more = {"DORSAL_SOURCE": "room:table", "DORSAL_SIZE": "512x384", "DORSAL_PAIRS": str(looks), "DORSAL_INTERVAL_S": "1"}
    running = graph.start("one-machine.yml", tmp_path, **more)
    graph.finished(running, tmp_path, 90)
    seen = graph.status(tmp_path, "eyes")
    assert seen["pairs"] + seen["pairs_lost"] == looks and seen["acknowledged"] == seen["pairs"] > 0
    rigs = [pair.rig for _, pair in zip(range(2), source.of_room("table", 0.0, (64, 48)))]
    assert rigs[0] != rigs[1]
    reports = graph.in_order(graph.logged(tmp_path)["reports"])
    left = json.loads(graph.map_of(tmp_path))
    assert left == json.loads(graph.single_process(reports))
    [robot] = left["robots"].values()
    names = next(source.of_room("table", 0.0, (64, 48))).names.values()
    found = robot["memory"]["objects"]
    assert len(found) >= 3 and set(found) <= set(names)
