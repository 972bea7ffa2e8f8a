"""The map: reports in, each written down and acknowledged; questions in, answers out; contradictions as they come.

With `DORSAL_SHARD` it is one shard of a map: it keeps a folder of its own, and tells the concourse who has seen what."""

import json
import os

import dorsal
from dora import Node

from message import send, text_of
from status import write_status


def main() -> None:
    shard = os.environ.get("DORSAL_SHARD")
    folder = os.environ["DORSAL_MAP"] + ("" if shard is None else f"-{shard}")
    every = int(os.environ.get("DORSAL_CONTRADICTIONS_EVERY", "50"))
    shared = dorsal.SharedMap(folder, through_power_cuts=os.environ.get("DORSAL_POWER_CUTS") == "1")
    node = Node()
    counts = {"restarts": node.restart_count(), "reports": 0, "again": 0, "refused": 0, "questions": 0, "bytes": 0}
    said: list = []
    if shard is not None:
        # What was seen before a restart.
        send(node, "roster", {"shard": int(shard), "seen": shared.roster()})
    for event in node:
        if event["type"] == "STOP":
            break
        if event["type"] != "INPUT":
            continue
        text = text_of(event)
        if event["id"].startswith("reports"):
            [receipt] = shared.take([text])
            send(node, "receipts", receipt)
            if shard is not None and (new := appeared(receipt)):
                send(node, "roster", {"shard": int(shard), "seen": {receipt["robot"]: new}})
            counts["reports"] += 1
            counts["bytes"] += len(text)
            counts["again"] += receipt["verdict"] == "again"
            counts["refused"] += receipt["verdict"] == "refused"
            if counts["reports"] % every == 0:
                found = shared.contradictions()
                if found != said:
                    send(node, "contradictions", found)
                    said = found
        else:
            send(node, "answers", answer(shared, json.loads(text)))
            counts["questions"] += 1
    shared.snapshot()
    write_status("map" if shard is None else f"map-{shard}", counts)


def appeared(receipt: dict) -> list[str]:
    """The objects that a robot had not seen before, or not since they were gone."""
    return [change["object"] for change in receipt.get("changes", []) if change["change"] == "appeared"]


def answer(shared: dorsal.SharedMap, question: dict) -> dict:
    """The answer to a question; one without words asks for the whole map, one with `fetch` for what is kept of these robots."""
    if "fetch" in question:
        return question | {"part": shared.part(question["fetch"])}
    if question.get("words") is None:
        return question | {"snapshot": shared.to_json()}
    try:
        found = shared.ask(question["robot"], question["words"])
    except (dorsal.Refused, ValueError) as why:
        return question | {"refused": str(why)}
    return question | {"said": str(found), "answer": found.data}


if __name__ == "__main__":
    main()
