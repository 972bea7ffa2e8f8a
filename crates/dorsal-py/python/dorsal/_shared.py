"""One map of what several robots see, kept in a folder."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any

from dorsal import _native
from dorsal._records import Answer


class SharedMap:
    """One map of what several robots see, each in its own frame; see docs/dataflow.md.

    ``folder`` is made if it is not there; what the map has acknowledged is read from it again. One process at a time
    holds it. What is acknowledged outlives the end of the process, by SIGKILL too; with ``through_power_cuts`` it is
    on the disk first, which costs a flush of the disk for each :meth:`take`. ``OSError`` if the folder cannot be read
    or written or is held by another process, ``ValueError`` if what is in it is no map.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        *,
        system: str = "robot-120",
        through_power_cuts: bool = False,
    ) -> None:
        self._native = _native.SharedMap(folder, system, through_power_cuts)

    def take(self, reports: Iterable[dict[str, Any] | str]) -> list[dict[str, Any]]:
        """Takes reports in, all with one write, and gives a receipt for each.

        A report has ``robot``, ``run``, ``seq``, ``line`` and, of a robot that sends again, ``kept_from``; or is the JSON
        of it. A receipt repeats the first three and has ``lost``, how many reports of that robot never came, and
        ``verdict``: ``"taken"`` with ``changes``, ``"again"``, ``"early"`` with what is ``expected``, or ``"refused"``
        with ``why``.
        """
        texts = [one if isinstance(one, str) else json.dumps(one) for one in reports]
        return [json.loads(receipt) for receipt in self._native.take(texts)]

    def ask(self, robot: str, words: str) -> Answer:
        """Answers a question of a robot in its own frame, from what all have seen whom landmarks join to it.

        ``ValueError`` for words that are no question, :class:`dorsal.Refused` where the map does not know.
        """
        said, data = self._native.ask(robot, words)
        return Answer(said, json.loads(data))

    def contradictions(self) -> list[dict[str, Any]]:
        """What every two robots contradict each other about: ``object``, the witnesses ``one`` and ``other``, each with
        ``robot``, ``place_m`` in the frame of the first, ``time_ms`` and ``is_gone``, whether it found the object gone from
        there, and ``sigmas``, how many standard errors lie between the places."""
        return json.loads(self._native.contradictions())

    def to_json(self) -> str:
        """The whole map: a snapshot for a robot that joins late."""
        return self._native.to_json()

    def memory(self, robot: str) -> str | None:
        """The memory of one robot, as :meth:`dorsal.SceneMemory.to_json` gives it; ``None`` if it reported nothing."""
        return self._native.memory(robot)

    def part(self, robots: Iterable[str]) -> str:
        """What the map keeps of these robots, in the form of :meth:`to_json`: what a :class:`Concourse` asks a shard for."""
        return self._native.part(list(robots))

    def roster(self) -> dict[str, list[str]]:
        """Which objects each robot has seen."""
        return self._native.roster()

    def snapshot(self) -> None:
        """Writes the map as a snapshot and begins a new journal; done without being asked after 10 000 reports, or
        100 for each robot if that is more."""
        self._native.snapshot()


class Concourse:
    """Where the shards of one map meet: it knows who has seen what in which shard, and sends a question where it belongs.

    A shard is a :class:`SharedMap` of some rooms, in a process of its own. A look goes to the shard of its room; a look
    without a pose, a fact told and a fact taken back go to all. See docs/dataflow.md.
    """

    def __init__(self, shards: int) -> None:
        self._native = _native.Concourse(shards)

    def saw(self, shard: int, robot: str, objects: Iterable[str]) -> None:
        """Notes that this shard, counted from 0, has a robot's sightings of these objects."""
        self._native.saw(shard, robot, list(objects))

    def route(self, robot: str, words: str, *, across: bool = False) -> int | list[str]:
        """Who answers a question: the number of one shard, or the robots whose memories are needed of all shards.

        A shard alone may answer that it does not know; ``across=True`` says what to ask for then.
        ``ValueError`` for words that are no question, :class:`dorsal.Refused` for a robot of which no shard knows.
        """
        shard, robots = self._native.route(robot, words, across)
        return robots if shard is None else shard

    @staticmethod
    def ask(parts: Iterable[str], robot: str, words: str) -> Answer:
        """The answer that parts of a map give together, one of each shard (:meth:`SharedMap.part`).

        It is the answer of one map of all reports, if each object belongs to one shard.
        ``ValueError`` and :class:`dorsal.Refused` as for :meth:`SharedMap.ask`.
        """
        said, data = _native.ask_together(list(parts), robot, words)
        return Answer(said, json.loads(data))

    @staticmethod
    def contradictions(parts: Iterable[str]) -> list[dict[str, Any]]:
        """What robots contradict each other about in a map of these parts, as :meth:`SharedMap.contradictions`."""
        return json.loads(_native.contradictions_together(list(parts)))
