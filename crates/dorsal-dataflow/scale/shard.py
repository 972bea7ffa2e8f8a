"""A map process under replay: it takes reports when they are due, and answers questions that come through a pipe."""

import resource
import tempfile
import time
from multiprocessing.connection import Connection
from typing import Any

import dorsal
from replay import HZ, REPORTS_A_QUESTION, THINGS, Replay

#: Once a report is so late, the rest of its round is given up: the process is overloaded.
MOST_LATE_S = 5.0
#: While reports are due without a pause, the pipe is looked at after every so many.
REPORTS_A_GLANCE = 8


def resident_mb() -> float:
    """The largest resident size so far, in megabytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def serve(pipe: Connection, replay: Replay, shard: int | None, seconds: float) -> None:
    """Replays what belongs to this shard, or all, and then sends what it measured.

    Says when it is ready, waits for the time of the clock (`time.monotonic`) at which to begin, and until the end answers what
    comes through the pipe. Roster messages go out as they arise.
    """
    reports = replay.reports(int(seconds * HZ), shard)
    before_mb = resident_mb()
    with tempfile.TemporaryDirectory() as folder:
        shared = dorsal.SharedMap(folder)
        pipe.send("ready")
        began = pipe.recv()
        measured = taken(pipe, shared, reports, replay, shard, began)
    measured["mb"] = resident_mb() - before_mb
    pipe.send(measured)
    while (document := pipe.recv()) is not None:
        del document


def taken(
    pipe: Connection, shared: dorsal.SharedMap, reports: list, replay: Replay, shard: int | None, began: float
) -> dict[str, Any]:
    """What came of the reports: how many, how late their receipts and the answers, and what it cost."""
    receipts_ms: list[float] = []
    answers_ms: list[float] = []
    step_s = 1 / HZ / replay.robots
    cpu = time.process_time()
    done = nothing = bytes_taken = 0
    for turn, those in enumerate(reports):
        for k, room, text in those:
            due = began + (turn * replay.robots + k) * step_s
            while (wait := due - time.monotonic()) > 0:
                if pipe.poll(wait):
                    reply(pipe, shared)
            if -wait > MOST_LATE_S:
                break
            [receipt] = shared.take([text])
            receipts_ms.append(1e3 * (time.monotonic() - due))
            done += 1
            bytes_taken += len(text)
            if shard is not None:
                new = [change["object"] for change in receipt["changes"] if change["change"] == "appeared"]
                if new:
                    pipe.send({"shard": shard, "seen": {receipt["robot"]: new}})
                if done % REPORTS_A_GLANCE == 0 and pipe.poll(0):
                    reply(pipe, shared)
            if done % REPORTS_A_QUESTION == 0:
                try:
                    shared.ask(f"robot {k}", f'where "room {room} thing {turn % THINGS}"')
                except dorsal.Refused:
                    # Nobody has seen it yet; the first looks show five of eight.
                    nothing += 1
                else:
                    answers_ms.append(1e3 * (time.monotonic() - due))
    return {
        "taken": done,
        "bytes": bytes_taken,
        "seconds": time.monotonic() - began,
        "cpu_s": time.process_time() - cpu,
        "receipts_ms": receipts_ms,
        "answers_ms": answers_ms,
        "unknown": nothing,
    }


def reply(pipe: Connection, shared: dorsal.SharedMap) -> None:
    """Answers one question of the concourse."""
    document = pipe.recv()
    if "fetch" in document:
        pipe.send(document | {"part": shared.part(document["fetch"])})
        return
    try:
        found = shared.ask(document["robot"], document["words"])
    except dorsal.Refused as why:
        pipe.send(document | {"refused": str(why)})
    else:
        pipe.send(document | {"said": str(found), "answer": found.data})
