"""A picture of a look. Matplotlib is imported when it is asked for, not before."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from dorsal._look import Look

__all__ = ["plot"]


def plot(look: Look, left: Any = None, *, path: Any = None) -> Any:
    """Draws a look side by side: the left picture with its objects, disparity, and depth if there is one; grey is unknown.

    ``left`` is the left picture as it was given to :func:`dorsal.look`. With ``path`` the figure is written there.
    Returns Matplotlib's ``Figure``. Needs ``pip install matplotlib``.
    """
    try:
        from matplotlib import colormaps
        from matplotlib.figure import Figure
    except ImportError as why:
        raise ImportError("dorsal.plot draws with Matplotlib: pip install matplotlib") from why
    planes = [("disparity, px", look.d, "turbo")]
    if look.depth_m is not None:
        planes.append(("depth, m", look.depth_m, "turbo_r"))
    pictures = planes if left is None else [("left", np.asarray(left), "gray"), *planes]
    figure = Figure(figsize=(5 * len(pictures), 4), layout="constrained")
    for axes, (title, plane, colours) in zip(figure.subplots(1, len(pictures), squeeze=False)[0], pictures):
        axes.set_title(title)
        axes.set_axis_off()
        if title == "left":
            axes.imshow(plane, cmap=colours)
            beneath = {"facecolor": "black", "alpha": 0.5, "edgecolor": "none", "pad": 1}
            for thing in look.objects:
                words = f"{thing.name}\n{thing.distance_m:.2f} m"
                x, y = thing.pixel
                axes.text(x, y, words, color="white", ha="center", va="center", fontsize=6, bbox=beneath)
            continue
        known = plane[np.isfinite(plane)]
        least, most = np.percentile(known, [1, 99]) if known.size else (0.0, 1.0)
        grey_where_unknown = colormaps[colours].with_extremes(bad="0.6")
        image = axes.imshow(plane, cmap=grey_where_unknown, vmin=least, vmax=most)
        figure.colorbar(image, ax=axes, shrink=0.8)
    if path is not None:
        figure.savefig(path, dpi=120)
    return figure
