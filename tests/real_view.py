"""The view by real rays, pixel by pixel: the eye turns to each pixel, and the scene is averaged over rays through its pupil."""

import numpy as np

from lensbench.optics.conventions import listing_frame, unit
from lensbench.optics.gaze import trace, trace_rays

LIGHT = np.where(np.arange(256) <= 10, np.arange(256) / 255 / 12.92, ((np.arange(256) / 255 + 0.055) / 1.055) ** 2.4)


def disc(count):
    """Points (count, 2) spread evenly over the unit disc, mean 0."""
    k = np.arange(count)
    turn = np.sqrt((k + 0.5) / count) * np.exp(1j * k * np.pi * (3 - np.sqrt(5)))
    turn = turn - turn.mean()
    return np.stack([turn.real, turn.imag], axis=-1)


def pixel_gazes(layer, pixels):
    """Gazes (n, 3), wear frame of a straight head, to picture places (n, 2): x to the right, y down, in pixels."""
    width, height = layer.size
    tangent = (np.array([width, height]) / 2 - pixels) * 2 * np.tan(layer.half_width) / width
    azimuth, elevation = layer.azimuth, layer.elevation
    ahead = [np.sin(azimuth) * np.cos(elevation), np.sin(elevation), np.cos(azimuth) * np.cos(elevation)]
    return unit(np.column_stack([tangent, np.ones(len(tangent))]) @ listing_frame(ahead))


def rays(lens, wearer, gaze, point, vergence):
    """Real rays (origin, direction) (n, 3) that leave the pupil's point (2,) of eyes turned to gaze (n, 3).

    vergence (n, 2, 2), D: of the accommodating eye; its point x of the pupil sends out the slope S x.
    """
    offset = wearer.eye.pupil_diameter / 2 * np.broadcast_to(point, (len(gaze), 2))
    slope = np.einsum("nij,nj->ni", vergence / 1000, offset)
    across = listing_frame(gaze)[:, :2]
    start = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * gaze + np.einsum("ni,nij->nj", offset, across)
    direction = unit(gaze + np.einsum("ni,nij->nj", slope, across))
    if lens is None:
        return start, direction
    out = trace_rays(lens, wearer.wear, start, direction)
    return out.exit, out.direction


def picture_light(lens, wearer, layer, pixels, shade, count, meet=None):
    """Mean light (n, 3) at picture places (n, 2) over `count` points of the pupil and as many places within each pixel.

    shade(origin, direction) -> light (n, 3). meet(origin, direction) -> distances, for an eye that accommodates.
    """
    total = 0.0
    chance = np.random.default_rng(8)
    vergence = np.broadcast_to(wearer.eye.pupil_refraction, (len(pixels), 2, 2))
    for point in disc(count):
        gaze = pixel_gazes(layer, pixels + chance.uniform(-0.5, 0.5, pixels.shape))
        if meet is not None:
            field = trace(lens, wearer, gaze, within_outline=False)
            distance = np.nan_to_num(meet(field.origin, field.direction), nan=1e5, posinf=1e5)
            vergence = field.vergence(distance, layer.accommodation)
        total = total + shade(*rays(lens, wearer, gaze, point, vergence))
    return total / count


def squares(places, half_widths):
    """Shader of white squares in the dark, facing -z: one for each ray, at places (n, 3), of half widths (n,)."""

    def shade(origin, direction):
        at = origin + ((places[:, 2] - origin[:, 2]) / direction[:, 2])[:, None] * direction
        lit = (np.abs(at - places)[:, :2] <= half_widths[:, None]).all(axis=1)
        return np.repeat(lit[:, None], 3, axis=1).astype(float)

    return shade


def point_spread(lens, wearer, layer, places, start, count):
    """Where points of the scene at places (k, 3) appear: pixels (k, count, 2), one for each point of the pupil, and weights.

    Each is the picture place whose own real ray through that point of the pupil meets the scene's point, found by Newton's
    method from start (k, 2); its weight is the picture's area for an area of the scene. The eye does not accommodate.
    """
    points = np.tile(disc(count), (len(places), 1))
    target, pixels = np.repeat(places, count, axis=0), np.repeat(start, count, axis=0)
    vergence = np.broadcast_to(wearer.eye.pupil_refraction, (len(pixels), 2, 2))

    def landing(at):
        origin, direction = rays(lens, wearer, pixel_gazes(layer, at), points, vergence)
        return (origin + ((target - origin)[:, 2] / direction[:, 2])[:, None] * direction)[:, :2]

    for _ in range(8):
        change = np.stack([landing(pixels + e) - landing(pixels - e) for e in np.eye(2) / 20], axis=-1) * 10
        miss = landing(pixels) - target[:, :2]
        pixels = pixels - np.linalg.solve(change, miss[..., None])[..., 0]
    shape = (len(places), count)
    return pixels.reshape(*shape, 2), 1 / np.abs(np.linalg.det(change)).reshape(shape)


class TexturedScene:
    """A scene for `picture_light`: what rays meet, by Embree, with its textures."""

    def __init__(self, scene):
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self.scene, self.embree = scene, EmbreeScene()
        for part in scene.drawn:
            TriangleMesh(self.embree, part.points.astype(np.float32), part.triangles.astype(np.int32))

    def _hit(self, origin, direction):
        return self.embree.run(origin.astype(np.float32), direction.astype(np.float32), output=1)

    def meet(self, origin, direction):
        hit = self._hit(origin, direction)
        return np.where(hit["primID"] >= 0, hit["tfar"], np.inf)

    def shade(self, origin, direction):
        hit = self._hit(origin, direction)
        codes = np.tile(np.array(self.scene.background, dtype=float), (len(origin), 1))
        for k, part in enumerate(self.scene.drawn):
            met = (hit["geomID"] == k) & (hit["primID"] >= 0)
            corners = part.uv[part.triangles[hit["primID"][met]]]
            u, v = hit["u"][met, None], hit["v"][met, None]
            codes[met] = texel(part.image, (1 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2])
        return np.interp(codes, np.arange(256), LIGHT)


def texel(image, uv):
    """The image's codes (n, 3) at uv (n, 2), interpolated between the four nearest."""
    height, width = image.shape[:2]
    x, y = uv[:, 0] * width - 0.5, (1 - uv[:, 1]) * height - 0.5
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    f, g = (x - column)[:, None], (y - row)[:, None]
    at = lambda j, i: image[np.clip(row + j, 0, height - 1), np.clip(column + i, 0, width - 1)].astype(float)  # noqa: E731
    return (1 - g) * ((1 - f) * at(0, 0) + f * at(0, 1)) + g * ((1 - f) * at(1, 0) + f * at(1, 1))


def psnr(one, other):
    """Peak signal-to-noise ratio, dB, of pictures of sRGB codes."""
    return float(10 * np.log10(255**2 / np.mean((one.astype(float) - other) ** 2)))
