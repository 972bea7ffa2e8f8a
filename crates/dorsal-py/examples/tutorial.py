"""A pair of pictures as depth, objects, relations and a memory of them; makes its pictures in a folder.

    pip install matplotlib
    python tutorial.py OUT [SCENE]

SCENE is a folder with left.png, right.png, rig.toml and labels.toml, as fixtures/motorcycle of the repository.
"""

import pathlib
import sys

import numpy as np

import dorsal

HERE = pathlib.Path(__file__).resolve()


def main() -> None:
    if not 2 <= len(sys.argv) <= 3 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    out = pathlib.Path(sys.argv[1])
    scene = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else HERE.parents[3] / "fixtures" / "motorcycle"
    out.mkdir(parents=True, exist_ok=True)

    # Any arrays will do: these are uint8, RGB.
    left, right = (dorsal.read_picture(scene / f"{eye}.png") for eye in ("left", "right"))
    rig = dorsal.Rig.read(scene / "rig.toml")

    # What the first level hears: the energy of eight orientations, at the finest scale.
    finest = dorsal.v1.respond(left, scales=1)[0]
    strongest = dorsal.v1.energy(finest).argmax(axis=0)
    print(f"bars of orientation 0 are the strongest at {np.mean(strongest == 0):.0%} of the pixels")

    # Disparity alone needs no rig.
    field = dorsal.disparity.estimate(left, right)
    print(f"a disparity at {field.density:.1%} of the pixels, {np.nanmedian(field.d):.1f} px in the median")

    # With a rig and labels: metres, places, relations.
    labels, names = dorsal.read_labels(scene / "labels.toml")
    look = dorsal.look(left, right, rig=rig, labels=labels, names=names)
    dorsal.plot(look, left, path=out / "labelled.png")
    for thing in look.objects:
        print(f"{thing.name:>16} {thing.distance_m:.2f} m away, give or take {thing.distance_sigma_m:.2f}")
    first, second = (thing.name for thing in look.objects[:2])
    print(look.relation(first, second))

    # Without labels: what stands on the ground.
    found = dorsal.look(left, right, rig=rig, segment=True, estimator="dense")
    dorsal.plot(found, left, path=out / "segmented.png")
    print(f"{len(found.objects)} things stand on the ground")

    # A memory outlives the look, answers, and says why.
    memory = dorsal.SceneMemory(system="robot-150")
    memory.remember(look, time_ms=0, eyes_above_ground_m=0.5)
    for question in (f"relation {second} from {first}", f"where {first}", f"explain {second} from {first}"):
        print(f"{question}?\n  {memory.ask(question)}")
    memory.save(out / "memory.json")
    print(f"written: {', '.join(sorted(file.name for file in out.iterdir()))} in {out}")


if __name__ == "__main__":
    main()
