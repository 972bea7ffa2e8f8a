"""A message of the graphs: one JSON document as bytes, and where it stands in what its sender has sent."""

import json
from typing import Any

import pyarrow as pa


def send(node: Any, output: str, document: Any, **metadata: Any) -> None:
    """Sends a document; text is sent as it is."""
    text = document if isinstance(document, str) else json.dumps(document)
    node.send_output(output, pa.array(memoryview(text.encode()), type=pa.uint8()), metadata)


def text_of(event: Any) -> str:
    """The text of a received document."""
    return event["value"].to_numpy(zero_copy_only=True).tobytes().decode()
