"""What a program does with a server: look, push, set, and take pictures."""
import math
import time
from dataclasses import dataclass, field

from brume import messages
from brume.error import BrumeError
from brume.link import Link

REST = 1.0  # s in which a paused scene sends what it still has to send
LOADED = 90.0  # s; scenes of a million points take a while


@dataclass(frozen=True)
class State:
    """The scene as the server last reported it: when something changes, and once a second."""
    tick: int
    hash: str
    viewers: int
    particles: int
    paused: bool
    error: float  # relative RMSE of the pictures, predicted; 1: not; None: the server does not say
    promised: float  # relative RMSE that the pictures may have; None: nothing is promised, or the server does not say
    method: str  # what is rendered with now, in a few words
    settings: dict = field(repr=False)  # every live setting by its path
    lists: dict = field(repr=False)  # of each list, 'light' and 'fog', its elements: each a dictionary by key
    box: tuple  # two corners of a box that holds the medium, m; None from an older server
    standstill: str = None  # why no tick comes at present, in one line; None: ticks come
    preparing: str = None  # the name of another scene that is being made ready to be shown; None: none is
    not_drawable: str = None  # why viewers cannot draw this scene by themselves, in one line; None: they can


def look_at(position, target):
    """The orientation (world from view, a quaternion) of a camera that looks from `position` to `target`, upright."""
    x, y, z = (b - a for a, b in zip(position, target))
    length = math.sqrt(x * x + y * y + z * z)
    if not length > 0:
        raise BrumeError('position and target are the same place', 'out_of_range')
    yaw, pitch = math.atan2(-x, -z), math.asin(max(-1.0, min(1.0, y / length)))
    cy, sy, cp, sp = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    return (cy * sp, sy * cp, -sy * sp, cy * cp)


class Viewer:
    """One viewer of the scene. connect() makes it; close it, or use it in a `with`."""

    def __init__(self, link, timeout, size, draw_hz=0):
        self._link, self._timeout, self._draw_hz = link, timeout, draw_hz
        self._last = self._last_particles = None  # that were returned last
        with link.changed:
            link.wait(lambda: link.welcome and link.state, timeout, f'no welcome from {link.address}')
            welcome = link.welcome
        self.server = messages.text_of(welcome.Server())
        self.device = messages.text_of(welcome.Device())
        self._view = {'size': size}
        self._take_camera()

    def _take_camera(self):
        camera = self._welcome().Camera()
        position = messages.vector_of(camera.Position())
        orientation = look_at(position, messages.vector_of(camera.Target()))
        self._view.update(position=position, orientation=orientation, fov=camera.FovY())
        self._link.look(**self._view)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._link.close()

    @property
    def scene(self):
        """The scene's name."""
        with self._link.changed:
            return messages.text_of(self._welcome().Scene())

    @property
    def scenes(self):
        """The names that show_scene() takes."""
        with self._link.changed:
            welcome = self._welcome()
        return [messages.text_of(welcome.Scenes(i)) for i in range(welcome.ScenesLength())]

    @property
    def paths(self):
        """The live settings by path, each with its help, unit, range and the texts that it may have."""
        with self._link.changed:
            welcome = self._welcome()
            found = [welcome.Settings(i) for i in range(welcome.SettingsLength())]
        return {messages.text_of(one.Path()): {
            'help': messages.text_of(one.Help()), 'unit': messages.text_of(one.Unit()),
            'lowest': one.Lowest(), 'highest': one.Highest(),
            'choices': [messages.text_of(one.Choices(i)) for i in range(one.ChoicesLength())]} for one in found}

    @property
    def state(self):
        """The newest State."""
        with self._link.changed:
            welcome, state = self._welcome(), self._link.state
        paths = [messages.text_of(welcome.Settings(i).Path()) for i in range(welcome.SettingsLength())]
        values = [messages.value_of(state.Settings(i)) for i in range(state.SettingsLength())]
        lists = self._link.lists
        elements = {messages.text_of(welcome.Lists(i).Name()): messages.elements_of(welcome.Lists(i), lists.Lists(i))
                    for i in range(min(welcome.ListsLength(), lists.ListsLength() if lists else 0))}
        plan = state.Plan()
        lo, hi = state.Lo(), state.Hi()
        method = plan.Text() or plan.Method() if plan else state.Method()
        return State(tick=state.Tick(), hash=f'{state.StateHash():016x}', viewers=state.Viewers(),
                     particles=state.Particles(), paused=bool(state.Paused()), error=plan.Error() if plan else None,
                     promised=(plan.Promised() or None) if plan else None, method=messages.text_of(method),
                     settings=dict(zip(paths, values)), lists=elements,
                     box=(messages.vector_of(lo), messages.vector_of(hi)) if lo and hi else None,
                     standstill=messages.text_of(state.Standstill()) or None,
                     preparing=messages.text_of(state.Preparing()) or None,
                     not_drawable=messages.text_of(state.NotDrawable()) or None)

    # ---- camera and pictures ----

    def look(self, position=None, target=None, orientation=None, fov=None, size=None, view=None, layers=None):
        """Moves the camera; what is not given stays. position, target: m. orientation: world from view, a unit
        quaternion x, y, z, w, in place of a target. fov: rad, the full vertical angle. size: (width, height) in
        pixels. view: of how the picture is made, in its place: one of messages.VIEWS. layers: 0 ... 8 with depth, for
        redraw(); the first frames come without."""
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
            raise BrumeError(f'size is {wish["size"]}: allowed are two whole numbers from 1 to 65535', 'out_of_range')
        if not all(map(math.isfinite, (*wish['position'], *wish['orientation'], wish['fov']))):
            raise BrumeError('a camera has finite numbers', 'out_of_range')
        self._view = wish
        self._link.look(**wish)

    def frame(self, after=None, timeout=None):
        """The next picture of the camera as it is now, drawn after the last command; newer than the one returned
        before. after: a tick, which the picture's must exceed. In a paused scene that sends nothing more it is the
        same picture again. A viewer that draws by itself gets none."""
        link = self._link

        def newest():
            if link.draws:
                raise BrumeError('this viewer gets particles in place of pictures: take particles(), or connect() '
                                 'without draw_hz', 'unexpected')
            return link.frame
        self._last = self._wait(newest, self._last, lambda: self._last if self._last is link.frame else None,
                                after, timeout, 'picture')
        return self._last

    def _wait(self, newest, last, at_rest, after, timeout, what):
        """What newest() gives, as soon as it is another than `last` and of a tick above `after`; or what at_rest()
        gives of a paused scene that sends nothing more."""
        link, timeout = self._link, timeout or self._timeout

        def ready():
            one = newest()
            return one and one is not last and (after is None or one.tick > after)
        with link.changed:
            begin = time.monotonic()
            link.want()
            while not ready():
                link.want()  # so that the server goes on to draw
                waited = time.monotonic() - begin
                rests = after is None and waited >= min(REST, timeout) and link.state and link.state.Paused()
                if rests and at_rest():
                    return at_rest()
                if waited >= timeout:
                    why = messages.text_of(link.state.Standstill()) if link.state else ''
                    still = f': the scene stands still: {why}' if why else ''
                    raise TimeoutError(f'no {what} in {timeout:g} s{still}')
                try:
                    link.wait(ready, min(timeout - waited, REST / 2), '')
                except TimeoutError:
                    continue
            return newest()

    def frames(self, count=None, timeout=None):
        """Pictures one after another, always the newest; those that come while the last is being used are passed
        over."""
        while count is None or count > 0:
            yield self.frame(timeout=timeout)
            count = None if count is None else count - 1

    # ---- particles, for viewers that draw by themselves: connect(draw_hz=30) ----

    def particles(self, after=None, timeout=None):
        """The next particles.Particles: the medium with the light on it, as arrays. They came after the last command,
        and are newer than those returned before. after: a tick, which theirs must exceed. In a paused scene that sends
        nothing more they are the same again. Raises BrumeError if the scene can be drawn by the server alone."""
        link = self._link
        if not self._draw_hz:
            raise BrumeError('this viewer gets pictures: connect(draw_hz=30) asks for particles', 'unexpected')

        def newest():
            if link.not_drawable:
                raise BrumeError(f'the server alone can draw this scene: {link.not_drawable}', 'unexpected')
            return link.current

        def at_rest():
            one = link.particles
            return one if one and int(one.hash, 16) == link.state.StateHash() else None
        self._last_particles = self._wait(newest, self._last_particles, at_rest, after, timeout, 'particles')
        return self._last_particles

    def particle_stream(self, count=None, timeout=None):
        """Particles one after another, always the newest; those that come meanwhile are passed over."""
        while count is None or count > 0:
            yield self.particles(timeout=timeout)
            count = None if count is None else count - 1

    # ---- commands: they change the scene for everyone ----

    def push(self, origin, direction, strength=1.0, push=None):
        """Pushes particles along a ray: away from it with `strength`, or with the velocity `push`, m/s."""
        self._link.order([messages.impulse(origin, direction, push, float(strength))], self._timeout)

    def move(self, offset):
        """Moves the medium, in m."""
        self._link.order([messages.move(offset)], self._timeout)

    def set(self, path, value):
        """Changes a live setting, and returns when the server reports its value."""
        self.set_all({path: value})

    def set_all(self, values):
        """Changes live settings by path, all or none: set_all({'medium.extinction': 2, 'render.exposure': 1})."""
        before = self._values()

        def adopted():
            now = self._values()
            return (all(_alike(now.get(path), value) for path, value in values.items()) or
                    any(now.get(path) != before.get(path) for path in values))  # as the server makes it: a unit axis
        self._order(messages.change(values), adopted)

    def _values(self):
        state = self.state
        return state.settings | {f'{name}[{i}].{key}': value for name, elements in state.lists.items()
                                 for i, element in enumerate(elements) for key, value in element.items()}

    def add(self, name, **values):
        """Adds a light or a fog behind the others: add('fog', centre=(0, 2, 0), radius=3, extinction=0.5)."""
        self._resize(name, messages.add(name, values))

    def remove(self, name, number):
        """Removes a light or a fog; those behind it move up: remove('fog', 0)."""
        self._resize(name, messages.remove(f'{name}[{number}]'))

    def _resize(self, name, order):
        before = len(self.state.lists.get(name, ()))
        self._order(order, lambda: len(self.state.lists.get(name, ())) != before)

    def _order(self, order, adopted):
        """Gives an order, and waits until the server reports what it asked for. Raises BrumeError if it cannot be."""
        link = self._link
        known = link.errors[-1:]
        link.order([order], self._timeout)
        end = time.monotonic() + self._timeout
        ticks = set()  # of reports since then; the third is of a tick after the order, whatever it says
        while len(ticks) < 3 and time.monotonic() < end and not adopted():
            with link.changed:
                if link.errors[-1:] != known:
                    raise link.errors.pop()  # refused at its tick
                link.changed.wait(max(end - time.monotonic(), 0))
                ticks.add(link.state.Tick())
        with link.changed:
            link.want_since_state()
        link.look(**self._view)

    def pause(self, paused=True):
        """Stops the scene; every picture that frame() returns from then on is of that state."""
        self.set('simulation.paused', paused)

    def resume(self):
        """Lets the scene go on."""
        self.pause(False)

    def restart(self):
        """Starts the scene again."""
        self._link.order([messages.restart()], self._timeout)

    def show_scene(self, name):
        """Shows another scene, and takes its camera. `scenes` has the names that there are."""
        self._show('scene', name, None)

    def show_cloud(self, file, name='uploaded'):
        """Shows a point cloud: the path of a PLY file, or its bytes. The server keeps it under `name`."""
        if not isinstance(file, bytes):
            with open(file, 'rb') as ply:
                file = ply.read()
        self._show('cloud', name, file)

    def _show(self, route, name, body):
        with self._link.changed:
            before = self._welcome()
        self._link.post(route, {'name': name}, body or b'', max(self._timeout, LOADED))
        with self._link.changed:
            self._link.wait(lambda: self._link.welcome not in (None, before), self._timeout, 'no word of the new scene')
        self._take_camera()

    def set_particles(self, positions, scales, extinctions, albedos=None, seconds=0.0):
        """Shows particles of a simulation elsewhere, in a scene with medium.layout = "live": these and no others.
        Particle n is the same in every call. Lists or arrays; scales and extinctions may be one number for all.

        positions: n x 3, m, counted from the scene's origin. scales: m; a particle's standard deviation is
        0.1 · scale · medium.falloff. extinctions: 1/m at the particle's centre.
        albedos: n x 3; without them the scene's. seconds: the particles move to their new values in this time; with
        the time between two calls, ten calls a second look smooth. The server takes 120 messages a second, each of
        3000 particles, or 2000 with albedos.
        """
        count = len(positions)
        parts = [messages.packed(positions), *(messages.packed(one if hasattr(one, '__len__') else [one] * count)
                                               for one in (scales, extinctions))]
        parts.append(None if albedos is None else messages.packed(albedos))
        widths = (12, 4, 4, 12)  # bytes of a particle
        for name, part, width in zip(('positions', 'scales', 'extinctions', 'albedos'), parts, widths):
            if part is not None and len(part) != count * width:
                raise BrumeError(f'{len(part) // 4} numbers of {name} for {count} particles: {width // 4} each are due',
                                 'out_of_range')
        step = messages.ROWS if albedos is None else messages.ROWS_WITH_ALBEDO
        before = min(self.state.particles, count)  # rows beyond them show up with the last message, all at once
        self._link.order([
            messages.particles(first, count if first + step >= count else before, float(seconds),
                               [part and part[first * width:(first + step) * width]
                                for part, width in zip(parts, widths)])
            for first in range(0, max(count, 1), step)], self._timeout)

    def _welcome(self):
        if not self._link.welcome:
            raise self._link.failure or BrumeError('not connected')
        return self._link.welcome


def _alike(value, wanted):
    """True if a reported value, of 32-bit floats, is the one that was asked for."""
    if value is None or isinstance(value, str) or isinstance(wanted, str):
        return value == wanted
    both = [(value, wanted)] if not hasattr(wanted, '__len__') else list(zip(value or (), wanted))
    return all(one is not None and math.isclose(one, float(two), rel_tol=1e-6, abs_tol=1e-9) for one, two in both)


def _reader():
    try:
        import numpy  # noqa: F401
    except ImportError:
        raise BrumeError('NumPy is missing, which particles need: install python3-numpy') from None
    from brume.particles import Reader
    return Reader


def connect(url='http://127.0.0.1:8080', token=None, size=(640, 360), quality=0, lossless=False, timeout=30,
            tls=None, reconnect=60, keep_size=False, draw_hz=0):
    """A Viewer of the server at `url` (http, https, ws or wss).

    token: where the server wants one. size: pixels of a picture. quality: of the JPEG, 1 ... 100; 0: the server's.
    lossless: True asks for what rests once more as PNG. timeout: s that a call waits. tls: an ssl.SSLContext, for
    certificates of one's own. reconnect: s for which a lost connection is tried again, as the same viewer. keep_size:
    True asks for fewer pictures, not smaller ones, where the link or the server is slow. draw_hz: 1 ... 60 asks for at
    most so many particles() a second in place of pictures, for a program that draws or measures by itself; it needs
    NumPy.
    Raises BrumeError with the server's line if it refuses, TimeoutError if nobody answers.
    """
    if draw_hz not in range(61):
        raise BrumeError(f'draw_hz is {draw_hz}: allowed are whole numbers from 0 to 60', 'out_of_range')

    def hello(resume):
        return messages.hello(size[0], size[1], 'brume-python 0.1.0', resume, quality, lossless=lossless,
                              keep_size=keep_size, draw_hz=int(draw_hz))
    link = Link(url, token, tls, reconnect, hello, _reader() if draw_hz else None)
    try:
        return Viewer(link, timeout, tuple(size), draw_hz)
    except BaseException:
        link.close()
        raise
