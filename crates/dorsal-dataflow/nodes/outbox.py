"""The reports of a robot that the map has not acknowledged yet."""

import time
from typing import Any


class Outbox:
    """Numbers reports and keeps each until its receipt; what waits too long is due again.

    At most ``most_waiting`` are kept. Beyond that a new report is not numbered and not sent but counted in
    ``refused``: a robot that the map has left alone neither fills its memory nor loses what it promised to send.
    """

    def __init__(self, robot: str, *, again_after_s: float = 0.5, most_waiting: int = 4096) -> None:
        self.robot = robot
        self.run = time.time_ns()
        self.again_after_s = again_after_s
        self.most_waiting = most_waiting
        self.seq = 0
        self.acknowledged = 0
        self.refused = 0
        self.sent_again = 0
        self._waiting: dict[int, tuple[float, dict[str, Any]]] = {}

    def add(self, line: dict[str, Any]) -> dict[str, Any] | None:
        """The report of a line, to be sent now; ``None`` if too many wait."""
        if len(self._waiting) >= self.most_waiting:
            self.refused += 1
            return None
        self.seq += 1
        oldest = next(iter(self._waiting), self.seq)
        report = {"robot": self.robot, "run": self.run, "seq": self.seq, "kept_from": oldest, "line": line}
        self._waiting[self.seq] = (time.monotonic(), report)
        return report

    def take(self, receipt: dict[str, Any]) -> None:
        """Takes a receipt; those of others are passed over, and an early report still waits."""
        if receipt["verdict"] == "early":
            return
        ours = receipt["robot"] == self.robot and receipt["run"] == self.run
        if ours and self._waiting.pop(receipt["seq"], None) is not None:
            self.acknowledged += 1

    def due(self) -> list[dict[str, Any]]:
        """The reports to be sent again, all that wait and in their order, once the oldest has waited too long.

        All, because the map takes the reports of a robot in their order only: one that comes before its turn is early.
        """
        now = time.monotonic()
        if not self._waiting or now - next(iter(self._waiting.values()))[0] < self.again_after_s:
            return []
        oldest = next(iter(self._waiting))
        reports = [report | {"kept_from": oldest} for _, report in self._waiting.values()]
        self._waiting = {report["seq"]: (now, report) for report in reports}
        self.sent_again += len(reports)
        return reports

    @property
    def empty(self) -> bool:
        return not self._waiting

    def counts(self) -> dict[str, int]:
        return {
            "reports": self.seq,
            "acknowledged": self.acknowledged,
            "sent_again": self.sent_again,
            "refused_full": self.refused,
        }
