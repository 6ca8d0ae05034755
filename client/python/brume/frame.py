"""One picture, with what the server says about it."""
import io
from dataclasses import dataclass, field

from brume.error import BrumeError


def needed(module, package):
    raise BrumeError(f'{module} is missing: install {package}, or use the bytes (Frame.jpeg, Frame.save)')


def array_of(data, mode):
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
    position: tuple  # m
    orientation: tuple  # world from view, a unit quaternion x, y, z, w
    fov: float  # rad, the full vertical angle
    width: int  # pixels of one eye
    height: int
    quality: int  # of the JPEG
    lossless: bool  # True: the bytes are PNG, not JPEG
    measured: Measured  # None: the server does not know, or does not say
    pictures: tuple = field(repr=False)  # bytes of each eye's picture
    layers: tuple = field(default=None, repr=False)  # Layers of each eye's picture; None: none came

    @property
    def jpeg(self):
        """The bytes of the one or left picture; PNG where `lossless` is True."""
        return self.pictures[0]

    def save(self, path, eye=0):
        """Writes the bytes as they came, JPEG or PNG; as the other kind where the path ends so."""
        data = self.pictures[eye]
        is_png = data.startswith(b'\x89PNG')
        if str(path).lower().endswith(('.jpg', '.jpeg') if is_png else '.png'):
            self.image(eye).save(path)
            return
        with open(path, 'wb') as file:
            file.write(data)

    def image(self, eye=0):
        """The picture as a PIL image."""
        try:
            from PIL import Image
        except ImportError:
            needed('PIL', 'python3-pil (Pillow)')
        return Image.open(io.BytesIO(self.pictures[eye])).convert('RGB')

    def array(self, eye=0):
        """The picture as a NumPy array: height x width x 3 bytes, sRGB."""
        return array_of(self.pictures[eye], 'RGB')
