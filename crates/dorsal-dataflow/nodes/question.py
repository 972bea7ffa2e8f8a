"""The questions: one after every so many reports, with the time from the sighting to the answer."""

import json
import os
import time

from dora import Node

from message import send, text_of
from status import write_status


def main() -> None:
    words = os.environ.get("DORSAL_QUESTION", "within f,vf of robot")
    every = int(os.environ.get("DORSAL_QUESTION_EVERY", "10"))
    node = Node()
    reports, number = 0, 0
    asked: dict[int, float] = {}
    took: list[float] = []
    refused = 0
    last: dict = {}
    closed_at = None
    # After the last report, the answers that are under way are waited for, and no longer than five seconds.
    while closed_at is None or (asked and time.monotonic() - closed_at < 5.0):
        event = node.next(timeout=1.0)
        if event is None or event["type"] == "STOP":
            break
        if event["type"] == "INPUT_CLOSED" and event["id"].startswith("reports"):
            closed_at = time.monotonic()
        if event["type"] != "INPUT":
            continue
        document = json.loads(text_of(event))
        if event["id"] == "answers":
            if document["id"] in asked:
                took.append(time.monotonic() - asked.pop(document["id"]))
                refused += "refused" in document
                last = document
            continue
        reports += 1
        if reports % every == 0:
            number += 1
            asked[number] = time.monotonic()
            send(node, "questions", {"id": number, "robot": document["robot"], "words": words})
    took.sort()
    counts = {
        "reports": reports,
        "asked": number,
        "answered": len(took),
        "refused": refused,
        "last": {key: last[key] for key in ("said", "refused") if key in last},
    }
    if took:
        counts["p50_ms"] = round(1e3 * took[len(took) // 2], 3)
        counts["p99_ms"] = round(1e3 * took[min(len(took) - 1, 99 * len(took) // 100)], 3)
    write_status("question", counts)


if __name__ == "__main__":
    main()
