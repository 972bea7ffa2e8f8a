"""What the tests look at: the Motorcycle pair of the repository, and the command beside the package."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import dorsal

ROOT = pathlib.Path(__file__).resolve().parents[3]
MOTORCYCLE = ROOT / "fixtures" / "motorcycle"


@pytest.fixture(scope="session")
def pair() -> tuple[np.ndarray, np.ndarray]:
    return tuple(dorsal.read_picture(MOTORCYCLE / f"{eye}.png") for eye in ("left", "right"))


@pytest.fixture(scope="session")
def rig() -> dorsal.Rig:
    return dorsal.Rig.read(MOTORCYCLE / "rig.toml")


@pytest.fixture(scope="session")
def small_pair() -> tuple[np.ndarray, np.ndarray]:
    """A textured wall, 5 px nearer than infinity, as floats."""
    y, x = np.mgrid[0:48, 0:64].astype(float)
    waves = [(0.15 + 0.12 * i, 2.4 * i) for i in range(16)]

    def seen(shift: float) -> np.ndarray:
        grey = sum(np.sin(f * ((x + shift) * np.cos(a) + y * np.sin(a))) for f, a in waves)
        return (0.5 + 0.05 * grey).astype(np.float32)

    return seen(0.0), seen(5.0)


@pytest.fixture(scope="session")
def command():
    """Runs `dorsal look` on the Motorcycle pair and gives the folder of its results."""
    dorsal_command = os.environ.get("DORSAL_COMMAND")
    if not dorsal_command:
        pytest.fail("DORSAL_COMMAND names the command `dorsal`, built; `cargo xtask wheel` sets it")

    def run(out: pathlib.Path, *arguments: str) -> pathlib.Path:
        pictures = [str(MOTORCYCLE / f"{eye}.png") for eye in ("left", "right")]
        call = [dorsal_command, "look", *pictures, "--quiet", "--out", str(out), *arguments]
        subprocess.run(call, check=True, stdout=subprocess.DEVNULL)
        return out

    return run
