"""One picture, with what the server says about it."""
from __future__ import annotations

import io
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn, Optional, Tuple, Union

from brume.error import BrumeError
from brume.kinds import Quat, Vec3

if TYPE_CHECKING:
    from brume.kinds import Array
    from brume.layers import Layers

PNG = b'\x89PNG'


def needed(module: str, package: str) -> NoReturn:
    raise BrumeError(f'{module} is missing: install {package}, or use the bytes (Frame.jpeg, Frame.save)')


def array_of(data: bytes, mode: str) -> Array:
    """A coded picture as a NumPy array; mode: PIL's, RGB or L (grey)."""
    try:
        from PIL import Image
    except ImportError:
        needed('PIL', 'python3-pil (Pillow)')
    try:
        import numpy
    except ImportError:
        needed('NumPy', 'python3-numpy')
    return numpy.asarray(Image.open(io.BytesIO(data)).convert(mode))


@dataclass(frozen=True)
class Measured:
    """The error of this viewer's pictures of the last half minute: relative RMSE, with its bounds of 95 %."""
    error: float
    low: float
    high: float


@dataclass(frozen=True)
class Frame:
    id: int  # counts the frames of one connection, from 1
    tick: int  # of the simulation, 60 a second
    hash: str  # of the simulation's state: equal for all viewers at equal ticks
    pose: int  # number of the camera that it shows
    position: Vec3  # m
    orientation: Quat  # world from view, a unit quaternion x, y, z, w
    fov: float  # rad, the full vertical angle
    width: int  # pixels of one eye
    height: int
    quality: int  # of the JPEG
    lossless: bool  # True: the bytes are PNG, not JPEG
    measured: Optional[Measured]  # None: the server does not know, or does not say
    pictures: Tuple[bytes, ...] = field(repr=False)  # bytes of each eye's picture
    follows: int = 0  # id of the person whose camera it is, with the size of their pictures; 0: the viewer's own
    layers: Optional[Tuple[Layers, ...]] = field(default=None, repr=False)  # of each eye's picture; None: none came

    @property
    def jpeg(self) -> bytes:
        """The bytes of the one or left picture; PNG where `lossless` is True."""
        return self.pictures[0]

    def save(self, path: Union[str, os.PathLike[str]], eye: int = 0) -> None:
        """Writes the bytes as they came, JPEG or PNG; as the other kind where the path ends so."""
        data = self.pictures[eye]
        is_png = data.startswith(PNG)
        if str(path).lower().endswith(('.jpg', '.jpeg') if is_png else '.png'):
            self.image(eye).save(path)
            return
        with open(path, 'wb') as file:
            file.write(data)

    def image(self, eye: int = 0) -> Any:
        """The picture as a PIL.Image.Image."""
        try:
            from PIL import Image
        except ImportError:
            needed('PIL', 'python3-pil (Pillow)')
        return Image.open(io.BytesIO(self.pictures[eye])).convert('RGB')

    def array(self, eye: int = 0) -> Array:
        """The picture as a NumPy array: height x width x 3 bytes, sRGB."""
        return array_of(self.pictures[eye], 'RGB')

    # ---- what a notebook shows of it ----

    def _repr_jpeg_(self) -> Optional[bytes]:
        return None if self.jpeg.startswith(PNG) else self.jpeg

    def _repr_png_(self) -> Optional[bytes]:
        return self.jpeg if self.jpeg.startswith(PNG) else None
