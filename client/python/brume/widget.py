"""The widget of a notebook. Needs the package anywidget; notebook.show() makes it, or a frame without."""
from __future__ import annotations

import pathlib
from typing import Any, Optional, Sequence

import anywidget
import traitlets


def _point(help: str) -> Any:
    return traitlets.List(traitlets.Float(), minlen=3, maxlen=3, allow_none=True, default_value=None,
                          help=help).tag(sync=True)


class Widget(anywidget.AnyWidget):
    """<brume-view> of the server at `src`, in a notebook. Traits go both ways while the notebook shows it: the camera
    (`position`, `target`, `fov`) and `settings` tell what the browser has, and change it when they are set."""
    _esm = pathlib.Path(__file__).parent / 'widget.js'

    src = traitlets.Unicode(help="the server's page").tag(sync=True)
    token = traitlets.Unicode('', help='where the server wants one').tag(sync=True)
    position = _point('of the camera, m; None: the scene says')
    target = _point('what it looks at, and turns about, m')
    fov = traitlets.Float(None, allow_none=True, help='rad, the full vertical angle').tag(sync=True)
    controls = traitlets.Enum(('push', 'look', 'none'), 'push').tag(sync=True)
    draw = traitlets.Enum(('auto', 'client', 'server'), 'auto', help='who draws').tag(sync=True)
    size = traitlets.Unicode('', help='most pixels of a picture: 640x360').tag(sync=True)
    width = traitlets.Unicode('100%', help='of the widget, as CSS has it').tag(sync=True)
    height = traitlets.Unicode('360px', help='of the widget, as CSS has it').tag(sync=True)
    settings = traitlets.Dict(help='every live setting by its path; those set here change the scene').tag(sync=True)
    state = traitlets.Unicode('', help='of the connection: connecting, connected, reconnecting, refused').tag(sync=True)
    tick = traitlets.Int(0, help='of the simulation, 60 a second; told each second').tag(sync=True)
    note = traitlets.Unicode('', help='the last line for people, such as why a setting was refused').tag(sync=True)

    def look(self, position: Optional[Sequence[float]] = None, target: Optional[Sequence[float]] = None) -> None:
        """Moves the camera at once; m. What is not given stays."""
        with self.hold_sync():
            if position is not None:
                self.position = [float(one) for one in position]
            if target is not None:
                self.target = [float(one) for one in target]

    def set(self, path: str, value: Any) -> None:
        """Changes a setting of the scene, for everyone. `settings` has the value when the server reports it."""
        self.settings = {**self.settings, path: value}
