"""Cameras here, the map there: two network namespaces, a coordinator and two daemons bound to them, no multicast."""

import contextlib
import os
import shutil
import subprocess
import time

import pytest

import graph

LOOKS = 200
#: Where the graph says that it stands on each machine.
INSTALLED = "/opt/dorsal/crates/dorsal-dataflow/graphs"
ROBOT, BASE = "10.77.0.1", "10.77.0.2"


def ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True)


@contextlib.contextmanager
def two_namespaces():
    """Two network namespaces joined by one cable that carries no multicast; removed at the end."""
    names = [f"dorsal-{side}-{os.getpid()}" for side in ("robot", "base")]
    cable = [f"dv{side}{os.getpid() % 100000}" for side in "rb"]
    made = []
    try:
        for name in names:
            ip("netns", "add", name)
            made.append(name)
        ip("link", "add", cable[0], "netns", names[0], "type", "veth", "peer", "name", cable[1], "netns", names[1])
        for name, end, address in zip(names, cable, (ROBOT, BASE), strict=True):
            ip("-n", name, "addr", "add", f"{address}/24", "dev", end)
            ip("-n", name, "link", "set", end, "multicast", "off", "up")
            ip("-n", name, "link", "set", "lo", "up")
        yield names
    finally:
        for name in made:
            ip("netns", "delete", name)


@pytest.mark.skipif(os.name != "posix" or not shutil.which("ip") or os.geteuid() != 0, reason="needs ip and root")
def test_the_map_is_that_of_one_process(tmp_path):
    flow = graph.copied("two-machines.yml", tmp_path)
    flow.write_text(flow.read_text().replace(INSTALLED, str(flow.parent)))
    own = graph.environment(
        tmp_path, DORSAL_PAIRS=str(LOOKS), DORSAL_NOISE="1", DORSAL_INTERVAL_S="0.35", HOME=str(tmp_path)
    )
    running: list[subprocess.Popen] = []

    def dora(namespace: str, *arguments: str) -> subprocess.Popen:
        call = ["ip", "netns", "exec", namespace, str(graph.DORA), *arguments]
        with open(tmp_path / "dora.log", "ab") as log:
            started = subprocess.Popen(call, env=own, cwd=tmp_path, stdout=log, stderr=subprocess.STDOUT)
        running.append(started)
        return started

    with two_namespaces() as (robot, base):
        try:
            dora(base, "coordinator", "--interface", BASE, "--store", "memory")
            time.sleep(1.5)
            for namespace, machine, address in ((robot, "robot", ROBOT), (base, "base", BASE)):
                bound = ["--coordinator-addr", BASE, "--zenoh-no-multicast", "--zenoh-listen", address]
                dora(namespace, "daemon", "--machine-id", machine, *bound)
                time.sleep(1.5)
            attached = dora(base, "start", str(flow), "--attach", "--coordinator-addr", BASE)
            graph.finished(attached, tmp_path, 300)
        finally:
            for process in reversed(running):
                process.terminate()
            for process in running:
                process.wait(30)
    graph.check_looks(tmp_path, LOOKS)
