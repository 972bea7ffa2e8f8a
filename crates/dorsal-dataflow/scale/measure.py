"""Map processes under load: one alone, or shards with a concourse that asks across them."""

import multiprocessing
import random
import time
from multiprocessing.connection import Connection, wait
from typing import Any

from concourse import Desk
from replay import THINGS, Replay
from shard import serve

#: Questions across shards, a second.
ACROSS_HZ = 20
#: Before it begins, what all processes need to be waiting at their clocks.
LEAD_S = 0.2


def started(replay: Replay, seconds: float) -> tuple[list[multiprocessing.Process], list[Connection]]:
    """The map processes of a replay, ready to begin."""
    context = multiprocessing.get_context("spawn")
    processes, pipes = [], []
    for shard in [None] if replay.shards == 1 else range(replay.shards):
        here, there = context.Pipe()
        process = context.Process(target=serve, args=(there, replay, shard, seconds))
        process.start()
        processes.append(process)
        pipes.append(here)
    for pipe in pipes:
        assert pipe.recv() == "ready"
    return processes, pipes


def one(robots: int, seconds: float) -> dict[str, Any]:
    """What one map process makes of so many robots."""
    processes, [pipe] = started(Replay(robots), seconds)
    pipe.send(time.monotonic() + LEAD_S)
    measured = pipe.recv()
    ended(processes, [pipe])
    return measured


def shards(robots: int, seconds: float) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """What two shards make of them, each; and what the concourse measured of questions across."""
    replay = Replay(robots, 2)
    processes, pipes = started(replay, seconds)
    began = time.monotonic() + LEAD_S
    for pipe in pipes:
        pipe.send(began)
    since: dict[int, float] = {}
    took_ms: list[float] = []
    refused = number = 0

    def answered(document: dict[str, Any]) -> None:
        nonlocal refused
        if "refused" in document:
            refused += 1
        else:
            took_ms.append(1e3 * (time.monotonic() - since[document["id"]]))

    desk = Desk(2, lambda shard, document: pipes[shard].send(document), answered)
    chance = random.Random(robots)
    measured: dict[int, dict[str, Any]] = {}
    cpu = time.process_time()
    # Until the first robots have been in both of their rooms, nothing joins the shards: two stays.
    next_at = began + 2.5
    while len(measured) < 2:
        for pipe in wait(pipes, max(0.0, min(0.05, next_at - time.monotonic()))):
            document = pipe.recv()
            shard = pipes.index(pipe)
            if "seen" in document:
                desk.roster(document)
            elif "taken" in document:
                measured[shard] = document
            else:
                desk.take(shard, document)
        if time.monotonic() >= next_at and not measured and time.monotonic() < began + seconds:
            next_at += 1 / ACROSS_HZ
            k = chance.randrange(robots)
            here = replay.home(k)
            there = (here + replay.rooms // 2) % replay.rooms
            words = f'relation "room {there} thing {chance.randrange(THINGS)}" from "room {here} thing {chance.randrange(THINGS)}"'
            number += 1
            since[number] = time.monotonic()
            desk.ask({"id": number, "robot": f"robot {k}", "words": words})
    across = {
        "asked": number,
        "refused": refused,
        "took_ms": took_ms,
        "cpu": (time.process_time() - cpu) / (time.monotonic() - began),
    }
    ended(processes, pipes)
    return [measured[shard] for shard in range(2)], across


def ended(processes: list[multiprocessing.Process], pipes: list[Connection]) -> None:
    for pipe in pipes:
        pipe.send(None)
    for process in processes:
        process.join(30)
