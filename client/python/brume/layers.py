"""Layers with depth of one picture, from which redraw() draws it as seen from elsewhere."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Optional, Tuple

from brume.frame import array_of

if TYPE_CHECKING:
    from brume.kinds import Array

SKY = 255  # byte of the surfaces' picture


@dataclass(frozen=True)
class Layers:
    count: int  # of the medium's, near to far; 0: the way of rendering, the medium or the scene has none
    columns: int  # nodes of a layer
    rows: int
    block_rows: int  # rows of a layer in the pictures
    spacing: float  # pixels between nodes
    first: float  # pixels from the picture's upper left corner to the first node, each way
    near: float  # m, depth of byte 0 of the layers ...
    far: float  # ... and of byte 255
    exposure: float  # that radiance was multiplied by
    filmic: bool  # True: and tone mapped after
    near_surface: float  # m, depth of byte 1 of the surfaces ...
    far_surface: float  # ... and of byte 254
    pictures: Tuple[bytes, ...] = field(repr=False)  # bytes of three: colours, data, surfaces; empty: there is none

    def colours(self) -> Array:
        """What each layer sends with nothing in front: layers x rows x columns x 3 bytes, sRGB. Without surfaces
        there is one more: the sky behind them."""
        return self._nodes(array_of(self.pictures[0], 'RGB'))

    def transmittance(self) -> Array:
        """Of each layer: layers x rows x columns, 0 ... 1."""
        return self._nodes(self._data()[0]) / 255

    def depth(self) -> Array:
        """Mean view depths of what each layer holds: layers x rows x columns, m."""
        return self.near * (self.far / self.near) ** (self._nodes(self._data()[1]) / 255)

    def surface(self) -> Optional[Array]:
        """View depths of surfaces: height x width of the picture, m, infinite for the sky. None: nothing but sky."""
        if not self.pictures[2]:
            return None
        data = array_of(self.pictures[2], 'L').astype(float)
        depth = self.near_surface * (self.far_surface / self.near_surface) ** (((data - 1) / 253).clip(0))
        depth[data == SKY] = float('inf')
        return depth

    def _data(self) -> Array:
        return array_of(self.pictures[1], 'L').reshape(2, self.count * self.block_rows, self.columns)

    def _nodes(self, picture: Array) -> Array:
        blocks = picture.reshape(-1, self.block_rows, *picture.shape[1:])
        return blocks[:, :self.rows, :self.columns]
