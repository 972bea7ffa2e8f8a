"""The concourse: where the shards of a map meet. Questions in; each goes to the shard that knows, or to all, and one answer comes out."""

import json
import os
import time
from typing import Any

import dorsal
from dora import Node

from message import send, text_of
from status import write_status

#: A shard that has not answered for so long may have lost the question when it was restarted.
PATIENCE_S = 5.0


class Asked:
    """A question under way."""

    def __init__(self, question: dict[str, Any], is_alone: bool) -> None:
        self.question = question
        self.is_alone = is_alone
        self.since = time.monotonic()
        self.parts: dict[int, str] = {}


class Desk:
    """Sends questions to shards, and makes one answer of what these say.

    ``to_shard(shard, document)`` and ``reply(document)`` send; the numbers of questions among the shards are its own.
    """

    def __init__(self, shards: int, to_shard: Any, reply: Any) -> None:
        self.concourse = dorsal.Concourse(shards)
        self.shards = shards
        self.to_shard = to_shard
        self.reply = reply
        self.asked: dict[int, Asked] = {}
        self.number = 0
        self.counts = {"alone": 0, "across": 0, "late": 0}

    def roster(self, document: dict[str, Any]) -> None:
        """Takes in who has seen what in a shard."""
        for robot, objects in document["seen"].items():
            self.concourse.saw(document["shard"], robot, objects)

    def ask(self, question: dict[str, Any], *, across: bool = False) -> None:
        """Sends a question where it belongs."""
        try:
            route = self.concourse.route(question["robot"], question["words"], across=across)
        except ValueError as why:
            self.reply(question | {"refused": str(why)})
            return
        self.number += 1
        is_alone = isinstance(route, int)
        self.asked[self.number] = Asked(question, is_alone)
        self.counts["alone" if is_alone else "across"] += 1
        if isinstance(route, int):
            self.to_shard(route, question | {"id": self.number})
        else:
            for shard in range(self.shards):
                self.to_shard(shard, {"id": self.number, "fetch": route})

    def take(self, shard: int, document: dict[str, Any]) -> None:
        """Takes what a shard has answered."""
        asked = self.asked.get(document["id"])
        if asked is None:
            return
        question = asked.question
        if asked.is_alone:
            del self.asked[document["id"]]
            if "refused" in document:
                # What this shard does not know may be joined by robots of another.
                self.ask(question, across=True)
            else:
                self.reply(document | {"id": question["id"]})
            return
        asked.parts[shard] = document["part"]
        if len(asked.parts) < self.shards:
            return
        del self.asked[document["id"]]
        try:
            found = dorsal.Concourse.ask(asked.parts.values(), question["robot"], question["words"])
        except ValueError as why:
            self.reply(question | {"refused": str(why)})
        else:
            self.reply(question | {"said": str(found), "answer": found.data})

    def give_up(self) -> None:
        """Answers what no shard has answered for long."""
        now = time.monotonic()
        for number, asked in list(self.asked.items()):
            if now - asked.since > PATIENCE_S:
                del self.asked[number]
                self.counts["late"] += 1
                why = f"a shard has not answered within {PATIENCE_S:.0f} s; ask again"
                self.reply(asked.question | {"refused": why})


def main() -> None:
    shards = int(os.environ.get("DORSAL_SHARDS", "2"))
    node = Node()
    desk = Desk(
        shards,
        lambda shard, document: send(node, f"to_{shard}", document),
        lambda document: send(node, "answers", document),
    )
    open_inputs = {"questions"}
    while open_inputs or desk.asked:
        event = node.next(timeout=1.0)
        desk.give_up()
        if event is None or event["type"] == "STOP":
            break
        if event["type"] == "INPUT_CLOSED":
            open_inputs.discard(event["id"])
        if event["type"] != "INPUT":
            continue
        document = json.loads(text_of(event))
        if event["id"] == "questions":
            desk.ask(document)
        elif event["id"].startswith("roster_"):
            desk.roster(document)
        else:
            desk.take(int(event["id"].removeprefix("answers_")), document)
    write_status("concourse", desk.counts)


if __name__ == "__main__":
    main()
