"""redraw(): a frame as it would be from another place, from its layers with depth. How: protocol/README.md, Layers with
depth. Whole arrays at once: clear, not fast."""
from __future__ import annotations

import math
from typing import List, Optional, Sequence, Tuple

import numpy

from brume.error import BrumeError
from brume.frame import Frame
from brume.kinds import Array
from brume.camera import look_at

SMOOTH = 8  # pixels, over which what is behind the layers is a mean at least
TOLD = 2  # weight of such a mean, over its squared transmittance
LEAST_SEEN = 0.3  # transmittance below which what is behind the layers is not told from the picture
LEAST_LIGHT = 1e-4  # exposed light of all layers below which they get no details
MEETS = 2  # steps by which a ray finds a layer
PLACES = 96  # of a ray that are compared with surfaces


def redraw(frame: Frame, position: Optional[Sequence[float]] = None, target: Optional[Sequence[float]] = None,
           orientation: Optional[Sequence[float]] = None, fov: Optional[float] = None,
           size: Optional[Tuple[int, int]] = None, eye: int = 0) -> Array:
    """What `frame` shows, as seen from `position` (m) toward `target` or by `orientation` (as in Viewer.look); what is
    left out is the frame's own. size: (width, height). Returns height x width x 3 bytes, sRGB."""
    if not frame.layers:
        raise BrumeError('this frame has no layers: ask for them by look(layers=4), and wait for one that has some')
    position = frame.position if position is None else position
    if target is not None:
        orientation = look_at(position, target)
    width, height = size or (frame.width, frame.height)
    turn: Array = _axes(orientation or frame.orientation).T @ _axes(frame.orientation)
    rays: Array = _rays(fov or frame.fov, width, height) @ turn
    rays[..., 2] *= -1  # right, up and depth of the frame's own view
    origin = (numpy.subtract(position, frame.position) @ _axes(frame.orientation)) * (1, 1, -1)
    return _Picture(frame, eye).seen(origin, rays)


def _rays(fov: float, width: int, height: int) -> Array:
    up = math.tan(fov / 2)
    right = up * width / height
    x, y = numpy.meshgrid((numpy.arange(width) + 0.5) / width, (numpy.arange(height) + 0.5) / height)
    return numpy.stack([right * (2 * x - 1), up * (1 - 2 * y), -numpy.ones_like(x)], axis=-1)


def _axes(q: Sequence[float]) -> Array:
    x, y, z, w = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def _linear(srgb: Array, filmic: bool) -> Array:
    x: Array = numpy.asarray(srgb) / 255.0
    x = numpy.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)
    if not filmic:
        return x
    y = numpy.minimum(x, 0.999)  # y = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), Narkowicz's curve
    a, b, c = 2.51 - 2.43 * y, 0.03 - 0.59 * y, -0.14 * y
    linear: Array = (-b + numpy.sqrt(numpy.maximum(b * b - 4 * a * c, 0))) / (2 * a)
    return linear


def _displayed(x: Array, filmic: bool) -> Array:
    x = numpy.maximum(x, 0)
    if filmic:
        x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
    x = numpy.clip(x, 0, 1)
    x = numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    shown: Array = numpy.rint(255 * x).astype(numpy.uint8)
    return shown


def _at(values: Array, x: Array, y: Array) -> Array:
    """values (rows x columns x ...) between their places, whose middles are whole numbers; linear."""
    rows, columns = values.shape[:2]
    x, y = numpy.clip(x, 0, columns - 1), numpy.clip(y, 0, rows - 1)
    i, j = numpy.minimum(x.astype(int), max(columns - 2, 0)), numpy.minimum(y.astype(int), max(rows - 2, 0))
    u, v = x - i, y - j
    if values.ndim > 2:
        u, v = u[..., None], v[..., None]
    i1, j1 = numpy.minimum(i + 1, columns - 1), numpy.minimum(j + 1, rows - 1)
    between: Array = ((1 - v) * ((1 - u) * values[j, i] + u * values[j, i1]) +
                      v * ((1 - u) * values[j1, i] + u * values[j1, i1]))
    return between


def _taps(places: Array, count: int) -> Array:
    """A matrix from `count` nodes to places between them: cubic, through the nodes (Catmull-Rom)."""
    low = numpy.floor(places).astype(int)
    t = places - low
    weights = (-t + 2 * t ** 2 - t ** 3, 2 - 5 * t ** 2 + 3 * t ** 3, t + 4 * t ** 2 - 3 * t ** 3, t ** 3 - t ** 2)
    out = numpy.zeros((len(places), count))
    for off, weight in zip((-1, 0, 1, 2), weights):
        numpy.add.at(out, (numpy.arange(len(places)), numpy.clip(low + off, 0, count - 1)), 0.5 * weight)
    return out


class _Picture:
    """A frame, taken apart: what each layer sends at each pixel, and what is behind all of them."""

    def __init__(self, frame: Frame, eye: int) -> None:
        assert frame.layers  # redraw() has looked
        self.told = told = frame.layers[eye]
        self.width, self.height = frame.width, frame.height
        self.up = math.tan(frame.fov / 2)
        self.right = self.up * frame.width / frame.height
        self.surface = told.surface()
        light = _linear(frame.array(eye), told.filmic)
        self.layers: List[Tuple[Array, Array]] = []
        self.depths: List[Array] = []
        sky: Optional[Array] = None
        if told.count:
            colours, through = _linear(told.colours(), told.filmic), told.transmittance()
            across, down = (_taps((numpy.arange(pixels) + 0.5 - told.first) / told.spacing, nodes)
                            for pixels, nodes in ((self.width, told.columns), (self.height, told.rows)))

            def everywhere(nodes: Array) -> Array:
                values: Array = numpy.einsum('yj,jic,xi->yxc', down, nodes, across, optimize=True)
                return values
            self.layers = [(numpy.maximum(everywhere(colours[k]), 0), everywhere(through[k, ..., None]).clip(0, 1))
                           for k in range(told.count)]
            self.depths = list(told.depth())
            if self.surface is None:
                sky = everywhere(colours[told.count])
        sent, left = numpy.zeros_like(light), numpy.ones_like(light[..., :1])
        for colour, through in self.layers:
            sent, left = sent + left * colour, left * through
        rest = light - sent
        behind = self._smooth(rest, left) if sky is None else sky
        # Details belong to what is bright enough to have them.
        details = rest - left * behind
        part = 1 if sky is not None else sent / numpy.maximum(sent + numpy.maximum(left * behind, 0), LEAST_LIGHT)
        factor = numpy.clip(1 + part * details / numpy.maximum(sent, LEAST_LIGHT), 0.25, 4)
        self.layers = [(colour * factor, through) for colour, through in self.layers]
        self.behind = behind + (details - (factor - 1) * sent) / numpy.maximum(left, LEAST_SEEN)

    def _smooth(self, rest: Array, left: Array) -> Array:
        """rest / left over squares of SMOOTH pixels and more, from farther around where little is let through."""
        out, unmet = numpy.zeros_like(rest), numpy.ones_like(left)
        sums, side = numpy.concatenate([rest * left, left * left], axis=-1), 1
        while True:
            last = max(sums.shape[:2]) == 1
            if side >= SMOOTH or last:
                y, x = numpy.indices((self.height, self.width))
                mean = _at(sums, (x + 0.5) / side - 0.5, (y + 0.5) / side - 0.5)
                part = unmet if last else unmet * numpy.minimum(TOLD * mean[..., 3:], 1)
                out += part * mean[..., :3] / numpy.maximum(mean[..., 3:], 1e-6)
                unmet = unmet - part
            if last:
                return out
            sums = numpy.pad(sums, [(0, n % 2) for n in sums.shape[:2]] + [(0, 0)], mode='edge')
            sums = 0.25 * (sums[::2, ::2] + sums[1::2, ::2] + sums[::2, 1::2] + sums[1::2, 1::2])
            side *= 2

    def _pixel(self, point: Array) -> Tuple[Array, Array]:
        """x and y of the pixel (a place in pixels) that shows a point."""
        z = numpy.maximum(point[..., 2], 1e-6)
        return ((self.right + point[..., 0] / z) / (2 * self.right) * self.width,
                (self.up - point[..., 1] / z) / (2 * self.up) * self.height)

    def _surface_at(self, surface: Array, x: Array, y: Array) -> Array:
        row, column = numpy.clip(y, 0, self.height - 1).astype(int), numpy.clip(x, 0, self.width - 1).astype(int)
        depths: Array = surface[row, column]
        return depths

    def _meet_surface(self, origin: Array, rays: Array) -> Tuple[Array, Array, Array]:
        """Where each ray meets the nearest surface: its pixel, and its depth."""
        x, y = self._pixel(rays)  # of what is infinitely far
        depth = numpy.full(x.shape, numpy.inf)
        if self.surface is None or not numpy.isfinite(self.surface).any():
            return x, y, depth
        open_ = numpy.ones(x.shape, bool)
        for inverse in numpy.linspace(1 / self.surface.min(), 0, PLACES):
            px, py = self._pixel(origin * inverse + rays * (1 - origin[2] * inverse))
            there = self._surface_at(self.surface, px, py)
            is_surface = numpy.isfinite(there)
            met = open_ & is_surface & (inverse * numpy.where(is_surface, there, 0) <= 1)
            x, y, depth = numpy.where(met, px, x), numpy.where(met, py, y), numpy.where(met, there, depth)
            open_ &= ~met
        return x, y, depth

    def seen(self, origin: Array, rays: Array) -> Array:
        forward = rays[..., 2] > 1e-3
        rays = rays / numpy.where(forward, rays[..., 2], 1)[..., None]  # depth 1
        x, y, surface = self._meet_surface(origin, rays)
        light, left = numpy.zeros(rays.shape), numpy.ones((*rays.shape[:2], 1))
        for (colour, through), depths in zip(self.layers, self.depths):
            px, py = self._pixel(rays)
            for _ in range(MEETS):
                node = ((at - self.told.first) / self.told.spacing for at in (px, py))
                depth = _at(depths, *node)
                px, py = self._pixel(origin + rays * (depth - origin[2])[..., None])
            shows = (depth <= surface)[..., None]
            light += numpy.where(shows, left * _at(colour, px - 0.5, py - 0.5), 0)
            left = numpy.where(shows, left * _at(through, px - 0.5, py - 0.5), left)
        light += left * _at(self.behind, x - 0.5, y - 0.5)
        return _displayed(numpy.where(forward[..., None], light, 0), self.told.filmic)
