"""A viewer in a notebook: show() gives a widget where the package anywidget is there, else a frame of a page."""
from __future__ import annotations

import html
import urllib.parse
from typing import Any, Dict, Optional, Sequence, Union

from brume.address import page_address
from brume.core import Core
from brume.error import BrumeError

CONTROLS = ('push', 'look', 'none')
Length = Union[int, str]  # pixels, or as CSS has it


def _css(length: Length) -> str:
    return f'{length}px' if isinstance(length, int) else length


def _point(name: str, value: Optional[Sequence[float]]) -> Optional[Sequence[float]]:
    if value is None:
        return None
    if len(value) != 3:
        raise BrumeError(f'{name} has {len(value)} numbers: allowed are three, in m', 'out_of_range')
    return [float(one) for one in value]


class Embedded:
    """The view alone in a frame, which a notebook shows by its `_repr_html_`. Camera and settings go one way: the frame
    begins with these."""

    def __init__(self, src: str, token: str = '', position: Optional[Sequence[float]] = None,
                 target: Optional[Sequence[float]] = None, fov: Optional[float] = None, controls: str = 'push',
                 size: str = '', draw: str = 'auto', width: str = '100%', height: str = '360px') -> None:
        wishes: Dict[str, str] = {name: ','.join(f'{one:g}' for one in point)
                                  for name, point in (('position', position), ('target', target)) if point is not None}
        if fov is not None:
            wishes['fov'] = f'{fov:g}'
        wishes.update({name: text for name, text in (('controls', controls), ('size', size), ('draw', draw)) if text})
        self.url = page_address(src, f'embed.html?{urllib.parse.urlencode(wishes, safe=",")}')
        if token:
            self.url += f'#token={urllib.parse.quote(token)}'
        self.width, self.height = width, height

    def _repr_html_(self) -> str:
        return (f'<iframe src="{html.escape(self.url)}" style="width: {html.escape(self.width)}; '
                f'height: {html.escape(self.height)}; border: 0" title="A cloud" allow="fullscreen"></iframe>')


def show(source: Union[Core, str] = 'http://127.0.0.1:8080', token: Optional[str] = None,
         position: Optional[Sequence[float]] = None, target: Optional[Sequence[float]] = None,
         fov: Optional[float] = None, controls: str = 'push', size: Optional[Sequence[int]] = None, draw: str = 'auto',
         width: Length = '100%', height: Length = 360) -> Any:
    """A viewer to look at in a notebook: a widget.Widget with the package anywidget, else an Embedded. The browser
    connects by itself, and the server must allow the notebook's page: --allow-origin http://localhost:8888, say.

    source: a server's address, or a viewer, whose server and token are taken. position, target: m. fov: rad. controls:
    'push' (camera and pushes), 'look' (the camera) or 'none'. size: most pixels of a picture. draw: who draws, 'auto',
    'client' or 'server'. width, height: pixels, or a CSS length. A token is kept in the notebook's output.
    """
    if isinstance(source, Core):
        token = token or source._link.token
        source = source.address
    if controls not in CONTROLS:
        raise BrumeError(f'no controls {controls!r}; there are {" ".join(CONTROLS)}', 'out_of_range')
    wishes: Dict[str, Any] = dict(
        src=page_address(source), token=token or '', position=_point('position', position),
        target=_point('target', target), fov=fov, controls=controls, draw=draw, width=_css(width), height=_css(height),
        size=f'{int(size[0])}x{int(size[1])}' if size else '')
    try:
        from brume.widget import Widget
    except ImportError:
        return Embedded(**wishes)
    return Widget(**wishes)
