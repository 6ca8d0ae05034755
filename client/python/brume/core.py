"""What a viewer does, whatever the way to wait: Viewer and AsyncViewer run these steps."""
from __future__ import annotations

import base64
import math
import time
import weakref
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Set, Tuple

from brume import messages
from brume.address import page_address
from brume.camera import look_at
from brume.error import BrumeError
from brume.frame import Frame
from brume.kinds import Size, Table, Value, Values
from brume.link import Link
from brume.people import KEEP, People, Presence, people_of
from brume.state import State, state_of
from brume.steps import Steps

if TYPE_CHECKING:
    from brume.particles import Particles

REST = 1.0  # s in which a paused scene sends what it still has to send
LOADED = 90.0  # s; scenes of a million points take a while


class Core:
    """One viewer of the scene: what needs no waiting. Threads may share it; it has one camera."""

    def __init__(self, link: Link, timeout: float, size: Size, draw_hz: int) -> None:
        self._link, self._timeout, self._draw_hz = link, timeout, draw_hz
        self._last: Optional[Frame] = None  # that was returned last
        self._last_particles: Optional[Particles] = None
        self._view: Dict[str, Any] = {'size': size}
        self._presence = Presence()
        self.server = self.device = ''  # as their names are
        # A viewer that nobody has any more leaves: in a notebook a cell is run again and again.
        weakref.finalize(self, link.leave).atexit = False

    def _begin(self) -> Steps[None]:
        link = self._link
        yield from link.until(lambda: link.welcome and link.state, self._timeout, f'no welcome from {link.address}')
        self.server = messages.text_of(link.welcome.Server())
        self.device = messages.text_of(link.welcome.Device())
        self._take_camera()

    def _take_camera(self) -> None:
        camera = self._welcome().Camera()
        position = messages.vector_of(camera.Position())
        orientation = look_at(position, messages.vector_of(camera.Target()))
        self._view.update(position=position, orientation=orientation, fov=camera.FovY())
        self._link.look(**self._view)

    def _welcome(self) -> Table:
        if not self._link.welcome:
            raise self._link.missing('')
        return self._link.welcome

    def __repr__(self) -> str:
        return f'<{type(self).__name__} of {self.address}, {"connected" if self.connected else "not connected"}>'

    @property
    def address(self) -> str:
        """The server's page, which a browser opens."""
        return page_address(self._link.address)

    @property
    def connected(self) -> bool:
        """False: the connection is lost, and is tried again, or the viewer is closed."""
        return self._link.welcome is not None and self._link.failure is None

    @property
    def scene(self) -> str:
        """The scene's name."""
        with self._link.changed:
            return messages.text_of(self._welcome().Scene())

    @property
    def scenes(self) -> List[str]:
        """The names that show_scene() takes."""
        with self._link.changed:
            welcome = self._welcome()
        return [messages.text_of(welcome.Scenes(i)) for i in range(welcome.ScenesLength())]

    @property
    def paths(self) -> Dict[str, Dict[str, Any]]:
        """The live settings by path, each with its help, unit, range and the texts that it may have."""
        with self._link.changed:
            welcome = self._welcome()
            found = [welcome.Settings(i) for i in range(welcome.SettingsLength())]
        return {messages.text_of(one.Path()): {
            'help': messages.text_of(one.Help()), 'unit': messages.text_of(one.Unit()),
            'lowest': one.Lowest(), 'highest': one.Highest(),
            'choices': [messages.text_of(one.Choices(i)) for i in range(one.ChoicesLength())]} for one in found}

    @property
    def state(self) -> State:
        """The newest State."""
        with self._link.changed:
            welcome, state, lists = self._welcome(), self._link.state, self._link.lists
        return state_of(welcome, state, lists)

    # ---- camera and pictures ----

    def look(self, position: Optional[Sequence[float]] = None, target: Optional[Sequence[float]] = None,
             orientation: Optional[Sequence[float]] = None, fov: Optional[float] = None,
             size: Optional[Sequence[int]] = None, view: Optional[str] = None, layers: Optional[int] = None) -> None:
        """Moves the camera; what is not given stays. It returns at once. position, target: m. orientation: world from
        view, a unit quaternion x, y, z, w, in place of a target. fov: rad, the full vertical angle. size: (width,
        height) in pixels. view: of how the picture is made, in its place: one of messages.VIEWS. layers: 0 ... 8 with
        depth, for redraw(); the first frames come without."""
        self._link.check_process()
        with self._link.changed:
            self._link.check()
            wish = dict(self._view)
            if position is not None:
                wish['position'] = tuple(float(one) for one in position)
            if target is not None and orientation is not None:
                raise BrumeError('look() takes a target or an orientation, not both', 'out_of_range')
            if target is not None:
                wish['orientation'] = look_at(wish['position'], tuple(float(one) for one in target))
            if orientation is not None:
                wish['orientation'] = tuple(float(one) for one in orientation)
            if fov is not None:
                wish['fov'] = float(fov)
            if size is not None:
                wish['size'] = (int(size[0]), int(size[1]))
            if view is not None:
                if view not in messages.VIEWS:
                    raise BrumeError(f'no view {view!r}; there are {" ".join(messages.VIEWS)}', 'out_of_range')
                wish['view'] = view
            if layers is not None:
                if layers not in range(9):
                    raise BrumeError(f'layers is {layers}: allowed are whole numbers from 0 to 8', 'out_of_range')
                wish['layers'] = layers
            if not all(1 <= side <= 0xffff for side in wish['size']):
                raise BrumeError(f'size is {wish["size"]}: allowed are two whole numbers from 1 to 65535',
                                 'out_of_range')
            if not all(map(math.isfinite, (*wish['position'], *wish['orientation'], wish['fov']))):
                raise BrumeError('a camera has finite numbers', 'out_of_range')
            self._view = wish
            self._link.look(**wish)

    def _frame(self, after: Optional[int], timeout: Optional[float]) -> Steps[Frame]:
        link = self._link

        def newest() -> Optional[Frame]:
            if link.draws:
                raise BrumeError('this viewer gets particles in place of pictures: take particles(), or connect() '
                                 'without draw_hz', 'unexpected')
            return link.frame

        def at_rest() -> Optional[Frame]:
            return self._last if self._last is link.frame else None
        frame: Frame = yield from self._next(newest, self._last, at_rest, after, timeout, 'picture')
        self._last = frame
        return frame

    def _particles(self, after: Optional[int], timeout: Optional[float]) -> Steps[Particles]:
        link = self._link
        if not self._draw_hz:
            raise BrumeError('this viewer gets pictures: connect(draw_hz=30) asks for particles', 'unexpected')

        def newest() -> Optional[Particles]:
            if link.not_drawable:
                raise BrumeError(f'the server alone can draw this scene: {link.not_drawable}', 'unexpected')
            return link.current

        def at_rest() -> Optional[Particles]:
            one = link.particles
            return one if one is not None and int(one.hash, 16) == link.state.StateHash() else None
        one: Particles = yield from self._next(newest, self._last_particles, at_rest, after, timeout, 'particles')
        self._last_particles = one
        return one

    def _next(self, newest: Callable[[], Any], last: Any, at_rest: Callable[[], Any], after: Optional[int],
              timeout: Optional[float], what: str) -> Steps[Any]:
        """What newest() gives, as soon as it is another than `last` and of a tick above `after`; or what at_rest()
        gives of a paused scene that sends nothing more."""
        link, begin = self._link, time.monotonic()
        longest = self._timeout if timeout is None else timeout
        link.check()
        link.want()
        while True:
            one = newest()
            if one is not None and one is not last and (after is None or one.tick > after):
                return one
            link.want()  # so that the server goes on to draw
            if link.errors:
                raise link.errors.pop(0)
            link.check()
            waited = time.monotonic() - begin
            if after is None and waited >= min(REST, longest) and link.welcome and link.state.Paused():
                rests = at_rest()
                if rests is not None:
                    return rests
            if waited >= longest:
                raise TimeoutError(f'no {what} in {longest:g} s{self._hindrance()}')
            yield min(longest - waited, REST / 2)

    def _hindrance(self) -> str:
        link = self._link
        if not link.welcome:
            return f': {link.missing(" at present")}'
        why = messages.text_of(link.state.Standstill()) if link.state else ''
        return f': the scene stands still: {why}' if why else ''

    def _still(self, form: str, alpha: bool, size: Optional[Sequence[int]]) -> Tuple[str, Dict[str, Any]]:
        """Route and query of a snapshot of the camera as it is."""
        if form not in ('jpeg', 'png', 'exr'):
            raise BrumeError(f'no format {form!r}; there are jpeg, png and exr', 'out_of_range')
        if alpha and form == 'jpeg':
            raise BrumeError('a JPEG has no alpha: png or exr', 'out_of_range')
        view = self._view
        (px, py, pz), (x, y, z, w) = view['position'], view['orientation']
        away = max(1.0, *(abs(one) for one in view['position']))  # so that float32 tells the direction
        ahead = (-2 * (x * z + w * y), -2 * (y * z - w * x), -1 + 2 * (x * x + y * y))
        target = [at + away * part for at, part in zip((px, py, pz), ahead)]
        width, height = size or view['size']
        query = {'w': width, 'h': height, 'fov': view['fov'], 'keep_size': 1, 'position': f'{px!r},{py!r},{pz!r}',
                 'target': ','.join(map(repr, target)), **({'alpha': 1} if alpha and form == 'png' else {})}
        return f'snapshot.{"jpg" if form == "jpeg" else form}', query

    # ---- people ----

    @property
    def people(self) -> People:
        """Who is here; nobody before appear() was called."""
        with self._link.changed:
            return people_of(self._link.people)

    def appear(self, name: str = KEEP, pointer: Optional[Tuple[Sequence[float], Sequence[float]]] = KEEP,
               follow: int = KEEP) -> None:
        """Says to all who this viewer is; what is not given stays. It returns at once. name: a token's name is shown
        instead. pointer: origin (m) and direction of a ray; all see a dot where it meets something; None: no dot.
        follow: id of the person whose camera frames have from now on, whatever look() says; 0: their own."""
        self._link.check_process()
        with self._link.changed:
            self._link.check()
            given = {key: value for key, value in (('name', name), ('pointer', pointer), ('follow', follow))
                     if value is not KEEP}
            self._presence = replace(self._presence, **given).checked()
            self._link.appear(self._presence.message())

    def _present(self, on: bool) -> Steps[None]:
        link = self._link
        known = link.errors[-1:]
        link.lead(self._welcome().Viewer() if on else 0)
        yield from link.order([], self._timeout)
        if link.errors[-1:] != known:
            raise link.errors.pop()

    # ---- commands ----

    def _undo(self) -> Steps[None]:
        before = self.state.undo
        return self._order(messages.undo(), lambda: self.state.undo != before)

    def _push(self, origin: Sequence[float], direction: Sequence[float], strength: float,
              push: Optional[Sequence[float]]) -> Steps[None]:
        return self._link.order([messages.impulse(origin, direction, push, float(strength))], self._timeout)

    def _set_all(self, values: Values) -> Steps[None]:
        before = self._values()

        def adopted() -> bool:
            now = self._values()
            return (all(_alike(now.get(path), value) for path, value in values.items()) or
                    any(now.get(path) != before.get(path) for path in values))  # as the server makes it: a unit axis
        return self._order(messages.change(values), adopted)

    def _values(self) -> Values:
        state = self.state
        return {**state.settings, **{f'{name}[{i}].{key}': value for name, elements in state.lists.items()
                                     for i, element in enumerate(elements) for key, value in element.items()}}

    def _resize(self, name: str, order: messages.Build) -> Steps[None]:
        before = len(self.state.lists.get(name, ()))
        return self._order(order, lambda: len(self.state.lists.get(name, ())) != before)

    def _order(self, order: messages.Build, adopted: Callable[[], bool]) -> Steps[None]:
        """Gives an order, and waits until the server reports what it asked for. Raises BrumeError if it cannot be."""
        link = self._link
        known = link.errors[-1:]
        yield from link.order([order], self._timeout)
        end = time.monotonic() + self._timeout
        ticks: Set[int] = set()  # of reports since then; the third is of a tick after the order, whatever it says
        while len(ticks) < 3 and time.monotonic() < end and not adopted():
            if link.errors[-1:] != known:
                raise link.errors.pop()  # refused at its tick
            yield max(end - time.monotonic(), 0)
            ticks.add(link.state.Tick())
        link.want_since_state()
        link.look(**self._view)

    def _before(self) -> Table:
        """The welcome that another scene will follow."""
        self._link.check_process()
        with self._link.changed:
            return self._welcome()

    def _shown(self, before: Table) -> Steps[None]:
        """Until another scene than that of the welcome `before` is shown; takes its camera."""
        link = self._link
        yield from link.until(lambda: link.welcome not in (None, before), self._timeout, 'no word of the new scene')
        self._take_camera()

    def _set_particles(self, positions: Any, scales: Any, extinctions: Any, albedos: Any,
                       seconds: float) -> Steps[None]:
        count = len(positions)
        parts: List[Optional[bytes]] = [messages.packed(positions), *(
            messages.packed(one if hasattr(one, '__len__') else [one] * count) for one in (scales, extinctions))]
        parts.append(None if albedos is None else messages.packed(albedos))
        widths = (12, 4, 4, 12)  # bytes of a particle
        for name, part, width in zip(('positions', 'scales', 'extinctions', 'albedos'), parts, widths):
            if part is not None and len(part) != count * width:
                raise BrumeError(f'{len(part) // 4} numbers of {name} for {count} particles: {width // 4} each are due',
                                 'out_of_range')
        step = messages.ROWS if albedos is None else messages.ROWS_WITH_ALBEDO
        before = min(self.state.particles, count)  # rows beyond them show up with the last message, all at once
        return self._link.order([
            messages.particles(first, count if first + step >= count else before, float(seconds),
                               [part and part[first * width:(first + step) * width]
                                for part, width in zip(parts, widths)])
            for first in range(0, max(count, 1), step)], self._timeout)


def bundle(frame: Frame) -> Dict[str, str]:
    """What a notebook shows of a viewer: a picture, by MIME type."""
    kind = 'image/jpeg' if frame._repr_jpeg_() else 'image/png'
    return {kind: base64.b64encode(frame.jpeg).decode('ascii')}


def _alike(value: Optional[Value], wanted: Value) -> bool:
    """True if a reported value, of 32-bit floats, is the one that was asked for."""
    if value is None or isinstance(value, str) or isinstance(wanted, str):
        return value == wanted
    mine = value if isinstance(value, tuple) else (value,)
    both = list(zip(mine, wanted if hasattr(wanted, '__len__') else (wanted,)))  # type: ignore[arg-type]
    return all(math.isclose(float(one), float(two), rel_tol=1e-6, abs_tol=1e-9)
               for one, two in both)  # type: ignore[arg-type]
