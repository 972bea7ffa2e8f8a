"""The nodes are scripts beside the tests."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "nodes"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
