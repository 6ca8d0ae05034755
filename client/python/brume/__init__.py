"""A viewer of a brume server: camera, pushes, settings, pictures. connect() gives one; README.md shows how."""
from brume import frame, needs

needs.check()

from brume.error import BrumeError  # noqa: E402
from brume.frame import Frame, Measured  # noqa: E402
from brume.layers import Layers  # noqa: E402
from brume.viewer import State, Viewer, connect  # noqa: E402

__all__ = ['BrumeError', 'Frame', 'Layers', 'Measured', 'State', 'Viewer', 'connect', 'redraw']
__version__ = '0.1.0'


def redraw(*args, **options):
    """redrawing.redraw(), which needs NumPy: a frame with layers as seen from another place."""
    try:
        from brume import redrawing
    except ImportError:
        frame.needed('NumPy', 'python3-numpy')
    return redrawing.redraw(*args, **options)
