"""Transverse chromatic aberration: prism over Abbe number, slow rays at two indices, and the dispersion formula."""

import naive
import numpy as np
import pytest

from lensbench.optics import surfaces
from lensbench.optics.chromatic import transverse_chromatic_aberration
from lensbench.optics.eye import Wear, Wearer
from lensbench.optics.gaze import direction_from_angles, trace
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import DISPERSION_LINES, MATERIALS

CR39 = MATERIALS["CR-39"]


def coloured_lens(front, back, thickness, wavelength="d", material=CR39):
    return Lens(front, back, thickness, material, circle_outline(160.0), wavelength=wavelength)


@pytest.mark.parametrize("name", MATERIALS)
def test_dispersion_between_f_and_c_is_the_abbe_number(name):
    m, lines = MATERIALS[name], DISPERSION_LINES["d"]
    spread = m.index_at(lines["blue"], "d") - m.index_at(lines["red"], "d")
    assert spread == pytest.approx((m.n_d - 1) / m.abbe, rel=1e-12)
    assert m.index_at(546.07, "e") == m.n_e
    assert m.index_at(587.56, "d") == m.n_d
    lines = DISPERSION_LINES["e"]
    abbe_e = (m.n_e - 1) / (m.index_at(lines["blue"], "e") - m.index_at(lines["red"], "e"))
    assert abbe_e == pytest.approx(m.abbe, abs=1.0)


@pytest.mark.parametrize("tilt", [(0.02, 0.0), (0.0, 0.03)])
def test_a_thin_wedge_scatters_its_prism_over_the_abbe_number(tilt):
    lens = coloured_lens(surfaces.plane(tilt=tilt), surfaces.plane(), 3.0)
    field = trace(lens, Wearer(), [[0.0, 0.0, 1.0]])
    expected = field.prism_components()[0] / CR39.abbe
    assert transverse_chromatic_aberration(field)[0] == pytest.approx(expected, rel=2e-3, abs=1e-9)


@pytest.mark.parametrize("power", [-6.0, 4.0])
def test_prism_over_abbe_number_through_the_periphery(power):
    """A thin lens of a usual base curve, 20 degrees off: within a tenth, and along the prism."""
    n = CR39.n_d
    lens = coloured_lens(surfaces.conic(0.5 * (n - 1) / 50), surfaces.conic((5 - power) / (1000 * (n - 1))), 1.0)
    field = trace(lens, Wearer(), [direction_from_angles(0.2, -0.3)])
    expected = field.prism_components()[0] / CR39.abbe
    assert transverse_chromatic_aberration(field)[0] == pytest.approx(expected, abs=0.1 * np.linalg.norm(expected))


@pytest.mark.parametrize(("wavelength", "distance"), [("d", np.inf), ("e", 400.0)])
def test_two_slow_rays(wavelength, distance):
    lens = coloured_lens(surfaces.sphere(80.0), surfaces.sphere(140.0), 6.0, wavelength, MATERIALS["polycarbonate"])
    wearer = Wearer(wear=Wear(13.0, 0.1, 0.05))
    gaze = direction_from_angles(-0.3, 0.25)
    field = trace(lens, wearer, [gaze])
    start, e, seen = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * gaze, naive.across(gaze), []
    for colour in ("blue", "red"):
        index = lens.material.index_at(DISPERSION_LINES[wavelength][colour], wavelength)
        twin = coloured_lens(lens.front, lens.back, 6.0, wavelength, type(CR39)("one colour", index, index, 1.0, 1.0))
        sags = naive.conic_sag(1 / 140), naive.conic_sag(1 / 80)
        _, leave, out = naive.trace(sags, twin, wearer.wear, start, gaze)
        aim = out if np.isinf(distance) else leave + distance * out - field.origin[0]
        seen.append(100 * np.array([aim @ e[0], aim @ e[1]]) / (aim @ gaze))
    assert transverse_chromatic_aberration(field, distance)[0] == pytest.approx(seen[0] - seen[1], abs=1e-8)
    assert np.linalg.norm(seen[0] - seen[1]) > 0.05


def test_the_naked_eye_has_no_dispersion_here():
    with pytest.raises(ValueError, match="naked eye"):
        transverse_chromatic_aberration(trace(None, Wearer(), [[0.0, 0.0, 1.0]]))
