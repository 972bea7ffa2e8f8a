"""What a node counted, for who ran the graph."""

import json
import os
import pathlib
import resource
from typing import Any


def write_status(name: str, counts: dict[str, Any]) -> None:
    """Writes the counts, the processor seconds and the largest resident size to ``$DORSAL_OUT/NAME.json``, whole."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    counts = counts | {
        "cpu_s": round(usage.ru_utime + usage.ru_stime, 3),
        "max_rss_kb": usage.ru_maxrss,
    }
    folder = pathlib.Path(os.environ["DORSAL_OUT"])
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f"{name}.json.part"
    part.write_text(json.dumps(counts) + "\n")
    part.replace(folder / f"{name}.json")
