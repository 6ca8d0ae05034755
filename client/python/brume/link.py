"""The connection to a server, in a thread of its own: it answers pings, acknowledges frames and comes back when it was
lost, whatever the caller's thread does meanwhile."""
from __future__ import annotations

import asyncio
import contextlib
import os
import random
import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Set

import websockets as _websockets

from brume import beside, messages
from brume.destination import Destination
from brume.error import BrumeError
from brume.frame import Frame
from brume.kinds import Table
from brume.steps import Steps

if TYPE_CHECKING:
    import ssl

    from brume.particles import Particles, Reader

SILENCE = 8  # s; the server reports the scene each second
IDLE = 1  # s without a wish for a picture, after which the server draws none
HANDSHAKE = 10  # s
WAITS = (0.1, 0.2, 0.4, 0.8, 1)  # s before each further try to connect

websockets: Any = _websockets  # its versions differ in what they export, and how
_HEADERS = 'additional_headers' if int(websockets.__version__.split('.')[0]) >= 14 else 'extra_headers'


class Link:
    """`changed` guards what a reader sees: welcome, state, frame, particles, failure. It is notified whenever one
    changes, and so are `watchers`. reader: makes what reads LitParticles, for each connection a new one; None: this
    viewer takes none. hello: makes the first message from the key to resume with. patience: s."""

    def __init__(self, url: str, token: Optional[str], tls: Optional[ssl.SSLContext], patience: float,
                 hello: Callable[[str], bytes], reader: Optional[Callable[[], Reader]] = None) -> None:
        self._destination = Destination(url)
        self.changed = threading.Condition()
        self.watchers: Set[Callable[[], None]] = set()  # called whenever `changed` is notified
        self.welcome: Table = None  # the newest Welcome; None: not connected
        self.state: Table = None  # the newest SceneState
        self.lists: Table = None  # the newest with the scene's lists
        self.people: Table = None  # the newest People of this connection
        self._presence = b''  # message; empty: it has said nothing
        self.frame: Optional[Frame] = None  # the newest Frame that shows the camera as it is
        self.particles: Optional[Particles] = None  # the newest Particles of this connection
        self.failure: Optional[BrumeError] = None  # why there is no connection any more
        self.away: Optional[BrumeError] = None  # why there is none at present
        self.errors: List[BrumeError] = []  # refusals that no waiting command has taken
        self._awaited: Set[int] = set()  # numbers of inputs whose answers a command waits for
        self._refused: Dict[int, BrumeError] = {}  # number of an input: its refusal
        self._ponged = 0  # number of the newest answered ping
        self.token, self.tls, self._patience, self._hello = token, tls, patience, hello
        self._new_reader = reader
        self._reader: Optional[Reader] = None
        self._told = False  # True: `state` is of the scene that `welcome` tells of
        self._old: Optional[Particles] = None  # the newest Particles that are not current any more
        self._least_tick = 0  # of particles that are current
        self._closing = False
        self._resume = ''
        self._ending: Optional[BrumeError] = None  # why the server ends this connection
        self._socket: Any = None
        self._view: Optional[Dict[str, Any]] = None  # what pose() takes after its number
        self._pose = self._least_pose = self._input = self._nonce = 0
        self._wanted = 0.0  # time when somebody last waited for a picture
        self._hidden = False
        self._loop: Optional[asyncio.AbstractEventLoop] = None
        self._task: Optional[asyncio.Task[Any]] = None
        self._process = os.getpid()
        self._thread = threading.Thread(target=self._run_thread, name='brume', daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        return self._destination.address

    # ---- from the caller's thread ----

    def check_process(self) -> None:
        if os.getpid() != self._process:
            raise BrumeError('this viewer belongs to the process that connected it: connect() in this one, too')

    def check(self) -> None:
        """Raises why there is no connection any more. Call it with `changed` held."""
        if self.failure:
            raise BrumeError(str(self.failure), self.failure.code)  # the caller's own, with its own traceback

    def missing(self, what: str) -> BrumeError:
        """The error of a call that takes a connection, which is not there at present."""
        self.check()
        return BrumeError(f'not connected{what}' + (f' ({self.away})' if self.away else ''))

    def until(self, ready: Callable[[], object], timeout: float, what: str) -> Steps[None]:
        """Steps until ready() is true; raises what came instead."""
        deadline = time.monotonic() + timeout
        while not ready():
            if self.errors:
                raise self.errors.pop(0)
            self.check()
            left = deadline - time.monotonic()
            if left <= 0:
                raise TimeoutError(f'{what} in {timeout:g} s')
            yield left

    def look(self, **view: Any) -> None:
        """Sends a camera. `frame` is None until a picture shows it."""
        with self.changed:
            if self._view == view and not self.draws:
                self._look_away()
            self._view = view
            self._wanted = time.monotonic()
            self._send_pose(hidden=False)

    def want(self) -> None:
        """Somebody waits for a picture now. Call it with `changed` held."""
        self._wanted = time.monotonic()
        if self._hidden:
            self._send_pose(hidden=False)

    @property
    def draws(self) -> bool:
        """True: particles come, and no pictures."""
        return self._new_reader is not None and self.not_drawable is None

    @property
    def not_drawable(self) -> Optional[str]:
        """Why this scene can be drawn by the server alone; None: viewers can draw it, or nobody has said so yet."""
        return messages.text_of(self.state.NotDrawable()) or None if self._told else None

    @property
    def current(self) -> Optional[Particles]:
        """`particles`, if they are of the scene that `state` is of, and came after the last command and after the last
        time when nobody wanted any, or when there were none; else None."""
        one = self.particles
        known = one is not None and one is not self._old and self._told and one.tick >= self._least_tick
        return one if known else None

    def want_since_state(self) -> None:
        """Particles that are older than `state` are not current any more. Call it with `changed` held."""
        self._least_tick = self.state.Tick()

    def order(self, builds: List[messages.Build], timeout: float) -> Steps[None]:
        """Sends commands, and ends when the server has taken them; raises BrumeError if it refused one."""
        connection = self._socket
        if not self.welcome:
            raise self.missing(': the command was not sent')
        if not self.draws:
            self._look_away()
        made = [messages.order(self._input + 1 + i, build) for i, build in enumerate(builds)]
        longest = max(map(len, made), default=0)
        if longest > messages.MOST_BYTES:
            raise BrumeError(f'a command of {longest} bytes is too long: {messages.MOST_BYTES} are allowed',
                             'out_of_range')
        numbers = []
        for data in made:
            self._input += 1
            numbers.append(self._input)
            self._awaited.add(self._input)
            self._send(data)
        self._nonce += 1
        nonce = self._nonce
        self._send(messages.ping(nonce))  # messages are answered in their order
        try:
            yield from self.until(lambda: self._ponged >= nonce or self._socket is not connection, timeout,
                                  'no answer to a command')
        finally:
            self._awaited.difference_update(numbers)
            refused = [self._refused.pop(number) for number in numbers if number in self._refused]
        if refused:
            raise refused[0]
        if self._socket is not connection:
            raise BrumeError('the connection was lost: whether the command was taken is not known')
        self._old = self.particles
        if self._view:
            self._send_pose(hidden=False)  # a picture of it shows the command, too

    def appear(self, presence: bytes) -> None:
        """Says who the viewer is, now and on later connections."""
        self._presence = presence
        if self.welcome and self.welcome.People():
            self._send(presence)

    def lead(self, person: int) -> None:
        self._send(messages.lead(person))

    def leave(self) -> None:
        """Says goodbye. Nothing is waited for, so that the garbage collector may call it."""
        if os.getpid() != self._process:
            return
        with self.changed:
            self._closing = True
            self._send(messages.goodbye('done'))
            self.failure = self.failure or BrumeError('the viewer is closed')
            self._tell()
        self._run(self._hang_up)

    def join(self) -> None:
        """Until the thread has ended, which leave() began."""
        if self._process == os.getpid() and self._thread is not threading.current_thread():
            self._thread.join(5)

    # ---- both; with `changed` held ----

    def _tell(self) -> None:
        self.changed.notify_all()
        for watcher in tuple(self.watchers):
            watcher()

    def _send(self, data: bytes) -> None:
        socket = self._socket
        if socket:
            self._run(self._put, socket, data)

    def _run(self, what: Callable[..., Any], *args: Any) -> None:
        """In the connection's own thread, unless that has ended."""
        if self._loop:
            with contextlib.suppress(RuntimeError):
                self._loop.call_soon_threadsafe(lambda: asyncio.ensure_future(what(*args)))

    def _send_pose(self, hidden: bool) -> None:
        self._pose += 1
        if self._hidden and not hidden:
            self._old = self.particles
        self._hidden = hidden
        if not hidden:
            self._least_pose = self._pose
            self.frame = None
        if self.welcome and self._view:
            self._send(messages.pose(self._pose, hidden=hidden, **self._view))

    def _look_away(self) -> None:
        """The next pose gets a picture even if that shows nothing new: a scene at rest sends none for a mere pose."""
        if not self._hidden:
            self._send_pose(hidden=True)

    # ---- in the connection's own thread ----

    def _run_thread(self) -> None:
        try:
            asyncio.run(self._main())
        except BaseException as error:  # nobody would hear of it otherwise, and calls would wait in vain
            with self.changed:
                self.failure = self.failure or BrumeError(f'the connection ended by a fault of this package: {error!r}')
                self.welcome = self._socket = None
                self._tell()

    async def _put(self, socket: Any, data: bytes) -> None:
        try:
            await socket.send(data)
        except websockets.WebSocketException:
            pass  # the reader sees the end, too

    async def _hang_up(self) -> None:
        if self._socket:
            await self._socket.close()
        elif self._task:
            self._task.cancel()  # it waits to try again, or for an answer

    async def _main(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._task = asyncio.current_task()
        with contextlib.suppress(asyncio.CancelledError):
            await self._sessions()

    async def _sessions(self) -> None:
        tries, lost, known = 0, time.monotonic(), False
        while not self._closing:
            failure = await self._session()
            with self.changed:
                was = self.welcome
                known = known or was is not None
                self.welcome = self._socket = None
                self.away = failure
                tries, lost = (0, time.monotonic()) if was else (tries + 1, lost)
                final = not (known or self._destination.sent_on) or time.monotonic() - lost > self._patience
                before = self.address
                asked = self._destination.move(was is not None)
                if self.address != before:
                    self._resume = ''  # nobody knows it there
                if final or self._closing:
                    self.failure = self.failure or failure
                self._tell()
                if self.failure:
                    return
            await asyncio.sleep(asked + WAITS[min(tries, len(WAITS) - 1)] * random.uniform(0.5, 1))

    async def _session(self) -> BrumeError:
        """One connection from its beginning to its end. Returns why it ended."""
        headers: Dict[str, Any] = {_HEADERS: {'Authorization': f'Bearer {self.token}'}} if self.token else {}
        tls: Dict[str, Any] = {'ssl': self.tls} if self.tls else {}
        self._ending = None
        try:
            async with websockets.connect(self.address, subprotocols=['brume.v1'], compression=None, max_size=None,
                                          open_timeout=HANDSHAKE, close_timeout=2, **headers, **tls) as socket:
                self._socket = socket
                with self.changed:
                    self._reader = self._new_reader and self._new_reader()
                    self._told, self.particles = False, None
                await socket.send(self._hello(self._resume))
                idle = asyncio.ensure_future(self._watch_idleness())
                try:
                    while True:
                        self._receive(await asyncio.wait_for(socket.recv(), SILENCE))
                finally:
                    idle.cancel()
        except websockets.ConnectionClosed as error:
            return self._ending or BrumeError(f'the connection was lost: {error}')
        except asyncio.TimeoutError:
            return self._ending or BrumeError(f'{self.address} does not answer')
        except websockets.InvalidURI as error:
            return BrumeError(str(error))
        except (OSError, websockets.WebSocketException, EOFError) as error:
            said = await asyncio.get_running_loop().run_in_executor(None, beside.why_refused, self.address,
                                                                      self.token, self.tls)
            return BrumeError(said, 'forbidden') if said else BrumeError(f'no connection to {self.address}: {error}')
        except BrumeError as error:
            return error

    async def _watch_idleness(self) -> None:
        while True:
            await asyncio.sleep(IDLE / 2)
            with self.changed:
                if not self._hidden and self._view and time.monotonic() - self._wanted > IDLE:
                    self._send_pose(hidden=True)

    def _receive(self, data: bytes) -> None:
        kind, table, rest = messages.read(data)
        particles = self._particles_of(table, rest) if kind == 'LitParticles' else None
        with self.changed:
            if kind == 'Frame':
                frame = messages.frame_of(table, rest)
                self._send(messages.ack(frame.id))
                if not self._hidden and frame.pose >= self._least_pose:
                    self.frame = frame
            elif kind == 'LitParticles':
                self._send(messages.ack(table.Id()))
                self.particles = particles
            elif kind == 'SceneState':
                self.state = table
                if table.ListsLength() > 0:
                    self.lists = table
                if not self._told:
                    self._told = True
                    self.want_since_state()
                if self.not_drawable:
                    self._old = self.particles
            elif kind == 'People':
                self.people = table
            elif kind == 'Ping':
                self._send(messages.pong(table.Nonce(), table.TimeUs()))
            elif kind == 'Pong':
                self._ponged = max(self._ponged, table.Nonce())
            elif kind == 'Error':
                self._refuse(*messages.error_of(table))
            elif kind == 'Goodbye':
                said = messages.text_of(table.Reason())
                self._ending = self._ending or BrumeError(f'the server said goodbye: {said}')
                self._destination.hear(table)
            elif kind == 'Welcome':
                self.welcome, self.away = table, None
                self._told, self._old = False, self.particles
                self._resume = messages.text_of(table.Resume()) or self._resume
                if self._view:
                    self._send_pose(hidden=self._hidden)
                if self._presence:
                    self.appear(self._presence)
            self._tell()

    def _particles_of(self, table: Table, rest: bytes) -> Optional[Particles]:
        """Particles, or None if nobody asked for them. What cannot be read ends the connection: messages that refer to
        it could not be read, either, and a new connection begins with whole ones."""
        try:
            return self._reader.read(table, rest) if self._reader else None
        except BrumeError as error:
            with self.changed:
                self._remember(BrumeError(str(error)))  # the caller's own: it may clear the frames of its traceback
                self._tell()
            raise

    def _remember(self, error: BrumeError) -> None:
        self.errors.append(error)
        del self.errors[:-16]

    def _refuse(self, number: int, error: BrumeError) -> None:
        if error.code == 'full':
            self._ending = error
        elif number in self._awaited:
            self._refused[number] = error
        elif number or error.code != 'too_fast':  # a pose that came too fast is shown a little later
            self._remember(error)
