"""A viewer of a brume server: camera, pushes, settings, pictures. connect() gives one; README.md shows how."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from brume import frame, needs

needs.check()

from brume.async_viewer import AsyncViewer  # noqa: E402
from brume.connecting import connect, connect_async  # noqa: E402
from brume.error import BrumeError  # noqa: E402
from brume.frame import Frame, Measured  # noqa: E402
from brume.layers import Layers  # noqa: E402
from brume.notebook import show  # noqa: E402
from brume.people import People, Person  # noqa: E402
from brume.state import State  # noqa: E402
from brume.version import VERSION  # noqa: E402
from brume.viewer import Viewer  # noqa: E402

if TYPE_CHECKING:
    from brume.kinds import Array

__all__ = ['AsyncViewer', 'BrumeError', 'Frame', 'Layers', 'Measured', 'People', 'Person', 'State', 'Viewer', 'connect',
           'connect_async', 'redraw', 'show']
__version__ = VERSION


def redraw(*args: Any, **options: Any) -> Array:
    """redrawing.redraw(), which needs NumPy: a frame with layers as seen from another place."""
    try:
        from brume import redrawing
    except ImportError:
        frame.needed('NumPy', 'python3-numpy')
    return redrawing.redraw(*args, **options)
