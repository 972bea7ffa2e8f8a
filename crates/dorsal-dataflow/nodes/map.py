"""The map: reports in, each written down and acknowledged; questions in, answers out; contradictions as they come."""

import json
import os

import dorsal
from dora import Node

from message import send, text_of
from status import write_status


def main() -> None:
    folder = os.environ["DORSAL_MAP"]
    every = int(os.environ.get("DORSAL_CONTRADICTIONS_EVERY", "50"))
    shared = dorsal.SharedMap(folder, through_power_cuts=os.environ.get("DORSAL_POWER_CUTS") == "1")
    node = Node()
    counts = {"restarts": node.restart_count(), "reports": 0, "again": 0, "refused": 0, "questions": 0, "bytes": 0}
    said: list = []
    for event in node:
        if event["type"] == "STOP":
            break
        if event["type"] != "INPUT":
            continue
        text = text_of(event)
        if event["id"].startswith("reports"):
            [receipt] = shared.take([text])
            send(node, "receipts", receipt)
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
    write_status("map", counts)


def answer(shared: dorsal.SharedMap, question: dict) -> dict:
    """The answer to a question; one without words asks for the whole map."""
    if question.get("words") is None:
        return question | {"snapshot": shared.to_json()}
    try:
        found = shared.ask(question["robot"], question["words"])
    except (dorsal.Refused, ValueError) as why:
        return question | {"refused": str(why)}
    return question | {"said": str(found), "answer": found.data}


if __name__ == "__main__":
    main()
