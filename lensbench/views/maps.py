"""Flat pictures of a lens: maps with bands and isolines, power profiles, cross-sections. Matplotlib only, no GL.

Every map is seen from in front of the wearer: +x (the wearer's left) to the right of the picture, +y up.
"""

from collections.abc import Sequence
from pathlib import Path as FilePath

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.patheffects import withStroke
from matplotlib.path import Path

from ..optics.conventions import Floats, Status, mean_power
from ..optics.lens import Lens
from ..workbench import LensMap, Profile
from .bands import Bands, map_bands
