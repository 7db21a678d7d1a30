"""The two schemes of Kakimoto, Tatsukawa & Nishita 2010, "An Eyeglass Simulator Using Conoid Tracing", to measure against.

Table 1 (previous, as in their work of 2007): for each voxel a wave from the object point through the lens to the retina, by
    principal curvatures and directions (Kneisly 1964; Mitchell & Hanrahan 1992); the ellipse on the retina is scaled to
    the object.
Table 2 (conoid): for each ray a wave and the spread of light from the pupil to the front surface, relaxed and fully
    accommodated; for each voxel the spread after the way to it (eq. 9 to 11), mixed so that accommodation cancels the sum of
    the signed semi-axes (eq. 12).

We know the method from accounts of it, not from the paper's own text. What stands here for its equations is our reading:
    (9)  k' = k / (1 - d k): the curvature k of a wave (1/mm, positive: converging) after the way d, in both meridians
    (10) a' = a k / k': the spread's semi-axis a in a meridian of the wave; 0/0 for a plane wave
    (11) where the spread's axes are turned by w against the wave's: b_1 = a_1 cos^2 w + a_2 sin^2 w and so on, (10), and
         solved for a_1', a_2' in the spread's old axes: a division by cos 2w, and the turn of the axes is dropped
    (12) a = (1 - t) a_relaxed + t a_tense, t within 0 and 1 so that a_1 + a_2 = 0; on the axes of the relaxed eye
Structure of arrays, prange and fastmath as in the product's kernels. The chief rays and the surfaces' curvatures where they
pass (step 1 of both tables) are made by `chief_rays`; they are not timed, as in the paper.

Light of Table 1 runs to the eye, that of Table 2 to the scene; d0, d1: directions before and after a surface; normals along
the light; curvatures of waves and surfaces positive with the centre ahead of the light; mm.
"""

import math

import numba as nb
import numpy as np

from lensbench.optics.conventions import listing_frame
from lensbench.optics.gaze import worn_pose

FAST = {"contract", "nsz"}
inline = nb.njit(cache=True, error_model="numpy", fastmath=FAST, forceinline=True)
kernel = nb.njit(nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FAST)
ZERO, HALF, ONE = np.float32(0), np.float32(0.5), np.float32(1)  # of the width of what they meet
EYE_LENGTH = 17.0  # mm, of the reduced eye in air; it cancels

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
def refracted(k1, k2, e, d0, d1, n0, n1, met, roots):
    """The wave after a surface: curvatures and first principal direction."""
    normal, s1, s2, es = met
    p = across_plane_of_incidence(normal, d0, e)
    c0, c1, mu = dot(normal, d0), dot(normal, d1), n0 / n1
    gamma = c1 - mu * c0
    kp, kq, kpq = in_plane(k1, k2, e, p, cross(d0, p))
    sp, sq, spq = in_plane(s1, s2, es, p, cross(normal, p))
    k1, k2, c, s = axes_of(
        mu * kp + gamma * sp, (mu * kq * c0 * c0 + gamma * sq) / (c1 * c1), (mu * kpq * c0 + gamma * spq) / c1, roots
    )
    return k1, k2, mix(c, p, s, cross(d1, p))


@inline
def propagated(k, d):
    """Eq. 9."""
    return k / (ONE - d * k)


@inline
def best_mix(r1, r2, t1, t2):
    """Eq. 12: the semi-axes of the relaxed (r) and of the tense eye (t), mixed."""
    t = (r1 + r2) / (r1 + r2 - t1 - t2)
    t = t if t > ZERO else ZERO
    t = t if t < ONE else ONE
    return r1 + t * (t1 - r1), r2 + t * (t2 - r2)


# -- Table 1 -----------------------------------------------------------------------------------------------------------


@inline
def previous_voxel(rows, i, index, eye, depth, roots):
    """Steps 2 to 9 of one voxel: the images of the pupil's axes at the object, 2 x 2 row by row, mm."""
    radius, r11, r12, r22, amplitude = eye
    d2, d1, d0 = opposite(vector(rows, SCENE, i)), opposite(vector(rows, INSIDE, i)), opposite(vector(rows, EYE, i))
    normal_f, f1, f2, ef = surface(rows, FRONT, i)
    normal_b, b1, b2, eb = surface(rows, BACK, i)
    to_eye, within = rows[WAYS, i], rows[WAYS + 1, i]
    s = (rows[HEIGHT, i] - depth) / d2[2]
    k, e = -1 / s, listing(opposite(d2))[0]  # the wave from the object point
    k1, k2, e = refracted(k, k, e, d2, d1, 1.0, index, (opposite(normal_f), -f1, -f2, ef), roots)
    k1, k2 = propagated(k1, within), propagated(k2, within)
    k1, k2, e = refracted(k1, k2, e, d1, d0, index, 1.0, (opposite(normal_b), -b1, -b2, eb), roots)
    k1, k2 = propagated(k1, to_eye), propagated(k2, to_eye)
    e1, e2 = listing(opposite(d0))
    kp, kq, kpq = in_plane(k1, k2, e, e1, e2)  # refracted by the relaxed eye, whose power is 1 / length - R
    k1, k2, c, t = axes_of(kp + 1 / EYE_LENGTH - r11, kq + 1 / EYE_LENGTH - r22, kpq - r12, roots)
    a1, a2 = radius * (1 - EYE_LENGTH * k1), radius * (1 - EYE_LENGTH * k2)  # the spread on the retina
    less = radius * EYE_LENGTH * amplitude
    a1, a2 = best_mix(a1, a2, a1 - less, a2 - less)
    scale = (s + within + to_eye) / EYE_LENGTH  # from the retina to the object
    return scale * a1 * c, -scale * a2 * t, scale * a1 * t, scale * a2 * c


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
def spread(a1, a2, c, s, k1, k2, d):
    """Eq. 10 and 11: semi-axes after the way d; c, s: cosine and sine of the wave's first axis against the spread's."""
    cc, ss = c * c, s * s
    b1 = (a1 * cc + a2 * ss) * (k1 / propagated(k1, d))
    b2 = (a1 * ss + a2 * cc) * (k2 / propagated(k2, d))
    k = ONE / (cc - ss)
    return (b1 * cc - b2 * ss) * k, (b2 * cc - b1 * ss) * k


@inline
def spread_refracted(a1, a2, f, d0, d1, normal, roots):
    """Semi-axes and first axis of the spread after a surface, on which its footprint is kept."""
    p = across_plane_of_incidence(normal, d0, f)
    ratio = dot(normal, d1) / dot(normal, d0)
    c, s = dot(f, p), dot(f, cross(d0, p))
    xx, xy, yx, yy = a1 * c, -a2 * s, ratio * a1 * s, ratio * a2 * c
    b1, b2, c, s = axes_of(xx * xx + xy * xy, yx * yx + yy * yy, xx * yx + xy * yy, roots)
    return math.sqrt(b1), math.sqrt(b2), mix(c, p, s, cross(d1, p))


@inline
def wave_and_spread(rows, i, index, eye, accommodation, roots):
    """A state of accommodation from the pupil to the scene: curvatures, semi-axes and first axes of wave and spread."""
    radius, r11, r12, r22, _ = eye
    d0, d1, d2 = vector(rows, EYE, i), vector(rows, INSIDE, i), vector(rows, SCENE, i)
    back, front = surface(rows, BACK, i), surface(rows, FRONT, i)
    to_back, within = rows[WAYS, i], rows[WAYS + 1, i]
    e1, e2 = listing(d0)
    k1, k2, c, s = axes_of(accommodation - r11, accommodation - r22, -r12, roots)
    e = f = mix(c, e1, s, e2)
    a1, a2 = spread(radius, radius, 1.0, 0.0, k1, k2, to_back)
    k1, k2, e = refracted(propagated(k1, to_back), propagated(k2, to_back), e, d0, d1, 1.0, index, back, roots)
    a1, a2, f = spread_refracted(a1, a2, f, d0, d1, back[0], roots)
    a1, a2 = spread(a1, a2, dot(e, f), dot(e, cross(d1, f)), k1, k2, within)
    k1, k2, e = refracted(propagated(k1, within), propagated(k2, within), e, d1, d2, index, 1.0, front, roots)
    a1, a2, f = spread_refracted(a1, a2, f, d1, d2, front[0], roots)
    return k1, k2, a1, a2, e, f


@kernel
def conoid_rays(rows, index, eye, roots, columns):
    """Table 2, what is done for each ray: columns (16, n) as the voxels take them.

    z of the origin, 1 / z of the direction, cosine and sine of the relaxed spread's first axis in the frame across the ray;
    of the relaxed and of the tense eye k1, k2, a1, a2, cosine and sine of the wave's axis against the spread's.
    """
    for i in nb.prange(rows.shape[1]):
        d = vector(rows, SCENE, i)
        e1, e2 = listing(d)
        k1, k2, a1, a2, e, f = wave_and_spread(rows, i, index, eye, 0.0, roots)
        columns[0, i], columns[1, i], columns[2, i], columns[3, i] = rows[HEIGHT, i], 1 / d[2], dot(f, e1), dot(f, e2)
        columns[4, i], columns[5, i], columns[6, i], columns[7, i] = k1, k2, a1, a2
        columns[8, i], columns[9, i] = dot(e, f), dot(e, cross(d, f))
        k1, k2, a1, a2, e, f = wave_and_spread(rows, i, index, eye, eye[4], roots)
        columns[10, i], columns[11, i], columns[12, i], columns[13, i] = k1, k2, a1, a2
        columns[14, i], columns[15, i] = dot(e, f), dot(e, cross(d, f))


@inline
def conoid_voxel(c, i, depth):
    """Eq. 9 to 12 of one voxel: the images of the pupil's axes, 2 x 2 row by row, mm."""
    s = (depth - c[0, i]) * c[1, i]
    r1, r2 = spread(c[6, i], c[7, i], c[8, i], c[9, i], c[4, i], c[5, i], s)
    t1, t2 = spread(c[12, i], c[13, i], c[14, i], c[15, i], c[10, i], c[11, i], s)
    a1, a2 = best_mix(r1, r2, t1, t2)
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
