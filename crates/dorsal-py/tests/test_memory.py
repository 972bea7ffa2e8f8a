"""The memory: what is taken in, asked, explained, refused and kept."""

import math
import threading

import numpy as np
import pytest

import dorsal
from dorsal import Sighting


def seen(name: str, distance_m: float, bearing_deg: float) -> Sighting:
    return Sighting(name, distance_m, math.radians(bearing_deg), 0.01, 0.005)


@pytest.fixture
def memory() -> dorsal.SceneMemory:
    memory = dorsal.SceneMemory()
    changes = memory.observe([seen("cd_box", 0.80, 95), seen("pc_screen", 0.92, 65)], time_ms=0)
    assert {change["change"] for change in changes} == {"appeared"}
    return memory


def test_questions_and_explanations(memory):
    answer = memory.ask("relation pc_screen from cd_box seen from robot")
    assert str(answer) == "pc_screen at cd_box: {vc}, {fr, r, br}; read vc r"
    assert answer.data["answer"] == "relation"
    memory.tell("lamp within vc of pc_screen")
    assert str(memory.ask("within vc,c,n of cd_box")) == "certainly lamp, pc_screen; possibly none"
    why = memory.explain("lamp", "cd_box")
    assert "pc_screen" in str(why) and why.data["answer"] == "explain"
    memory.retract("lamp within vc of pc_screen")
    assert set(memory.objects) == {"cd_box", "pc_screen"}


def test_what_is_refused_changes_nothing(memory):
    memory.observe([seen("cd_box", 0.80, 95)], time_ms=9)
    before = memory.to_json()
    with pytest.raises(dorsal.Refused, match="time does not run backwards"):
        memory.observe([seen("cup", 1, 90)], time_ms=8)
    with pytest.raises(dorsal.Refused, match="seen twice"):
        memory.observe([seen("cup", 1, 90), seen("cup", 2, 90)], time_ms=10)
    with pytest.raises(dorsal.Refused, match="does not know where `cup` is"):
        memory.ask("where cup")
    with pytest.raises(ValueError, match="should stand"):
        memory.ask("where is the cup")
    with pytest.raises(ValueError, match="finite"):
        memory.observe([seen("cup", math.nan, 90)], time_ms=10)
    assert memory.to_json() == before


def test_a_snapshot_is_the_memory(memory, tmp_path):
    path = tmp_path / "map.json"
    memory.save(path)
    again = dorsal.SceneMemory.load(path)
    assert again.to_json() == memory.to_json()
    assert [file.name for file in tmp_path.iterdir()] == ["map.json"]
    with pytest.raises(ValueError):
        dorsal.SceneMemory.from_json("{}")


def test_a_look_is_remembered(small_pair):
    rig = dorsal.Rig.parallel(100.0, (31.5, 23.5), 0.1)
    labels = np.zeros((48, 64), np.uint8)
    labels[16:32, 24:40] = 1
    look = dorsal.look(*small_pair, rig=rig, labels=labels, names={1: "poster"})
    memory = dorsal.SceneMemory()
    memory.remember(look, time_ms=0, eyes_above_ground_m=0.8)
    assert str(memory.ask("last_seen poster")).startswith("in look 1")
    memory.remember(look, time_ms=40, pose=None)
    with pytest.raises(ValueError, match="placed no objects"):
        memory.remember(dorsal.look(*small_pair), time_ms=80)


def test_threads_share_a_memory():
    memory = dorsal.SceneMemory()

    def look(robot: int) -> None:
        for _ in range(50):
            memory.observe([seen(f"cup {robot}", 1.0, 90)], time_ms=0)

    robots = [threading.Thread(target=look, args=(robot,)) for robot in range(4)]
    for robot in robots:
        robot.start()
    for robot in robots:
        robot.join()
    assert {kept["sightings"] for kept in memory.objects.values()} == {50}
