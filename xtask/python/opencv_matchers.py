"""Runs OpenCV's stereo matchers on the pairs of an exchange folder, and times them.

Usage: opencv_matchers.py FOLDER [MATCHER SETTING]

With MATCHER and SETTING, as matchers.json names them, that one alone runs.

FOLDER/pairs.json lists the pairs: name, left, right, least, shifts (a multiple of 16: disparities
least to least + shifts - 1 are searched). For every matcher and every setting of its grid, and for every pair, this
writes FOLDER/INDEX-NAME.f32 (disparity in pixels, row-major, little-endian, holes filled
with the lower neighbour on the row) and FOLDER/INDEX-NAME.u8 (1 where the matcher itself
gave a value), and at the end FOLDER/matchers.json: the settings, CPU seconds of each pair, versions.
"""

import itertools
import json
import pathlib
import sys
import time

import cv2
import numpy as np

MODES = {
    "SGBM": cv2.STEREO_SGBM_MODE_SGBM,
    "HH": cv2.STEREO_SGBM_MODE_HH,
    "3WAY": cv2.STEREO_SGBM_MODE_SGBM_3WAY,
}

# Block width, factor on the usual P1 = 8 b^2 and P2 = 32 b^2, and pre-filter cap.
SGBM_GRID = list(itertools.product([3, 5], [1, 2], [15, 63]))
# Block width and pre-filter cap.
BM_GRID = list(itertools.product([9, 15, 21], [15, 31]))


def sgbm(mode, least, shifts, block, factor, cap):
    p1, p2 = factor * 8 * block * block, factor * 32 * block * block
    return cv2.StereoSGBM_create(least, shifts, block, p1, p2, 1, cap, 10, 100, 2, MODES[mode])


def bm(least, shifts, block, cap):
    matcher = cv2.StereoBM_create(shifts, block)
    matcher.setMinDisparity(least)
    matcher.setPreFilterCap(cap)
    matcher.setSpeckleWindowSize(100)
    matcher.setSpeckleRange(2)
    matcher.setDisp12MaxDiff(1)
    return matcher


def settings():
    for mode in MODES:
        for block, factor, cap in SGBM_GRID:
            name = f"block {block}, P x {factor}, cap {cap}"
            yield mode, name, lambda *range_, m=mode, a=(block, factor, cap): sgbm(m, *range_, *a)
    for block, cap in BM_GRID:
        yield "BM", f"block {block}, cap {cap}", lambda *range_, a=(block, cap): bm(*range_, *a)


def match(matcher, left, right, least, shifts):
    """Disparity, what of it is valid, and CPU seconds of the matcher alone.

    The borders are continued by the range, so that the matcher covers the whole picture.
    """
    before, after = max(0, least + shifts), max(0, -least)
    pad = [cv2.copyMakeBorder(eye, 0, 0, before, after, cv2.BORDER_REPLICATE) for eye in (left, right)]
    start = time.process_time()
    found = matcher.compute(*pad)
    seconds = time.process_time() - start
    disparity = found[:, before : before + left.shape[1]].astype(np.float32) / 16
    return disparity, disparity >= least, seconds


def fill(disparity, valid):
    """Holes take the lower of the nearest valid values on their row; empty rows take 0."""
    unknown = np.where(valid, disparity, np.nan)
    columns = np.arange(disparity.shape[1])
    before = np.maximum.accumulate(np.where(valid, columns, -1), axis=1)
    after = np.minimum.accumulate(np.where(valid, columns, len(columns))[:, ::-1], axis=1)[:, ::-1]
    rows = np.arange(disparity.shape[0])[:, None]
    bordered = np.pad(unknown, ((0, 0), (1, 1)), constant_values=np.nan)
    filled = np.fmin(bordered[rows, before + 1], bordered[rows, after + 1])
    return np.nan_to_num(filled).astype("<f4")


def main():
    folder = pathlib.Path(sys.argv[1])
    cv2.setNumThreads(1)
    pairs = json.loads((folder / "pairs.json").read_text())
    for pair in pairs:
        pair["eyes"] = [cv2.imread(pair[eye], cv2.IMREAD_GRAYSCALE) for eye in ("left", "right")]
    runs = []
    wanted = tuple(sys.argv[2:4])
    tried = [one for one in settings() if not wanted or one[:2] == wanted]
    for index, (matcher, setting, make) in enumerate(tried):
        seconds = {}
        for pair in pairs:
            searched = pair["least"], pair["shifts"]
            disparity, valid, took = match(make(*searched), *pair["eyes"], *searched)
            seconds[pair["name"]] = took
            stem = f"{index}-{pair['name']}"
            fill(disparity, valid).tofile(folder / f"{stem}.f32")
            valid.astype(np.uint8).tofile(folder / f"{stem}.u8")
        runs.append({"index": index, "matcher": matcher, "setting": setting, "seconds": seconds})
        print(f"{matcher}, {setting}", file=sys.stderr, flush=True)
    versions = {"opencv": cv2.__version__, "numpy": np.__version__}
    (folder / "matchers.json").write_text(json.dumps({"versions": versions, "runs": runs}))


main()
