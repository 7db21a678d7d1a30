"""Fixtures for the optics: one lens or surface of every kind, each with its slow twin; reproducible hypothesis runs."""

import os
from dataclasses import replace

if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import naive
import numpy as np
import pytest
from hypothesis import settings
from scipy.interpolate import make_interp_spline

from lensbench.errors import LensBenchError
from lensbench.optics import surfaces
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import Material

settings.register_profile("lensbench", deadline=None, max_examples=30, derandomize=True)
settings.load_profile("lensbench")


def progressive_spline(degree=5, pitch=4.0, half=48.0, index=1.6):
    """knots_x, knots_y, coefficients, degree of a front surface of 5 D with an umbilic y = 0.05 x; 0.08 D/mm downwards."""
    g = np.arange(-half, half + 1e-9, pitch)
    x, y = np.meshgrid(g, g)
    x = x - 0.05 * y
    radius = 1000 * (index - 1) / 5
    depth = radius - np.sqrt(radius**2 - x**2 - y**2) - 0.08 / (1000 * (index - 1)) * (x**2 * y / 2 + y**3 / 6)
    rows = make_interp_spline(g, -depth, k=degree)
    columns = make_interp_spline(g, rows.c.T, k=degree)
    return columns.t, rows.t, columns.c.T, degree


def make_shapes():
    asphere = (2e-7, -3e-11, 4e-15, 1e-18, -2e-22, 3e-26)
    spline = progressive_spline()
    return {
        "sphere": (surfaces.sphere(90.0), naive.conic_sag(1 / 90)),
        "hollow sphere": (surfaces.sphere(-120.0), naive.conic_sag(-1 / 120)),
        "plane": (surfaces.plane(), naive.conic_sag(0.0)),
        "ellipsoid": (surfaces.conic(0.01, 0.7), naive.conic_sag(0.01, 0.7)),
        "asphere": (surfaces.conic(0.012, -1.8, asphere), naive.conic_sag(0.012, -1.8, asphere)),
        "torus": (surfaces.toric(0.006, 0.011, 35.0), naive.torus_sag(0.006, 0.011, 35.0)),
        "saddle": (surfaces.toric(-0.004, 0.007, 110.0), naive.torus_sag(-0.004, 0.007, 110.0)),
        "cylinder along": (surfaces.toric(0.0, 0.01, 70.0), naive.torus_sag(0.0, 0.01, 70.0)),
        "cylinder across": (surfaces.toric(0.01, 0.0, 70.0), naive.torus_sag(0.01, 0.0, 70.0)),
        "biconic": (surfaces.biconic(0.009, 0.012, 20.0, -0.5, 0.8), naive.biconic_sag(0.009, 0.012, 20.0, -0.5, 0.8)),
        "spline": (surfaces.bspline(*spline), naive.spline_sag(*spline)),
    }


SHAPES = make_shapes()


@pytest.fixture(scope="session")
def shapes():
    """Every (surface, slow sag function) by name."""
    return SHAPES


@pytest.fixture(scope="session", params=SHAPES)
def shape(request):
    """(surface, slow sag function)."""
    return SHAPES[request.param]


def build_lens(front, back, thickness=3.0, index=1.6, **more):
    """A lens of 160 mm diameter (as good as no edge) unless an outline is given."""
    more.setdefault("outline", circle_outline(160.0))
    return Lens(front, back, thickness, Material("test", index, index, 40.0, 1.3), **more)


@pytest.fixture(scope="session")
def lens_of():
    return build_lens


@pytest.fixture(scope="session")
def spline_arrays():
    return progressive_spline


WORN = Wear(13.0, pantoscopic_angle=0.15, face_form_angle=0.09, decentration=(1.5, -2.5))
ASTIGMATIC = Eye(power_matrix(-1.5, -2.0, 25.0), accommodation=2.0)


@pytest.fixture(scope="session", params=["sphere", "asphere", "torus", "biconic", "spline"])
def worn(request):
    """(lens, wearer, (sag of the back, sag of the front)): front of every kind, both surfaces decentred and tilted."""
    front, front_sag = SHAPES[request.param]
    front = replace(front, decentration=(-0.7, 1.1), tilt=(0.02, -0.03))
    back = surfaces.toric(0.008, 0.014, 130.0, decentration=(0.4, 0.3), tilt=(-0.015, 0.01))
    return build_lens(front, back), Wearer(ASTIGMATIC, WORN), (naive.torus_sag(0.008, 0.014, 130.0), front_sag)


@pytest.fixture(scope="session")
def gazes():
    """41 gazes (41, 3) within 30 degrees of straight ahead, off every axis of symmetry."""
    k = np.arange(41)
    tangent = np.tan(np.radians(30)) * np.sqrt((k + 0.5) / 41) * np.exp(2.4j * k)
    d = np.stack([tangent.real, tangent.imag, np.ones(41)], axis=-1)
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.fixture
def gl():
    """What draws off screen is skipped where the machine cannot."""
    pytest.importorskip("pyvista")
    from lensbench.views.offscreen import require_gl

    try:
        require_gl()
    except LensBenchError as reason:
        pytest.skip(str(reason))
