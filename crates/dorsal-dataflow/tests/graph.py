"""Runs a graph on real daemons and reads what came of it."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile

import dorsal
import eyes
import source
from mcap.reader import make_reader

ROOT = pathlib.Path(__file__).resolve().parents[3]
FLOW = ROOT / "crates" / "dorsal-dataflow"
PAIR = ROOT / "fixtures" / "motorcycle"
DORA = pathlib.Path(sys.executable).with_name("dora")


def environment(out: pathlib.Path, **more: str) -> dict[str, str]:
    """What the nodes read; they start by the Python that runs the test."""
    path = f"{pathlib.Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    own = {
        "PATH": path,
        "DORSAL_OUT": str(out),
        "DORSAL_MAP": str(out / "map"),
        "DORSAL_LOG": str(out / "log.mcap"),
        "DORSAL_PAIR": str(PAIR),
    }
    return os.environ | own | more


def copied(graph: str, out: pathlib.Path) -> pathlib.Path:
    """The graph beside copies of the nodes: dora writes its logs next to a graph, which is not the repository's."""
    for folder in ("graphs", "nodes"):
        shutil.copytree(FLOW / folder, out / folder, ignore=shutil.ignore_patterns("out", "__pycache__"))
    return out / "graphs" / graph


def start(graph: str, out: pathlib.Path, **more: str) -> subprocess.Popen:
    """Starts a graph with a daemon of its own."""
    with open(out / "dora.log", "wb") as log:
        call = [str(DORA), "run", str(copied(graph, out))]
        return subprocess.Popen(call, env=environment(out, **more), stdout=log, stderr=subprocess.STDOUT)


def finished(running: subprocess.Popen, out: pathlib.Path, within_s: float) -> None:
    """Waits for the end of a graph, which must be a good one."""
    try:
        code = running.wait(within_s)
    except subprocess.TimeoutExpired:
        running.send_signal(signal.SIGINT)
        running.wait(30)
        code = f"no end within {within_s} s"
    said = (out / "dora.log").read_text(errors="replace")
    assert code == 0, f"{code}\n{said[-4000:]}"


def status(out: pathlib.Path, node: str) -> dict:
    return json.loads((out / f"{node}.json").read_text())


def logged(out: pathlib.Path) -> dict[str, list[dict]]:
    """The messages of the log, by input, each as often as the log node has counted it."""
    messages: dict[str, list[dict]] = {}
    with open(out / "log.mcap", "rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            messages.setdefault(channel.topic.strip("/"), []).append(json.loads(message.data))
    counted = status(out, "log")
    assert {name: len(those) for name, those in messages.items()} == counted["messages"]
    for name, missed in counted["missed"].items():
        sent: dict[tuple, set] = {}
        for report in messages[name]:
            sent.setdefault((report["robot"], report["run"]), set()).add(report["seq"])
        assert missed == sum(max(numbers) - len(numbers) for numbers in sent.values())
    return messages


def map_of(out: pathlib.Path) -> str:
    """The map that the graph has left in its folder."""
    return dorsal.SharedMap(out / "map").to_json()


def single_process(reports: list[dict]) -> str:
    """The map that one process makes of these reports."""
    with tempfile.TemporaryDirectory() as folder:
        shared = dorsal.SharedMap(folder)
        shared.take(reports)
        return shared.to_json()


def line_of(pair: int, time_ms: int) -> dict:
    """What this process sees in the pair of this number that the head sends with a noise of one code."""
    rig = dorsal.Rig.read(PAIR / "rig.toml")
    labels, names = dorsal.read_labels(PAIR / "labels.toml")
    pictures = [dorsal.read_picture(PAIR / f"{eye}.png") for eye in ("left", "right")]
    noisy = [source.noisy(eye, 1, 2 * pair + side) for side, eye in enumerate(pictures)]
    return eyes.look_line(dorsal.look(*noisy, rig=rig, labels=labels, names=names), time_ms)


def memory_alone(reports: list[dict]) -> dict[str, dict]:
    """The objects that a memory of one robot, which knows of no other, makes of its reports."""
    memory = dorsal.SceneMemory(policy="follow")
    for report in reports:
        memory._line(report["line"])
    return memory.objects


def in_order(reports: list[dict]) -> list[dict]:
    """Each report once, in the order of its robot; what was sent again is the same but for `kept_from`."""
    once = {(r["robot"], r["run"], r["seq"]): r for r in reports}
    return [{k: v for k, v in once[key].items() if k != "kept_from"} for key in sorted(once)]


def variables(process: int) -> list[bytes]:
    """The environment of a process."""
    return pathlib.Path(f"/proc/{process}/environ").read_bytes().split(b"\0")


def processes_of(out: pathlib.Path, node: str) -> list[int]:
    """The processes of this node of the graph that writes to `out`."""
    found = []
    for process in pathlib.Path("/proc").iterdir():
        if not process.name.isdigit():
            continue
        try:
            call = (process / "cmdline").read_bytes().split(b"\0")
            own = f"DORSAL_OUT={out}".encode() in variables(int(process.name))
        except OSError:
            continue
        if own and any(part.endswith(f"nodes/{node}.py".encode()) for part in call):
            found.append(int(process.name))
    return found


def check_looks(out: pathlib.Path, looks: int) -> None:
    """Whether every look of a head and its eyes is in the map or counted as lost, and the map is that of one process."""
    seen = status(out, "eyes")
    assert status(out, "head")["pairs"] == looks
    # What the eyes had no time for is counted, and nothing else is missing.
    assert seen["pairs"] + seen["pairs_lost"] == looks, seen
    assert seen["reports"] == seen["acknowledged"] == seen["pairs"] and seen["pairs_unseen"] == 0
    log = logged(out)
    reports = in_order(log["reports"])
    assert [report["seq"] for report in reports] == list(range(1, seen["pairs"] + 1))
    # The first pair and the last are never dropped: here they give the same lines, to the bit.
    for report, pair in ((reports[0], 1), (reports[-1], looks)):
        assert json.dumps(report["line"]) == json.dumps(line_of(pair, report["line"]["look"]["time_ms"]))
    left = json.loads(map_of(out))
    assert left == json.loads(single_process(reports))
    [robot] = left["robots"].values()
    assert (robot["lost"], robot["refused"]) == (0, 0)
    assert robot["memory"]["objects"] == memory_alone(reports)
    answered = status(out, "question")
    assert answered["answered"] == answered["asked"] > 0 == answered["refused"]
    print(seen, answered, status(out, "map"))
