"""Slow, obvious twins of the optics: one point or one ray at a time, from the definitions, without its kernels."""

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import brentq, root_scalar
from scipy.spatial.transform import Rotation

# -- sags, mm, +z to the scene; curvatures are positive with the centre on the eye's side ------------------------------


def conic_sag(curvature, conic_constant=0.0, asphere=()):
    def sag(x, y):
        q = x * x + y * y
        if curvature == 0:
            depth = 0.0
        else:
            top = 1 / curvature if conic_constant <= -1 else 1 / (curvature * (1 + conic_constant))
            implicit = lambda z: curvature * (q + (1 + conic_constant) * z * z) - 2 * z  # noqa: E731
            depth = brentq(implicit, 0, top, xtol=1e-15, rtol=1e-15)
        return -depth - sum(a * q**power for power, a in enumerate(asphere, start=2))

    return sag


def circle_depth(curvature, u):
    return 0.0 if curvature == 0 else 1 / curvature - np.sign(curvature) * np.sqrt(1 / curvature**2 - u * u)


def torus_sag(curvature_along, curvature_across, axis):
    """The arc in the plane (u, z) turned about the line z = -1 / curvature_across parallel to u."""

    def sag(x, y):
        u, v = in_meridians(x, y, axis)
        arc = circle_depth(curvature_along, u)
        if curvature_across == 0:
            return -arc
        radius = 1 / curvature_across
        turned = np.sqrt((radius - arc) ** 2 - v * v)
        return -(radius - np.sign(radius) * turned)

    return sag


def biconic_sag(curvature_along, curvature_across, axis, conic_along, conic_across):
    def sag(x, y):
        u, v = in_meridians(x, y, axis)
        top = curvature_along * u**2 + curvature_across * v**2
        inside = (1 + conic_along) * (curvature_along * u) ** 2 + (1 + conic_across) * (curvature_across * v) ** 2
        return -top / (1 + np.sqrt(1 - inside))

    return sag


def spline_sag(knots_x, knots_y, coefficients, degree):
    def sag(x, y):
        return float(BSpline(knots_x, BSpline(knots_y, coefficients, degree)(y), degree)(x))

    return sag


def in_meridians(x, y, axis):
    a = np.radians(axis)
    return x * np.cos(a) + y * np.sin(a), y * np.cos(a) - x * np.sin(a)


# -- derivatives by sixth-order central differences --------------------------------------------------------------------

FIRST = {-3: -1 / 60, -2: 9 / 60, -1: -45 / 60, 1: 45 / 60, 2: -9 / 60, 3: 1 / 60}
SECOND = {-3: 2 / 180, -2: -27 / 180, -1: 270 / 180, 0: -490 / 180, 1: 270 / 180, 2: -27 / 180, 3: 2 / 180}


def first_derivative(function, step):
    return sum(w * function(k * step) for k, w in FIRST.items()) / step


def second_derivative(function, step):
    return sum(w * function(k * step) for k, w in SECOND.items()) / step**2


def sag_derivatives(sag, x, y, step=0.3):
    """f, fx, fy, fxx, fxy, fyy."""
    return (
        sag(x, y),
        first_derivative(lambda h: sag(x + h, y), step),
        first_derivative(lambda h: sag(x, y + h), step),
        second_derivative(lambda h: sag(x + h, y), step),
        first_derivative(lambda h: first_derivative(lambda k: sag(x + h, y + k), step), step),
        second_derivative(lambda h: sag(x, y + h), step),
    )


def curvatures(derivatives):
    """Mean and Gaussian curvature of the graph z = f."""
    _, fx, fy, fxx, fxy, fyy = derivatives
    w = 1 + fx**2 + fy**2
    mean = ((1 + fy**2) * fxx - 2 * fx * fy * fxy + (1 + fx**2) * fyy) / (2 * w**1.5)
    return mean, (fxx * fyy - fxy**2) / w**2


# -- one ray -----------------------------------------------------------------------------------------------------------


def pose(about_x, about_y):
    return Rotation.from_euler("YX", [about_y, about_x]).as_matrix()


def snell(direction, normal, n0, n1):
    """Vector form of Snell's law: the tangential part of n d is kept."""
    normal = normal * np.sign(direction @ normal)
    tangential = n0 / n1 * (direction - (direction @ normal) * normal)
    return tangential + np.sqrt(1 - tangential @ tangential) * normal


def meet(sag, point, direction):
    """Where the ray point + t direction meets z = sag(x, y)."""
    gap = lambda t: point[2] + t * direction[2] - sag(*(point + t * direction)[:2])  # noqa: E731
    guess = -point[2] / direction[2]
    return point + root_scalar(gap, x0=guess, x1=guess + 0.01, xtol=1e-14, rtol=1e-15).root * direction


def through_surface(sag, rotation, vertex, n0, n1, point, direction):
    p = meet(sag, rotation.T @ (point - vertex), rotation.T @ direction)
    slope = [first_derivative(lambda h: sag(p[0] + h, p[1]), 0.1), first_derivative(lambda h: sag(p[0], p[1] + h), 0.1)]
    normal = np.array([-slope[0], -slope[1], 1.0])
    bent = snell(rotation.T @ direction, normal / np.linalg.norm(normal), n0, n1)
    return rotation @ p + vertex, rotation @ bent


def trace(surfaces, lens, wear, point, direction):
    """Entry point, exit point and direction of one ray; surfaces: the sags of back and front. Fitting point at (0, 0)."""
    turn = pose(wear.pantoscopic_angle, wear.face_form_angle * (-1 if lens.side == "R" else 1))
    back, front = lens.back, lens.front
    behind = _height(surfaces[0], pose(*back.tilt), back.decentration)
    shift = np.array([*wear.decentration, 0.0]) - turn @ [0.0, 0.0, behind]
    ray, points = (np.asarray(point, float), np.asarray(direction, float)), []
    for sag, surface, z, n0, n1 in (
        (surfaces[0], back, 0.0, 1.0, lens.index),
        (surfaces[1], front, lens.centre_thickness, lens.index, 1.0),
    ):
        vertex = turn @ [*surface.decentration, z] + shift
        ray = through_surface(sag, turn @ pose(*surface.tilt), vertex, n0, n1, *ray)
        points.append(ray[0])
    return points[0], points[1], ray[1]


def _height(sag, rotation, decentration):
    start = rotation.T @ [-decentration[0], -decentration[1], 0.0]
    return (rotation @ meet(sag, start, rotation.T @ [0.0, 0.0, 1.0]))[2]


# -- pencils -----------------------------------------------------------------------------------------------------------


def across(direction):
    """e1, e2: the world's x and y carried by the shortest turn of +z onto the direction."""
    d = np.asarray(direction, float)
    axis = np.cross([0, 0, 1], d)
    size = np.linalg.norm(axis)
    turn = np.eye(3) if size == 0 else Rotation.from_rotvec(axis / size * np.arctan2(size, d[2])).as_matrix()
    return turn[:, 0], turn[:, 1]


def landing(exit_point, direction, at, along):
    """Where rays (n, 3) cut the plane through `at` perpendicular to `along`: (n, 2) in the frame of `along`."""
    t = ((at - exit_point) @ along) / (direction @ along)
    return (exit_point + t[:, None] * direction - at) @ np.array(across(along)).T


def blur(transfer, vergence, distance, radius):
    """M(s) = r_p [(A + B S) + s (C + D S)]; vergence in D."""
    a, b, c, d = transfer[:2, :2], transfer[:2, 2:], transfer[2:, :2], transfer[2:, 2:]
    s = vergence / 1000
    return radius * (a + b @ s + distance * (c + d @ s))


def coddington(radii, thickness, index, lever, angle, object_distance=np.inf):
    """As-worn (tangential, sagittal) image vergence in D of a centred lens of two spheres, on the vertex sphere.

    radii: back and front, mm, positive with the centre on the eye's side. The ray leaves the centre of rotation, `lever`
    mm behind the back vertex, at `angle`; the light comes back along it. Coddington: n' cos^2 i' / t' = n cos^2 i / t + k
    and n' / s' = n / s + k with k = (n' cos i' - n cos i) / r.
    """
    point, ray = np.array([0.0, -lever]), np.array([np.sin(angle), np.cos(angle)])
    bends, points, n0 = [], [], 1.0
    for r, vertex, n1 in ((radii[0], 0.0, index), (radii[1], thickness, 1.0)):
        to_centre = np.array([0.0, vertex - r]) - point
        nearest = to_centre @ ray
        half_chord = np.sqrt(r * r - to_centre @ to_centre + nearest**2)
        point = point + (nearest + np.sign(r) * half_chord) * ray
        normal = (point - [0.0, vertex - r]) / r
        cos0 = ray @ normal
        ray = snell(ray, normal, n0, n1)
        cos1 = ray @ normal
        points.append(point)
        bends.append((n0, n1, cos0, cos1, r))
        n0 = n1
    back_distance = np.hypot(points[0][0], points[0][1] + lever)
    tangential = sagittal = -1 / object_distance
    inner = np.linalg.norm(points[1] - points[0])
    for (n_eye, n_scene, c_eye, c_scene, r), way in zip(bends[::-1], (inner, back_distance - lever), strict=True):
        k = (n_eye * c_eye - n_scene * c_scene) / r
        tangential = (c_scene**2 * tangential + k) / c_eye**2
        sagittal = sagittal + k
        tangential = tangential / (1 - way * tangential / n_eye)
        sagittal = sagittal / (1 - way * sagittal / n_eye)
    return 1000 * tangential, 1000 * sagittal


# -- the atlas ---------------------------------------------------------------------------------------------------------


def seen_by_atlas(atlas, eye, point, rule):
    """Tangents (2,) of the gaze that meets a point (mm from the centre of rotation), and their change (2, 2) by the pupil."""
    pitch, depth = atlas.u[1] - atlas.u[0], point[2] - atlas.plane
    table = np.asarray(atlas.table, float)

    def row(uv):
        i, j = (min(max(int((t - g[0]) // pitch), 0), g.size - 2) for t, g in zip(uv, (atlas.u, atlas.v), strict=True))
        f, g = (uv[0] - atlas.u[i]) / pitch, (uv[1] - atlas.v[j]) / pitch
        low = (1 - f) * table[:, j, i] + f * table[:, j, i + 1]
        return (1 - g) * low + g * ((1 - f) * table[:, j + 1, i] + f * table[:, j + 1, i + 1])

    def landing_at(uv):
        ray = row(uv)[0]
        return ray[:2] + depth * ray[2:]

    def change(uv):
        by_u = first_derivative(lambda h: landing_at(uv + h * np.array([1, 0])), pitch / 50)
        return np.stack([by_u, first_derivative(lambda h: landing_at(uv + h * np.array([0, 1])), pitch / 50)], axis=1)

    uv = point[:2] / point[2]
    for _ in range(6):
        uv = uv - np.linalg.solve(change(uv), landing_at(uv) - point[:2])
    ray, a, c, b, d = row(uv)
    m, n = (a + depth * c).reshape(2, 2), (b + depth * d).reshape(2, 2)
    limit, refraction = eye.accommodation / 1000, eye.pupil_refraction / 1000
    relaxed = m + n @ refraction
    if rule == "retina":
        used = np.trace(np.linalg.solve(n, relaxed)) / 2
    elif rule == "object":
        used = np.sum(relaxed * n) / np.sum(n * n)
    elif rule == "paper":
        p, q = (signed_mean_axis(x) for x in (relaxed, relaxed - limit * n))
        used = limit * p / (p - q)
    else:
        used, limit = rule / 1000, rule / 1000
    across = eye.pupil_diameter / 2 * (relaxed - np.clip(used, 0, limit) * n)
    direction = np.array([*ray[2:], 1.0]) / np.linalg.norm([*ray[2:], 1.0])
    e = _listing(direction)[:2]
    on_plane = e[:, :2].T - np.outer(direction[:2], e[:, 2]) / direction[2]
    return uv, -np.linalg.solve(change(uv), on_plane @ across)


def signed_mean_axis(m):
    axes = np.linalg.svd(m)[1]
    return (axes[0] + np.sign(np.linalg.det(m)) * axes[1]) / 2 * np.sign(m[0, 0] + m[1, 1])


def _listing(direction):
    return np.array([*across(direction), direction])
