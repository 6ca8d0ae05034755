"""connect() and connect_async()."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Generator, Optional, Sequence

from brume import messages
from brume.async_viewer import AsyncViewer
from brume.error import BrumeError
from brume.link import Link
from brume.version import VERSION
from brume.viewer import Viewer

if TYPE_CHECKING:
    import ssl

    from brume.particles import Reader


def _reader() -> Callable[[], Reader]:
    try:
        import numpy  # noqa: F401
    except ImportError:
        raise BrumeError('NumPy is missing, which particles need: install python3-numpy') from None
    from brume.particles import Reader
    return Reader


def _link(url: str, token: Optional[str], size: Sequence[int], quality: int, lossless: bool,
          tls: Optional[ssl.SSLContext], reconnect: float, keep_size: bool, draw_hz: int) -> Link:
    if draw_hz not in range(61):
        raise BrumeError(f'draw_hz is {draw_hz}: allowed are whole numbers from 0 to 60', 'out_of_range')

    def hello(resume: str) -> bytes:
        return messages.hello(size[0], size[1], f'brume-python {VERSION}', resume, quality, lossless=lossless,
                              keep_size=keep_size, draw_hz=int(draw_hz))
    return Link(url, token, tls, reconnect, hello, _reader() if draw_hz else None)


def connect(url: str = 'http://127.0.0.1:8080', token: Optional[str] = None, size: Sequence[int] = (640, 360),
            quality: int = 0, lossless: bool = False, timeout: float = 30, tls: Optional[ssl.SSLContext] = None,
            reconnect: float = 60, keep_size: bool = False, draw_hz: int = 0) -> Viewer:
    """A Viewer of the server at `url` (http, https, ws or wss).

    token: where the server wants one. size: pixels of a picture. quality: of the JPEG, 1 ... 100; 0: the server's.
    lossless: True asks for what rests once more as PNG. timeout: s that a call waits. tls: an ssl.SSLContext, for
    certificates of one's own. reconnect: s for which a lost connection is tried again, as the same viewer. keep_size:
    True asks for fewer pictures, not smaller ones, where the link or the server is slow. draw_hz: 1 ... 60 asks for at
    most so many particles() a second in place of pictures, for a program that draws or measures by itself; it needs
    NumPy.
    Raises BrumeError with the server's line if it refuses, TimeoutError if nobody answers.
    """
    link = _link(url, token, size, quality, lossless, tls, reconnect, keep_size, draw_hz)
    try:
        return Viewer(link, timeout, (size[0], size[1]), draw_hz)
    except BaseException:
        link.leave()
        link.join()
        raise


class Connecting:
    """What connect_async() gives: `async with` it, or `await` it and close() the viewer later."""

    def __init__(self, begin: Callable[[], AsyncViewer]) -> None:
        self._make = begin
        self._viewer: Optional[AsyncViewer] = None

    def __await__(self) -> Generator[Any, None, AsyncViewer]:
        return self._begin().__await__()

    async def __aenter__(self) -> AsyncViewer:
        self._viewer = await self._begin()
        return self._viewer

    async def __aexit__(self, *_: object) -> None:
        if self._viewer:
            await self._viewer.close()

    async def _begin(self) -> AsyncViewer:
        viewer = self._make()
        try:
            await viewer._do(viewer._begin())
        except BaseException:
            viewer._link.leave()
            raise
        return viewer


def connect_async(url: str = 'http://127.0.0.1:8080', token: Optional[str] = None, size: Sequence[int] = (640, 360),
                  quality: int = 0, lossless: bool = False, timeout: float = 30, tls: Optional[ssl.SSLContext] = None,
                  reconnect: float = 60, keep_size: bool = False, draw_hz: int = 0) -> Connecting:
    """An AsyncViewer: `async with brume.connect_async(...) as view`. Arguments and errors are those of connect()."""
    return Connecting(lambda: AsyncViewer(
        _link(url, token, size, quality, lossless, tls, reconnect, keep_size, draw_hz), timeout, (size[0], size[1]),
        draw_hz))
