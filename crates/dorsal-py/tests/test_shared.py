"""One map of several robots: what Python hands on, and what outlives the object."""

import math

import pytest

import dorsal


def report(robot: str, seq: int, things: dict[str, tuple[float, float]]) -> dict:
    seen = [
        {
            "object": name,
            "distance_m": math.hypot(right, forward),
            "bearing_rad": math.atan2(forward, right),
            "sigma_distance_m": 0.01,
            "sigma_bearing_rad": 0.005,
        }
        for name, (right, forward) in things.items()
    ]
    pose = {"x_m": 0, "z_m": 0, "heading_rad": 0}
    look = {"time_ms": seq, "pose": pose, "seen": seen, "view": None}
    return {"robot": robot, "run": 1, "seq": seq, "line": {"look": look}}


#: The second robot stands a metre to the right of the first.
ONE = {"box": (0.0, 2.0), "cup": (1.0, 2.5), "lamp": (-1.0, 1.5), "door": (0.5, 3.5)}
OTHER = {name: (right - 1.0, forward) for name, (right, forward) in ONE.items()} | {"plant": (0.5, 1.0)}


def test_a_map_outlives_its_object_and_is_held_by_one(tmp_path):
    shared = dorsal.SharedMap(tmp_path)
    receipts = shared.take([report("one", 1, ONE), report("other", 2, OTHER)])
    assert [(r["verdict"], r["lost"]) for r in receipts] == [("taken", 0), ("taken", 1)]
    assert shared.take([report("one", 1, ONE)])[0]["verdict"] == "again"
    where = shared.ask("one", "where plant").data
    assert math.hypot(where["right_m"] - 1.5, where["forward_m"] - 1.0) < 1e-3
    with pytest.raises(OSError, match="held by another"):
        dorsal.SharedMap(tmp_path)
    text, memory = shared.to_json(), shared.memory("one")
    assert "plant" not in dorsal.SceneMemory.from_json(memory).objects
    del shared
    again = dorsal.SharedMap(tmp_path, through_power_cuts=True)
    assert again.to_json() == text
    again.snapshot()
    assert again.to_json() == text and again.memory("nobody") is None


def test_what_is_refused_says_why(tmp_path):
    shared = dorsal.SharedMap(tmp_path)
    shared.take([report("one", 1, ONE), report("other", 1, OTHER | {"cup": (0.8, 2.5)})])
    [found] = shared.contradictions()
    assert (found["object"], found["one"]["robot"], found["other"]["robot"]) == ("cup", "one", "other")
    with pytest.raises(dorsal.Refused, match="sofa"):
        shared.ask("one", "where sofa")
    with pytest.raises(dorsal.Refused, match="nobody"):
        shared.ask("nobody", "where cup")
    with pytest.raises(ValueError):
        shared.ask("one", "what now")
    with pytest.raises(ValueError):
        shared.take(["no report"])


def test_shards_answer_together_what_none_knows(tmp_path):
    rooms = [dorsal.SharedMap(tmp_path / str(room)) for room in range(2)]
    far = {"sofa": (2.0, 6.0), "shelf": (-1.0, 7.0), "plant": (1.0, 5.0)}
    # The first robot stays here, the second was in both rooms and numbers what it sends to each.
    sent = [(0, report("one", 1, ONE)), (0, report("other", 1, ONE)), (1, report("other", 1, far) | {"seq": 1})]
    concourse = dorsal.Concourse(2)
    for shard, one in sent:
        [receipt] = rooms[shard].take([one])
        appeared = [change["object"] for change in receipt["changes"] if change["change"] == "appeared"]
        concourse.saw(shard, one["robot"], appeared)
    assert concourse.route("one", "where cup") == 0
    words = "relation sofa from cup"
    with pytest.raises(dorsal.Refused):
        rooms[0].ask("one", words)
    needed = concourse.route("one", words)
    assert needed == ["one", "other"]
    parts = [room.part(needed) for room in rooms]
    assert "sofa" in str(concourse.ask(parts, "one", words))
    where = concourse.ask(parts, "one", "where sofa").data
    assert math.hypot(where["right_m"] - 2.0, where["forward_m"] - 6.0) < 1e-3
    assert rooms[1].roster() == {"other": ["plant", "shelf", "sofa"]}
    # It was moved into this room since: the shards do not know of each other, together they say so.
    rooms[0].take([report("one", 2, ONE | {"plant": (0.3, 3.0)})])
    assert rooms[0].contradictions() == []
    [found] = concourse.contradictions([room.part(needed) for room in rooms])
    assert found["object"] == "plant" and not found["one"]["is_gone"]
    with pytest.raises(dorsal.Refused, match="nobody"):
        concourse.route("nobody", words)
    for wrong in (
        lambda: concourse.route("one", "what now"),
        lambda: concourse.saw(2, "one", ["cup"]),
        lambda: concourse.ask([], "one", words),
        lambda: concourse.ask(["no map"], "one", words),
        lambda: concourse.ask([parts[0], dorsal.SharedMap(tmp_path / "x", system="drs1").to_json()], "one", words),
    ):
        with pytest.raises(ValueError):
            wrong()
