"""Several designs in one picture: their power and astigmatism along the main meridian."""

from collections.abc import Sequence
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from ..layers import Profile
from ..optics.conventions import mean_power
from ..optics.lens import Lens
from .maps import blank_figure, calm, place, titles

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")  # Okabe & Ito 2008
DASHES = ("solid", (0, (6, 2)), (0, (2, 1.5)), (0, (6, 2, 1, 2)))


def profiles_figure(lenses: Sequence[Lens], profiles: Sequence[Profile]) -> Figure:
    """Mean power less the order and astigmatism (D, across) against height y (mm, up), one line a design."""
    figure = blank_figure(11.5, 6.6)
    power, astigmatism = place(figure, 0.8, 0.65, 4.6, 4.9), place(figure, 5.9, 0.65, 2.6, 4.9)
    for k, (lens, profile) in enumerate(zip(lenses, profiles, strict=True)):
        look = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)], "linewidth": 2.0}
        ordered = float(mean_power(lens.ordered.power())) if lens.ordered else 0.0
        name = fill(lens.name.replace("$", r"\$"), 30)
        power.plot(profile.mean_power - ordered, profile.y, label=name, **look)
        astigmatism.plot(profile.astigmatism, profile.y, **look)
    low, high = (f([f(p.y) for p in profiles]) for f in (np.min, np.max))
    power.set(xlabel="as-worn mean power less the ordered distance power, D", ylabel="y, mm")
    astigmatism.set(xlabel="as-worn astigmatism, D", xlim=(0, None))
    for axes in (power, astigmatism):
        axes.set_ylim(low, high)
        calm(axes)
    astigmatism.tick_params(labelleft=False)
    figure.legend(loc="upper left", bbox_to_anchor=(8.6 / 11.5, 5.6 / 6.6), fontsize=9, frameon=False, labelspacing=0.9)
    titles(figure, power.get_position().x0, "Power along the main meridian", "objects at infinity")
    return figure
