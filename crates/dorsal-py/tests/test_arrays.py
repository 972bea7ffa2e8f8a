"""Which arrays a look takes, which it refuses and in what words, and what it gives."""

import gc
import multiprocessing
import threading

import numpy as np
import pytest

import dorsal


def bits(look: dorsal.Look) -> bytes:
    return look.dx.tobytes()


def test_views_of_any_strides_work(pair):
    left, right = (np.ascontiguousarray(eye[100:220:2, 200:360]) for eye in pair)
    plain = bits(dorsal.look(left, right))
    wide = [np.zeros((*eye.shape[:2], 4), np.uint8) for eye in (left, right)]
    for held, eye in zip(wide, (left, right)):
        held[:, :, :3] = eye
    others = {
        "strided": [eye[100:220:2, 200:360] for eye in pair],
        "fortran": [np.asfortranarray(left), np.asfortranarray(right)],
        "mirrored twice": [eye[::-1, ::-1].copy()[::-1, ::-1] for eye in (left, right)],
        "with alpha": wide,
        "channels turned twice": [eye[:, :, ::-1].copy()[:, :, ::-1] for eye in (left, right)],
        "read-only": [np.frombuffer(eye.tobytes(), np.uint8).reshape(eye.shape) for eye in (left, right)],
    }
    for name, eyes in others.items():
        assert bits(dorsal.look(*eyes)) == plain, name


def test_dtypes_work(small_pair):
    left, right = small_pair
    plain = bits(dorsal.look(left, right))
    swapped = [eye.astype(">f4") for eye in small_pair]
    assert bits(dorsal.look(*swapped)) == plain
    assert bits(dorsal.look(*[eye.astype(np.float64) for eye in small_pair])) == plain
    assert bits(dorsal.look(left.tolist(), right.tolist())) == plain
    odd = np.zeros((48, 64), [("skip", "u1"), ("luma", "<f4")])
    odd["luma"] = left
    assert not odd["luma"].flags.aligned
    assert bits(dorsal.look(odd["luma"], right)) == plain
    for dtype, white in [(np.uint8, 255), (np.uint16, 65535)]:
        codes = [np.round(eye * white).astype(dtype) for eye in small_pair]
        assert np.nanmedian(dorsal.look(*codes, scales=4).d) == pytest.approx(5.0, abs=0.05)


def test_refusals_say_what(small_pair, rig):
    sized = dorsal.Rig.from_toml("size_px = [640, 480]\n" + rig.to_toml())
    left, right = small_pair
    holed = left.copy()
    holed[3, 7] = np.nan
    refused = [
        (lambda: dorsal.look(holed, right), r"left: .*x = 7.*y = 3"),
        (lambda: dorsal.look(left, right[:-1]), r"left has 64 x 48 pixels and right has 64 x 47"),
        (lambda: dorsal.look(left[:0], right[:0]), "left: "),
        (lambda: dorsal.look(left[0], right[0]), r"left has shape \[64\]"),
        (lambda: dorsal.look(left, right * 255), r"right reaches .*divide"),
        (lambda: dorsal.look(left.astype(np.int32), right), "left holds int32; wanted is uint8"),
        (lambda: dorsal.look(left, right.astype(complex)), "right holds complex128"),
        (lambda: dorsal.look(left, right.astype(object)), "right holds object"),
        (lambda: dorsal.look(left, right, estimator="sgm"), "estimator is 'sgm'"),
        (lambda: dorsal.look(left, right, range="far"), "range is 'far'"),
        (lambda: dorsal.look(left, right, scales=0), "scales"),
        (lambda: dorsal.look(left, right, system="miles"), "'miles'"),
        (lambda: dorsal.look(left, right, estimator="dense", rectify="rig"), "needs a rig"),
        (lambda: dorsal.look(left, right, segment=True), "need a rig"),
        (lambda: dorsal.look(left, right, rig=sized), "rig is one of pictures of 640 x 480 pixels"),
        (lambda: dorsal.Rig.parallel(-1.0, (31.5, 23.5), 0.1), "focal"),
        (lambda: dorsal.Rig.parallel(100.0, (31.5, 23.5), 0.0), "baseline"),
        (lambda: dorsal.DepthMap.of_metres(np.zeros(3)), "shape"),
    ]
    for call, words in refused:
        with pytest.raises(ValueError, match=words):
            call()
    with pytest.raises(FileNotFoundError, match="none.toml"):
        dorsal.Rig.read("none.toml")


def test_colours_of_wrong_kind_are_refused(pair):
    left, right = (eye[:48, :64] for eye in pair)
    refused = [
        (lambda: dorsal.look(left.astype(np.float32), right), "left holds float32; wanted is uint8 or uint16, for colours"),
        (lambda: dorsal.look(left, right.astype(np.int64)), "right holds int64"),
        (lambda: dorsal.look(left > 9, right), "left holds bool"),
        (lambda: dorsal.look(left, right[:, :, :2]), r"right has shape \[48, 64, 2\]"),
        (lambda: dorsal.look(left[None], right[None]), r"left has shape \[1, 48, 64, 3\]"),
        (lambda: dorsal.look(left[:, :0], right[:, :0]), "left: "),
    ]
    for call, words in refused:
        with pytest.raises(ValueError, match=words):
            call()


def test_pictures_of_any_size_do_not_mix(pair):
    """Planes are kept from look to look: what another look left in them must not show, whatever the sizes and kinds."""
    sizes = [(48, 64), (400, 500), (64, 48), (400, 500), (48, 64)]
    eyes = {size: [eye[: size[0], : size[1]] for eye in pair] for size in sizes}
    first = {size: bits(dorsal.look(*eyes[size])) for size in set(sizes)}
    for size in sizes:
        assert bits(dorsal.look(*eyes[size])) == first[size]
        grey = [eye[:, :, 1] for eye in eyes[size]]
        dorsal.look(*grey)
        dorsal.look(*[eye.astype(np.float32) / 255 for eye in grey])
        assert bits(dorsal.look(*eyes[size])) == first[size]
        with pytest.raises(ValueError):
            dorsal.look(eyes[size][0], eyes[size][1][1:])


def test_a_look_says_how_long_it_took(small_pair):
    assert 0 < dorsal.look(*small_pair).seconds < 60


def test_labels_of_any_integers(small_pair):
    rig = dorsal.Rig.parallel(100.0, (31.5, 23.5), 0.1)
    marked = np.zeros((48, 64), np.int64)
    marked[16:32, 24:40] = 3
    for labels in (marked, marked.astype(np.uint8), np.asfortranarray(marked), marked == 3):
        look = dorsal.look(*small_pair, rig=rig, labels=labels)
        (poster,) = look.objects
        assert poster.depth_m == pytest.approx(100 * 0.1 / 5, rel=0.02)
        assert look.labels.dtype == np.uint16
    named = dorsal.look(*small_pair, rig=rig, labels=marked, names={3: "poster"})
    assert named.objects[0].name == "poster"
    assert "disparity" in repr(named)
    for wrong, words in [
        (-marked, "-3 to 0"),
        (marked * 30000, "0 to 90000"),
        (marked.astype(float), "whole numbers"),
        (marked[1:], "belong to the left picture"),
    ]:
        with pytest.raises(ValueError, match=words):
            dorsal.look(*small_pair, rig=rig, labels=wrong)
    with pytest.raises(ValueError, match="both named"):
        dorsal.look(*small_pair, rig=rig, labels=marked, names={3: "a", 4: "a"})


def test_planes_are_views_that_outlive_their_look(small_pair):
    look = dorsal.look(*small_pair)
    confidence = look.confidence
    assert not confidence.flags.owndata and not confidence.flags.writeable
    assert np.shares_memory(confidence, look.confidence)
    kept = confidence.copy()
    del look
    gc.collect()
    assert np.array_equal(confidence, kept)
    with pytest.raises(ValueError):
        confidence.flags.writeable = True


def test_other_threads_run_meanwhile(pair):
    """Python's lock is free while the eyes look: a thread that only counts gets on."""
    ended, counted = threading.Event(), 0

    def look():
        dorsal.look(*pair)
        ended.set()

    looking = threading.Thread(target=look)
    looking.start()
    while not ended.is_set():
        counted += 1
    looking.join()
    # A look takes far more than a hundred rounds of this loop; were the lock held, it would count a few.
    assert counted > 100


def look_in_a_child(eyes, answers):
    answers.put(bits(dorsal.look(*eyes)))


def test_a_forked_process_has_threads_of_its_own(small_pair):
    before = bits(dorsal.look(*small_pair))
    context = multiprocessing.get_context("fork")
    answers = context.SimpleQueue()
    child = context.Process(target=look_in_a_child, args=(small_pair, answers))
    child.start()
    child.join(60)
    assert not child.is_alive() and child.exitcode == 0
    assert answers.get() == before


def test_threads_change_no_bit(small_pair):
    before = bits(dorsal.look(*small_pair))
    dorsal.set_threads(1)
    assert bits(dorsal.look(*small_pair)) == before
    dorsal.set_threads(0)
