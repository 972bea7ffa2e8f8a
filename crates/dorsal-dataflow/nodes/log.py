"""The log: every message of the map's graph in an MCAP file, one JSON channel for each input."""

import os
import pathlib
import time

from dora import Node
from mcap.writer import Writer

from message import text_of
from status import write_status


def main() -> None:
    path = pathlib.Path(os.environ["DORSAL_LOG"])
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    counts: dict[str, int] = {}
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
            now = time.time_ns()
            writer.add_message(channels[name], log_time=now, publish_time=now, data=text.encode(), sequence=counts.get(name, 0))
            counts[name] = counts.get(name, 0) + 1
        writer.finish()
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)
    write_status("log", {"messages": counts})


if __name__ == "__main__":
    main()
