"""What a program does with a server: look, push, set, and take pictures. Calls wait; async_viewer.py has the others."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, Iterator, Optional, Sequence, Union

from brume import messages
from brume.beside import ask
from brume.core import LOADED, Core, bundle
from brume.error import BrumeError
from brume.frame import Frame
from brume.kinds import Numbers, Points, Size, Value, Values
from brume.link import Link
from brume.steps import Steps, T, run

if TYPE_CHECKING:
    from brume.particles import Particles

SHOWN = 5.0  # s that a notebook waits for a picture of a viewer


def cloud_of(file: Union[bytes, str, os.PathLike[str]]) -> bytes:
    """The bytes of a PLY file: of its path, or these."""
    if isinstance(file, bytes):
        return file
    with open(file, 'rb') as ply:
        return ply.read()


class Viewer(Core):
    """One viewer of the scene. connect() makes it; close it, or use it in a `with`. Each call that waits does so in the
    thread that called, for `timeout` s."""

    def __init__(self, link: Link, timeout: float, size: Size, draw_hz: int = 0) -> None:
        super().__init__(link, timeout, size, draw_hz)
        self._do(self._begin())

    def _do(self, steps: Steps[T]) -> T:
        return run(self._link, steps)

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Says goodbye. Calls that wait, in whatever thread, raise BrumeError, and so do later ones."""
        self._link.leave()
        self._link.join()

    # ---- pictures ----

    def frame(self, after: Optional[int] = None, timeout: Optional[float] = None) -> Frame:
        """The next picture of the camera as it is now, drawn after the last command; newer than the one returned
        before. after: a tick, which the picture's must exceed. timeout: s, in place of the viewer's. In a paused scene
        that sends nothing more it is the same picture again. A viewer that draws by itself gets none."""
        return self._do(self._frame(after, timeout))

    def frames(self, count: Optional[int] = None, timeout: Optional[float] = None) -> Iterator[Frame]:
        """Pictures one after another, always the newest; those that come while the last is being used are passed
        over. timeout: s for each."""
        while count is None or count > 0:
            yield self.frame(timeout=timeout)
            count = None if count is None else count - 1

    def _repr_mimebundle_(self, **_: Any) -> Dict[str, str]:
        """What a notebook shows: a picture of now."""
        try:
            return bundle(self.frame(timeout=SHOWN))
        except (BrumeError, TimeoutError) as error:
            return {'text/plain': f'{self!r}: {error}'}

    # ---- particles, for viewers that draw by themselves: connect(draw_hz=30) ----

    def particles(self, after: Optional[int] = None, timeout: Optional[float] = None) -> Particles:
        """The next particles.Particles: the medium with the light on it, as arrays. They came after the last command,
        and are newer than those returned before. after: a tick, which theirs must exceed. timeout: s, in place of the
        viewer's. In a paused scene that sends nothing more they are the same again. Raises BrumeError if the scene can
        be drawn by the server alone."""
        return self._do(self._particles(after, timeout))

    def particle_stream(self, count: Optional[int] = None, timeout: Optional[float] = None) -> Iterator[Particles]:
        """Particles one after another, always the newest; those that come meanwhile are passed over."""
        while count is None or count > 0:
            yield self.particles(timeout=timeout)
            count = None if count is None else count - 1

    # ---- commands: they change the scene for everyone ----

    def push(self, origin: Sequence[float], direction: Sequence[float], strength: float = 1.0,
             push: Optional[Sequence[float]] = None) -> None:
        """Pushes particles along a ray from `origin` (m): away from it with `strength`, m/s, or with the velocity
        `push`, m/s."""
        self._do(self._push(origin, direction, strength, push))

    def move(self, offset: Sequence[float]) -> None:
        """Moves the medium, in m."""
        self._do(self._link.order([messages.move(offset)], self._timeout))

    def set(self, path: str, value: Value) -> None:
        """Changes a live setting, and returns when the server reports its value. `paths` has units and ranges."""
        self.set_all({path: value})

    def set_all(self, values: Values) -> None:
        """Changes live settings by path, all or none: set_all({'medium.extinction': 2, 'render.exposure': 1})."""
        self._do(self._set_all(values))

    def add(self, name: str, **values: Value) -> None:
        """Adds a light or a fog behind the others: add('fog', centre=(0, 2, 0), radius=3, extinction=0.5)."""
        self._do(self._resize(name, messages.add(name, values)))

    def remove(self, name: str, number: int) -> None:
        """Removes a light or a fog; those behind it move up: remove('fog', 0)."""
        self._do(self._resize(name, messages.remove(f'{name}[{number}]')))

    def pause(self, paused: bool = True) -> None:
        """Stops the scene; every picture that frame() returns from then on is of that state."""
        self.set('simulation.paused', paused)

    def resume(self) -> None:
        """Lets the scene go on."""
        self.pause(False)

    def restart(self) -> None:
        """Starts the scene again."""
        self._do(self._link.order([messages.restart()], self._timeout))

    def undo(self) -> None:
        """Takes back the newest change of anybody: of settings, of lists, or of the volume's place. state.undo says
        what that is. Raises BrumeError if there is none, or it is an operator's."""
        self._do(self._undo())

    def present(self, on: bool = True) -> None:
        """All take this viewer's camera from now on, or nobody's. Raises BrumeError where the role is too low."""
        self._do(self._present(on))

    def snapshot(self, format: str = 'png', alpha: bool = False, size: Optional[Size] = None,
                 timeout: Optional[float] = None) -> bytes:
        """A still of the camera as it is now, as the bytes of a file: drawn for itself, within the scene's error
        whatever the load. format: jpeg, png or exr. alpha: True leaves the sky out of a PNG, whose colours are then
        straight. An EXR has linear radiance times alpha, and never a sky. size: (width, height); else the viewer's."""
        route, query = self._still(format, alpha, size)
        return ask(self._link, route, query, None, timeout or max(self._timeout, LOADED))

    def show_scene(self, name: str) -> None:
        """Shows another scene, and takes its camera. `scenes` has the names that there are."""
        self._show('scene', name, b'')

    def show_cloud(self, file: Union[bytes, str, os.PathLike[str]], name: str = 'uploaded') -> None:
        """Shows a point cloud: the path of a PLY file, or its bytes. The server keeps it under `name`."""
        self._show('cloud', name, cloud_of(file))

    def _show(self, route: str, name: str, body: bytes) -> None:
        before = self._before()
        ask(self._link, route, {'name': name}, body, max(self._timeout, LOADED))
        self._do(self._shown(before))

    def set_particles(self, positions: Points, scales: Numbers, extinctions: Numbers,
                      albedos: Optional[Points] = None, seconds: float = 0.0) -> None:
        """Shows particles of a simulation elsewhere, in a scene with medium.layout = "live": these and no others.
        Particle n is the same in every call. Lists or arrays; scales and extinctions may be one number for all.

        positions: n x 3, m, counted from the scene's origin. scales: m; a particle's standard deviation is
        0.1 · scale · medium.falloff. extinctions: 1/m at the particle's centre.
        albedos: n x 3; without them the scene's. seconds: the particles move to their new values in this time; with
        the time between two calls, ten calls a second look smooth. The server takes 120 messages a second, each of
        3000 particles, or 2000 with albedos.
        """
        self._do(self._set_particles(positions, scales, extinctions, albedos, seconds))
