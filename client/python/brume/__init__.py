"""A viewer of a brume server: camera, pushes, settings, pictures. connect() gives one; README.md shows how."""
from brume.error import BrumeError
from brume.frame import Frame
from brume.viewer import State, Viewer, connect

__all__ = ['BrumeError', 'Frame', 'State', 'Viewer', 'connect']
__version__ = '0.1.0'
