"""The two schemes of Kakimoto, Tatsukawa & Nishita 2010, "An Eyeglass Simulator Using Conoid Tracing", to measure against.

Table 1 (previous, as in their work of 2007): for each voxel a wave from the object point through the lens to the retina; the
    ellipse on the retina is scaled to the object.
Table 2 (conoid): for each ray a wave and the spread of light (a conoid) from the pupil to the front surface, for the relaxed
    and for the tense eye; for each voxel both spreads after the way to it, mixed.

Their equations, k: principal curvatures of a wave (1/mm, positive: converging), e: its principal directions, a: signed
semi-axes of the conoid, which always lie along the wave's e:
    (1)  k' = k / (1 - d k) after the way d            (2)-(6)  the wave at a surface          (8)  the eye, a thin toric lens
    (9)  a1 = a2 = the pupil's radius                  (10) a' = a k / k', which by (1) is a (1 - d k); so written: k may be 0
    (11) at a surface, E = 1 / a^2, x and y of the tangent plane: e1x'^2 E1' + e2x'^2 E2' = e1x^2 E1 + e2x^2 E2, and so along y
    (12) a = (1 - t) a_relaxed + t a_tense, t within 0 and 1, so that a1 + a2 = 0
Left open there, and taken here: how x of (11) is turned about the normal (READINGS, the first unless another is asked for);
    which axis of the tense eye goes with which of the relaxed (the nearer one); whose directions the mixed ellipse has (the
    relaxed eye's); the formula of the two ratios, horizontal and vertical, by which Table 1 scales (cosine of incidence over
    cosine of refraction, as angles between rays grow at one refraction, at the front surface; tangents instead of
    cosines have a smaller median error on torics and a larger one on progressives).
Structure of arrays, prange and fastmath as in the product's kernels. The chief rays and the surfaces' curvatures where they
pass (step 1 of both tables) are made by `chief_rays`; they are not timed, as in the paper.

Light of Table 1 runs to the eye, that of Table 2 to the scene; way: directions before and after a surface; normals along the
light; curvatures of waves and surfaces positive with the centre ahead of the light; mm.
"""

import math

import numba as nb
import numpy as np

from lensbench.optics.conventions import listing_frame
from lensbench.optics.gaze import worn_pose

FAST = {"contract", "nsz"}
inline = nb.njit(cache=True, error_model="numpy", fastmath=FAST, forceinline=True)
kernel = nb.njit(nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FAST)
ZERO, ONE = np.float32(0), np.float32(1)  # of the width of what they meet
EYE_LENGTH = 17.0  # mm, of the reduced eye in air; it cancels
READINGS = PROJECTED, INCIDENCE, WORLD = (
    0,
    1,
    2,
)  # x of (11): along e1' after the surface, in the plane of incidence, world's x

# Rows of the chief rays: direction at the eye, in the lens, in the scene; of each surface the normal (+z), the principal
# curvatures (centre on the scene's side positive) and the first principal direction; the ways from the pupil to the back
# and on to the front surface; z of the point on the front surface.
EYE, INSIDE, SCENE, BACK, FRONT, WAYS, HEIGHT = 0, 3, 6, 9, 17, 25, 27


def chief_rays(field):
    """Step 1: the rows (28, n) of a gaze field, wear frame."""
    lens, wearer = field.lens, field.wearer
    inside = field.origin - field.entry
    thickness = np.linalg.norm(inside, axis=1)
    pupil = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * field.directions
    rows = np.empty((28, thickness.size))
    rows[EYE:INSIDE], rows[SCENE:BACK] = field.directions.T, field.direction.T
    rows[INSIDE:SCENE] = (inside / thickness[:, None]).T
    rows[BACK:FRONT] = where_met(field, lens.back, 0.0, field.entry)
    rows[FRONT:WAYS] = where_met(field, lens.front, lens.centre_thickness, field.origin)
    rows[WAYS:] = np.linalg.norm(field.entry - pupil, axis=1), thickness, field.origin[:, 2]
    return rows


def where_met(field, surface, height, points):
    """Normal, principal curvatures and first principal direction (8, n) of a surface at points (n, 3), wear frame."""
    pose = worn_pose(field.lens, field.wearer.wear)
    turn = pose.rotation @ surface.rotation
    local = (points - pose.to_wear([*surface.decentration, height])) @ turn
    _, fx, fy, fxx, fxy, fyy = surface.derivatives(local[:, 0], local[:, 1])
    w = np.sqrt(1 + fx**2 + fy**2)
    normal = np.stack([-fx, -fy, np.ones_like(fx)], axis=-1) / w[:, None]
    tangents = listing_frame(normal)[:, :2]
    second = np.stack([fxx, fxy, fxy, fyy], axis=-1).reshape(-1, 2, 2) / w[:, None, None]
    second = tangents[..., :2] @ second @ np.swapaxes(tangents[..., :2], 1, 2)
    k, axes = np.linalg.eigh(np.where(np.isfinite(second), second, 0.0))
    first = np.einsum("ni,nij->nj", axes[:, :, 0], tangents)
    return np.concatenate([(normal @ turn.T).T, k.T, (first @ turn.T).T])


def eye_of(wearer):
    """Pupil radius, refraction (11, 12, 22) and amplitude of accommodation at the pupil, mm and 1/mm."""
    r = wearer.eye.pupil_refraction / 1000
    return wearer.eye.pupil_diameter / 2, r[0, 0], r[0, 1], r[1, 1], wearer.eye.accommodation / 1000


# -- vectors and waves -------------------------------------------------------------------------------------------------


@inline
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inline
def mix(c, a, s, b):
    return c * a[0] + s * b[0], c * a[1] + s * b[1], c * a[2] + s * b[2]


@inline
def opposite(a):
    return -a[0], -a[1], -a[2]


@inline
def vector(rows, first, i):
    return rows[first, i], rows[first + 1, i], rows[first + 2, i]


@inline
def surface(rows, first, i):
    return vector(rows, first, i), rows[first + 3, i], rows[first + 4, i], vector(rows, first + 5, i)


@inline
def listing(d):
    """The wear frame's x and y carried by the least turn onto the direction d (z > 0)."""
    k = 1.0 / (1.0 + d[2])
    return (1 - d[0] * d[0] * k, -d[0] * d[1] * k, -d[0]), (-d[0] * d[1] * k, 1 - d[1] * d[1] * k, -d[1])


@inline
def across_plane_of_incidence(normal, d, e):
    """The unit vector across the plane of incidence; at normal incidence e, which is across the ray."""
    p = cross(normal, d)
    size = math.sqrt(dot(p, p))
    near = size < 1e-12
    k = 1.0 / (1.0 if near else size)
    return e[0] if near else p[0] * k, e[1] if near else p[1] * k, e[2] if near else p[2] * k


@inline
def in_plane(k1, k2, e, p, q):
    """Curvatures along p, along q and the mixed one, of principal curvatures k1 along e and k2 across it."""
    c, s = dot(e, p), dot(e, q)
    return k1 * c * c + k2 * s * s, k1 * s * s + k2 * c * c, (k1 - k2) * c * s


@inline
def axes_of(kp, kq, kpq, roots):
    """Principal values, cosine and sine of the first principal direction against p: tan 2w = 2 kpq / (kp - kq).

    roots: None: by the angle, as the literature writes it; True: by the roots of the half-angle formulas.
    """
    if roots is None:
        w = 0.5 * math.atan2(2 * kpq, kp - kq)
        c, s = math.cos(w), math.sin(w)
    else:
        size = math.sqrt((kp - kq) * (kp - kq) + 4 * kpq * kpq)
        cos = (kp - kq) / (1.0 if size == 0 else size)
        c, s = math.sqrt(0.5 * (1 + cos)), math.copysign(math.sqrt(0.5 * (1 - cos)), kpq)
    return kp * c * c + kq * s * s + 2 * kpq * c * s, kp * s * s + kq * c * c - 2 * kpq * c * s, c, s


@inline
def refracted(wave, way, mu, met, roots):
    """Eq. 3 to 6: the wave (k1, k2, e1) after a surface."""
    (k1, k2, e), (d0, d1), (normal, s1, s2, es) = wave, way, met
    p = across_plane_of_incidence(normal, d0, e)
    c0, c1 = dot(normal, d0), dot(normal, d1)
    gamma = c1 - mu * c0
    kp, kq, kpq = in_plane(k1, k2, e, p, cross(d0, p))
    sp, sq, spq = in_plane(s1, s2, es, p, cross(normal, p))
    k1, k2, c, s = axes_of(
        mu * kp + gamma * sp, (mu * kq * c0 * c0 + gamma * sq) / (c1 * c1), (mu * kpq * c0 + gamma * spq) / c1, roots
    )
    return k1, k2, mix(c, p, s, cross(d1, p))


@inline
def transferred(wave, d):
    """Eq. 1: the wave after the way d."""
    return wave[0] / (1 - d * wave[0]), wave[1] / (1 - d * wave[1]), wave[2]


@inline
def best_mix(r1, r2, t1, t2):
    """Eq. 12: the semi-axes of the relaxed (r) and of the tense eye (t), mixed."""
    t = (r1 + r2) / (r1 + r2 - t1 - t2)
    t = t if t > ZERO else ZERO
    t = t if t < ONE else ONE
    return r1 + t * (t1 - r1), r2 + t * (t2 - r2)


# -- Table 1 -----------------------------------------------------------------------------------------------------------


@inline
def cosine(d, normal, across):
    """Of the angle between a direction and the normal, seen along the third axis of the plane of normal and across."""
    along, aside = dot(d, normal), dot(d, across)
    return along / math.sqrt(along * along + aside * aside)


@inline
def scaling(d_eye, d_scene, normal):
    """Step 11: the ratios, horizontal and vertical, of a ray that is refracted once."""
    e1, e2 = listing(normal)
    return (
        cosine(d_eye, normal, e1) / cosine(d_scene, normal, e1),
        cosine(d_eye, normal, e2) / cosine(d_scene, normal, e2),
    )


@inline
def previous_voxel(rows, i, index, eye, depth, roots):
    """Steps 2 to 11 of one voxel: the images of the pupil's axes at the object, 2 x 2 row by row, mm."""
    radius, r11, r12, r22, amplitude = eye
    d2, d1, d0 = opposite(vector(rows, SCENE, i)), opposite(vector(rows, INSIDE, i)), opposite(vector(rows, EYE, i))
    normal_f, f1, f2, ef = surface(rows, FRONT, i)
    normal_b, b1, b2, eb = surface(rows, BACK, i)
    to_eye, within = rows[WAYS, i], rows[WAYS + 1, i]
    s = (rows[HEIGHT, i] - depth) / d2[2]
    wave = -1 / s, -1 / s, listing(opposite(d2))[0]  # from the object point
    wave = transferred(refracted(wave, (d2, d1), 1 / index, (opposite(normal_f), -f1, -f2, ef), roots), within)
    wave = transferred(refracted(wave, (d1, d0), index, (opposite(normal_b), -b1, -b2, eb), roots), to_eye)
    e1, e2 = listing(opposite(d0))
    kp, kq, kpq = in_plane(wave[0], wave[1], wave[2], e1, e2)  # and the relaxed eye, whose power is 1 / length - R
    k1, k2, c, t = axes_of(kp + 1 / EYE_LENGTH - r11, kq + 1 / EYE_LENGTH - r22, kpq - r12, roots)
    a1, a2 = radius * (1 - EYE_LENGTH * k1), radius * (1 - EYE_LENGTH * k2)  # the spread on the retina
    less = radius * EYE_LENGTH * amplitude
    a1, a2 = best_mix(a1, a2, a1 - less, a2 - less)
    scale = (s + within + to_eye) / EYE_LENGTH  # from the retina to the object
    h, v = scaling(opposite(d0), opposite(d2), normal_f)
    h, v = h * scale, v * scale
    return h * a1 * c, -h * a2 * t, v * a1 * t, v * a2 * c


@kernel
def previous(rows, index, eye, depths, roots, out):
    """Table 1, plane by plane, every step for every voxel: n rays on k planes z = depths into out (4, k, n)."""
    for k in nb.prange(depths.size):
        for i in range(rows.shape[1]):
            m = previous_voxel(rows, i, index, eye, depths[k], roots)
            out[0, k, i], out[1, k, i], out[2, k, i], out[3, k, i] = m[0], m[1], m[2], m[3]


@kernel
def previous_by_ray(rows, index, eye, depths, roots, out):
    """Table 1, ray by ray into out (4, n, k): the compiler takes what does not depend on the depth out of the inner loop."""
    for i in nb.prange(rows.shape[1]):
        for k in range(depths.size):
            m = previous_voxel(rows, i, index, eye, depths[k], roots)
            out[0, i, k], out[1, i, k], out[2, i, k], out[3, i, k] = m[0], m[1], m[2], m[3]


# -- Table 2 -----------------------------------------------------------------------------------------------------------


@inline
def tangent_axes(along, normal):
    """x, y of the tangent plane, x the projection of a vector."""
    d = dot(along, normal)
    x = along[0] - d * normal[0], along[1] - d * normal[1], along[2] - d * normal[2]
    k = 1 / math.sqrt(dot(x, x))
    x = x[0] * k, x[1] * k, x[2] * k
    return x, cross(normal, x)


@inline
def conoid_refracted(spread, directions, way, normal, reading):
    """Eq. 11: the semi-axes after a surface; directions: e1 of the wave before and after."""
    (a1, a2), (e, f), (d0, d1) = spread, directions, way
    if reading == PROJECTED:
        along = f
    elif reading == INCIDENCE:
        along = cross(normal, across_plane_of_incidence(normal, d0, e))
    else:
        along = ONE, ZERO, ZERO
    x, y = tangent_axes((along[0], along[1], along[2]), normal)
    e2, f2 = cross(d0, e), cross(d1, f)
    ex, ey, e2x, e2y = dot(e, x) ** 2, dot(e, y) ** 2, dot(e2, x) ** 2, dot(e2, y) ** 2
    fx, fy, f2x, f2y = dot(f, x) ** 2, dot(f, y) ** 2, dot(f2, x) ** 2, dot(f2, y) ** 2
    big1, big2 = 1 / (a1 * a1), 1 / (a2 * a2)
    on_x, on_y = ex * big1 + e2x * big2, ey * big1 + e2y * big2
    k = 1 / (fx * f2y - f2x * fy)
    big1, big2 = (f2y * on_x - f2x * on_y) * k, (fx * on_y - fy * on_x) * k
    return math.copysign(1 / math.sqrt(big1), a1), math.copysign(1 / math.sqrt(big2), a2)


@inline
def grown(spread, wave, d):
    """Eq. 10: the semi-axes after the way d."""
    return spread[0] * (1 - d * wave[0]), spread[1] * (1 - d * wave[1])


@inline
def conoid_state(rows, i, index, pupil, choices):
    """Table 2, steps 6 to 9 in one state of accommodation: wave and semi-axes in front of the lens.

    pupil: curvatures of the wave there, cosine and sine of its first direction, pupil radius. choices: roots, reading.
    """
    (k1, k2, c, s, radius), (roots, reading) = pupil, choices
    inward, outward = (vector(rows, EYE, i), vector(rows, INSIDE, i)), (vector(rows, INSIDE, i), vector(rows, SCENE, i))
    back, front = surface(rows, BACK, i), surface(rows, FRONT, i)
    e1, e2 = listing(inward[0])
    wave = k1, k2, mix(c, e1, s, e2)
    a = grown((radius, radius), wave, rows[WAYS, i])
    wave, old = refracted(transferred(wave, rows[WAYS, i]), inward, 1 / index, back, roots), wave[2]
    a = grown(conoid_refracted(a, (old, wave[2]), inward, back[0], reading), wave, rows[WAYS + 1, i])
    wave, old = refracted(transferred(wave, rows[WAYS + 1, i]), outward, index, front, roots), wave[2]
    return wave, conoid_refracted(a, (old, wave[2]), outward, front[0], reading)


@kernel
def conoid_rays(rows, index, eye, choices, columns):
    """Table 2, what is done for each ray: columns (12, n) as the voxels take them. choices: roots, reading.

    z of the origin, 1 / z of the direction, cosine and sine of the relaxed wave's e1 in the frame across the ray; of the
    relaxed and of the tense eye a1, a2, k1 a1, k2 a2.
    """
    radius, r11, r12, r22, amplitude = eye
    k1, k2, c, s = axes_of(-r11, -r22, -r12, choices[0])  # steps 2 to 5, the same for every ray
    for i in nb.prange(rows.shape[1]):
        d = vector(rows, SCENE, i)
        e1, e2 = listing(d)
        wave, a = conoid_state(rows, i, index, (k1, k2, c, s, radius), choices)
        tense, b = conoid_state(rows, i, index, (k1 + amplitude, k2 + amplitude, c, s, radius), choices)
        near = abs(dot(wave[2], tense[2])) >= abs(dot(wave[2], cross(d, tense[2])))
        b1, b2, t1, t2 = (b[0], b[1], tense[0], tense[1]) if near else (b[1], b[0], tense[1], tense[0])
        columns[0, i], columns[1, i] = rows[HEIGHT, i], 1 / d[2]
        columns[2, i], columns[3, i] = dot(wave[2], e1), dot(wave[2], e2)
        columns[4, i], columns[5, i], columns[6, i], columns[7, i] = a[0], a[1], a[0] * wave[0], a[1] * wave[1]
        columns[8, i], columns[9, i], columns[10, i], columns[11, i] = b1, b2, b1 * t1, b2 * t2


@inline
def conoid_voxel(c, i, depth):
    """Eq. 10 and 12 of one voxel: the images of the pupil's axes, 2 x 2 row by row, mm."""
    s = (depth - c[0, i]) * c[1, i]
    a1, a2 = best_mix(c[4, i] - s * c[6, i], c[5, i] - s * c[7, i], c[8, i] - s * c[10, i], c[9, i] - s * c[11, i])
    return a1 * c[2, i], -a2 * c[3, i], a1 * c[3, i], a2 * c[2, i]


@kernel
def conoid_voxels(columns, depths, out):
    """Table 2, plane by plane: n rays on k planes into out (4, k, n)."""
    for k in nb.prange(depths.size):
        for i in range(columns.shape[1]):
            m = conoid_voxel(columns, i, depths[k])
            out[0, k, i], out[1, k, i], out[2, k, i], out[3, k, i] = m[0], m[1], m[2], m[3]


@kernel
def conoid_voxels_by_ray(columns, depths, out):
    """Table 2, ray by ray into out (4, n, k)."""
    for i in nb.prange(columns.shape[1]):
        for k in range(depths.size):
            m = conoid_voxel(columns, i, depths[k])
            out[0, i, k], out[1, i, k], out[2, i, k], out[3, i, k] = m[0], m[1], m[2], m[3]
