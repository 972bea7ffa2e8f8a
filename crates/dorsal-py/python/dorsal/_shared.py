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
        ``robot``, ``place_m`` in the frame of the first and ``time_ms``, and ``sigmas``, how far apart that is."""
        return json.loads(self._native.contradictions())

    def to_json(self) -> str:
        """The whole map: a snapshot for a robot that joins late."""
        return self._native.to_json()

    def memory(self, robot: str) -> str | None:
        """The memory of one robot, as :meth:`dorsal.SceneMemory.to_json` gives it; ``None`` if it reported nothing."""
        return self._native.memory(robot)

    def snapshot(self) -> None:
        """Writes the map as a snapshot and begins a new journal; done every 10 000 reports without being asked."""
        self._native.snapshot()
