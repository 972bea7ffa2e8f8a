"""Runs OpenCV's matchers on pictures that `cargo xtask` wrote, and writes arrays it reads back.

Called as `python3 opencv_peer.py JOBS.json`. The file holds a list of jobs:

  {"matcher": "bm" | "sgbm", "left": PNG, "right": PNG, "least": px, "count": px, "out": NPY}
  {"matcher": "farneback" | "dis", "prev": PNG, "next": PNG, "out": NPY}

Disparities are float32 (y, x), x_left - x_right in pixels, NaN where the matcher gives none; flow is
float32 (2, y, x), u then v. The last line printed is JSON: OpenCV's version and seconds by job.
"""

import json
import sys
import time

import cv2
import numpy as np

BLOCK = 5
BM_BLOCK = 15


def matcher(job):
    """A stereo matcher for a range of whole pixels, OpenCV's customary settings."""
    least, count = job["least"], job["count"]
    if job["matcher"] == "bm":
        bm = cv2.StereoBM_create(numDisparities=count, blockSize=BM_BLOCK)
        bm.setMinDisparity(least)
        bm.setUniquenessRatio(10)
        bm.setSpeckleWindowSize(100)
        bm.setSpeckleRange(2)
        return bm
    return cv2.StereoSGBM_create(
        minDisparity=least,
        numDisparities=count,
        blockSize=BLOCK,
        P1=8 * BLOCK * BLOCK,
        P2=32 * BLOCK * BLOCK,
        disp12MaxDiff=1,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=2,
        mode=cv2.STEREO_SGBM_MODE_HH,
    )


def disparity(job):
    """The disparity of a pair; both pictures are padded so that every left column is searched."""
    left = cv2.imread(job["left"], cv2.IMREAD_GRAYSCALE)
    right = cv2.imread(job["right"], cv2.IMREAD_GRAYSCALE)
    before = max(0, job["least"] + job["count"])
    after = max(0, -job["least"])
    pad = lambda image: cv2.copyMakeBorder(image, 0, 0, before, after, cv2.BORDER_REPLICATE)
    left, right = pad(left), pad(right)
    start = time.perf_counter()
    found = matcher(job).compute(left, right)
    seconds = time.perf_counter() - start
    width = left.shape[1] - before - after
    found = found[:, before : before + width].astype(np.float32)
    # Sixteenths of a pixel; what is not found lies one whole pixel below the range.
    known = found >= 16 * job["least"]
    return np.where(known, found / 16, np.nan).astype(np.float32), seconds


def flow(job):
    """The flow between two frames."""
    prev = cv2.imread(job["prev"], cv2.IMREAD_GRAYSCALE)
    following = cv2.imread(job["next"], cv2.IMREAD_GRAYSCALE)
    start = time.perf_counter()
    if job["matcher"] == "farneback":
        found = cv2.calcOpticalFlowFarneback(
            prev, following, None, 0.5, 5, 15, 3, 5, 1.2, 0
        )
    else:
        dis = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
        found = dis.calc(prev, following, None)
    seconds = time.perf_counter() - start
    return np.ascontiguousarray(found.transpose(2, 0, 1), dtype=np.float32), seconds


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        jobs = json.load(file)
    cv2.setNumThreads(1)
    took = []
    for job in jobs:
        found, seconds = flow(job) if "prev" in job else disparity(job)
        np.save(job["out"], found)
        took.append(seconds)
        print("done", flush=True)
    print(json.dumps({"version": cv2.__version__, "seconds": took}))


if __name__ == "__main__":
    main()
