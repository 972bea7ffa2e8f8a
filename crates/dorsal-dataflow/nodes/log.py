"""The log: every message of the map's graph in an MCAP file, one JSON channel for each input.

`log.json` counts the messages of each input, and the reports whose number was passed over: what the log itself missed.
"""

import json
import os
import pathlib
import time

from dora import Node
from mcap.writer import Writer

from message import text_of
from status import write_status


class Reports:
    """The numbers of the reports that came, by robot and run; what is sent again counts once."""

    def __init__(self) -> None:
        self.came: dict[tuple[str, int], set[int]] = {}

    def take(self, document: dict) -> None:
        """Notes a report."""
        self.came.setdefault((document["robot"], document["run"]), set()).add(document["seq"])

    @property
    def missed(self) -> int:
        return sum(max(numbers) - len(numbers) for numbers in self.came.values())


def main() -> None:
    path = pathlib.Path(os.environ["DORSAL_LOG"])
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    counts: dict[str, int] = {}
    reports: dict[str, Reports] = {}
    with open(part, "wb") as file:
        writer = Writer(file)
        writer.start(library="dorsal-dataflow")
        schema = writer.register_schema(name="dorsal.document", encoding="jsonschema", data=b'{"type": "object"}')
        channels: dict[str, int] = {}
        node = Node()
        for event in node:
            if event["type"] == "STOP":
                break
            if event["type"] != "INPUT":
                continue
            name = event["id"]
            if name not in channels:
                channels[name] = writer.register_channel(f"/{name}", "json", schema)
            text = text_of(event)
            if name.startswith("reports"):
                reports.setdefault(name, Reports()).take(json.loads(text))
            now = time.time_ns()
            writer.add_message(channels[name], log_time=now, publish_time=now, data=text.encode(), sequence=counts.get(name, 0))
            counts[name] = counts.get(name, 0) + 1
        writer.finish()
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)
    write_status("log", {"messages": counts, "missed": {name: those.missed for name, those in reports.items()}})


if __name__ == "__main__":
    main()
