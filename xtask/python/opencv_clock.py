"""Times OpenCV's matchers on one pair, one run at a time, as it is told.

Usage: opencv_clock.py LEFT RIGHT SHIFTS THREADS

LEFT and RIGHT are pictures of one size; disparities 0 to SHIFTS - 1 are searched. Writes a line with
OpenCV's version, and then, for every line of standard input that names a matcher (SGBM, 3WAY, BM or
DIS), one line with the CPU seconds and the wall seconds of one run.
"""

import sys
import time

import cv2

left, right = (cv2.imread(path, cv2.IMREAD_GRAYSCALE) for path in sys.argv[1:3])
shifts, threads = int(sys.argv[3]), int(sys.argv[4])
if left is None or right is None:
    sys.exit(f"{sys.argv[1]} or {sys.argv[2]} cannot be read")
cv2.setNumThreads(threads)


def sgbm(mode):
    matcher = cv2.StereoSGBM_create(0, shifts, 5, 8 * 25, 32 * 25, mode=mode)
    return lambda: matcher.compute(left, right)


bm = cv2.StereoBM_create(shifts, 15)
flow = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
MATCHERS = {
    "SGBM": sgbm(cv2.STEREO_SGBM_MODE_SGBM),
    "3WAY": sgbm(cv2.STEREO_SGBM_MODE_SGBM_3WAY),
    "BM": lambda: bm.compute(left, right),
    "DIS": lambda: flow.calc(left, right, None),
}

print(cv2.__version__, flush=True)
for line in sys.stdin:
    run = MATCHERS[line.strip()]
    cpu, wall = time.process_time(), time.perf_counter()
    run()
    print(time.process_time() - cpu, time.perf_counter() - wall, flush=True)
