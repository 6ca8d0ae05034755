"""A viewer of a brume server: camera, pushes, settings, pictures. connect() gives one; README.md shows how."""
from brume import needs

needs.check()

from brume.error import BrumeError  # noqa: E402
from brume.frame import Frame, Measured  # noqa: E402
from brume.viewer import State, Viewer, connect  # noqa: E402

__all__ = ['BrumeError', 'Frame', 'Measured', 'State', 'Viewer', 'connect']
__version__ = '0.1.0'
