"""The same for programs with an event loop: what waits is awaited, and other tasks run meanwhile."""
from __future__ import annotations

import asyncio
import os
from typing import TYPE_CHECKING, Any, AsyncIterator, Dict, Optional, Sequence, Union

from brume import messages
from brume.beside import ask
from brume.core import LOADED, Core, bundle
from brume.frame import Frame
from brume.kinds import Numbers, Points, Size, Value, Values
from brume.steps import Steps, T, run_async
from brume.viewer import cloud_of

if TYPE_CHECKING:
    from brume.particles import Particles


class AsyncViewer(Core):
    """One viewer of the scene. connect_async() makes it. Its calls are those of Viewer, with the same arguments and
    errors; look() and the properties need no `await`, as they do not wait. A task that is cancelled waits no longer; a
    command that it has sent is not taken back."""

    async def _do(self, steps: Steps[T]) -> T:
        return await run_async(self._link, steps)

    async def close(self) -> None:
        """Says goodbye. Calls that wait, in whatever task, raise BrumeError, and so do later ones."""
        self._link.leave()
        await asyncio.get_running_loop().run_in_executor(None, self._link.join)

    async def __aenter__(self) -> AsyncViewer:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    # ---- pictures and particles ----

    async def frame(self, after: Optional[int] = None, timeout: Optional[float] = None) -> Frame:
        """As Viewer.frame()."""
        return await self._do(self._frame(after, timeout))

    async def frames(self, count: Optional[int] = None, timeout: Optional[float] = None) -> AsyncIterator[Frame]:
        """As Viewer.frames(), for `async for`."""
        while count is None or count > 0:
            yield await self.frame(timeout=timeout)
            count = None if count is None else count - 1

    def _repr_mimebundle_(self, **_: Any) -> Dict[str, str]:
        """What a notebook shows: the newest picture that has come, as nothing can be awaited here."""
        frame = self._link.frame or self._last
        return bundle(frame) if frame else {'text/plain': f'{self!r}; it shows pictures after frame()'}

    async def particles(self, after: Optional[int] = None, timeout: Optional[float] = None) -> Particles:
        """As Viewer.particles()."""
        return await self._do(self._particles(after, timeout))

    async def particle_stream(self, count: Optional[int] = None,
                              timeout: Optional[float] = None) -> AsyncIterator[Particles]:
        """As Viewer.particle_stream(), for `async for`."""
        while count is None or count > 0:
            yield await self.particles(timeout=timeout)
            count = None if count is None else count - 1

    # ---- commands: they change the scene for everyone ----

    async def push(self, origin: Sequence[float], direction: Sequence[float], strength: float = 1.0,
                   push: Optional[Sequence[float]] = None) -> None:
        """As Viewer.push(); m, m/s."""
        await self._do(self._push(origin, direction, strength, push))

    async def move(self, offset: Sequence[float]) -> None:
        """Moves the medium, in m."""
        await self._do(self._link.order([messages.move(offset)], self._timeout))

    async def set(self, path: str, value: Value) -> None:
        """As Viewer.set()."""
        await self.set_all({path: value})

    async def set_all(self, values: Values) -> None:
        """As Viewer.set_all()."""
        await self._do(self._set_all(values))

    async def add(self, name: str, **values: Value) -> None:
        """As Viewer.add()."""
        await self._do(self._resize(name, messages.add(name, values)))

    async def remove(self, name: str, number: int) -> None:
        """As Viewer.remove()."""
        await self._do(self._resize(name, messages.remove(f'{name}[{number}]')))

    async def pause(self, paused: bool = True) -> None:
        """As Viewer.pause()."""
        await self.set('simulation.paused', paused)

    async def resume(self) -> None:
        """Lets the scene go on."""
        await self.pause(False)

    async def restart(self) -> None:
        """Starts the scene again."""
        await self._do(self._link.order([messages.restart()], self._timeout))

    async def undo(self) -> None:
        """As Viewer.undo()."""
        await self._do(self._undo())

    async def present(self, on: bool = True) -> None:
        """As Viewer.present()."""
        await self._do(self._present(on))

    async def snapshot(self, format: str = 'png', alpha: bool = False, size: Optional[Size] = None,
                       timeout: Optional[float] = None) -> bytes:
        """As Viewer.snapshot()."""
        route, query = self._still(format, alpha, size)
        return await asyncio.get_running_loop().run_in_executor(None, ask, self._link, route, query, None,
                                                                timeout or max(self._timeout, LOADED))

    async def show_scene(self, name: str) -> None:
        """As Viewer.show_scene()."""
        await self._show('scene', name, b'')

    async def show_cloud(self, file: Union[bytes, str, os.PathLike[str]], name: str = 'uploaded') -> None:
        """As Viewer.show_cloud()."""
        await self._show('cloud', name, cloud_of(file))

    async def _show(self, route: str, name: str, body: bytes) -> None:
        before = self._before()
        await asyncio.get_running_loop().run_in_executor(None, ask, self._link, route, {'name': name}, body,
                                                         max(self._timeout, LOADED))
        await self._do(self._shown(before))

    async def set_particles(self, positions: Points, scales: Numbers,
                            extinctions: Numbers, albedos: Optional[Points] = None,
                            seconds: float = 0.0) -> None:
        """As Viewer.set_particles(); m, 1/m, s."""
        await self._do(self._set_particles(positions, scales, extinctions, albedos, seconds))
