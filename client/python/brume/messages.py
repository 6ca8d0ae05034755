"""The messages of brume.v1 to bytes and back. brume/wire is generated from protocol/brume.fbs."""
from __future__ import annotations

import array
import struct
import sys
import time
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import flatbuffers

from brume.error import BrumeError
from brume.frame import Frame, Measured
from brume.kinds import Table, Value, Values, Vec3
from brume.layers import Layers

try:
    from brume.wire import (Ack, Add, Body, Change, Command, Encoding, Error, ErrorCode, Goodbye, Hello, Impulse, Input,
                            Lead, LitParticles, Message, MoveVolume, People, Ping, Pong, Pose, Presence, Quat, Ray,
                            Remove, Restart, SceneState, Set, SetParticles, SettingKind, Undo, Welcome)
    from brume.wire import Frame as WireFrame
    from brume.wire import Vec3 as WireVec3
except ImportError as error:
    raise ImportError('brume.wire is missing: build it with ./dev build and use build/release/python, or see '
                      'client/python/README.md') from error

IDENTIFIER = b'BRM1'
MOST_BYTES = 64 * 1024  # of a message that the server reads
VIEWS = ('picture', 'wasted', 'overdraw', 'particles', 'rays', 'depth', 'shadow', 'light', 'error')
ROWS, ROWS_WITH_ALBEDO = 3000, 2000  # particles in one message, so that it stays below that

Builder = Any  # flatbuffers.Builder
Build = Callable[[Builder], Tuple[int, int]]  # adds a command's table to the builder; its type, and the table


def now_us() -> int:
    return time.monotonic_ns() // 1000


def _finish(builder: Builder, kind: int, body: int) -> bytes:
    Message.Start(builder)
    Message.AddBodyType(builder, kind)
    Message.AddBody(builder, body)
    builder.FinishSizePrefixed(Message.End(builder), IDENTIFIER)
    return bytes(builder.Output())


def _vec3(builder: Builder, v: Sequence[float]) -> int:
    x, y, z = (float(one) for one in v)
    made: int = WireVec3.CreateVec3(builder, x, y, z)
    return made


def hello(width: int, height: int, client: str, resume: str, quality: int, lossless: bool, keep_size: bool,
          draw_hz: int = 0) -> bytes:
    b = flatbuffers.Builder(256)
    name, key = b.CreateString(client), b.CreateString(resume)
    Hello.Start(b)
    Hello.AddClient(b, name)
    Hello.AddWidth(b, width)
    Hello.AddHeight(b, height)
    Hello.AddQuality(b, quality)
    Hello.AddResume(b, key)
    Hello.AddLossless(b, lossless)
    Hello.AddKeepSize(b, keep_size)
    Hello.AddDrawHz(b, draw_hz)
    return _finish(b, Body.Body.Hello, Hello.End(b))


def pose(seq: int, position: Sequence[float], orientation: Sequence[float], fov: float, size: Tuple[int, int],
         view: str = 'picture', layers: int = 0, hidden: bool = False) -> bytes:
    b = flatbuffers.Builder(256)
    name = b.CreateString(view) if view != 'picture' else None
    Pose.Start(b)
    Pose.AddSeq(b, seq)
    Pose.AddClientTimeUs(b, now_us())
    Pose.AddPosition(b, _vec3(b, position))
    Pose.AddOrientation(b, Quat.CreateQuat(b, *(float(one) for one in orientation)))
    Pose.AddFovY(b, fov)
    Pose.AddWidth(b, size[0])
    Pose.AddHeight(b, size[1])
    Pose.AddHidden(b, hidden)
    Pose.AddLayers(b, layers)
    if name is not None:
        Pose.AddView(b, name)
    return _finish(b, Body.Body.Pose, Pose.End(b))


def ack(frame: int) -> bytes:
    b = flatbuffers.Builder(64)
    Ack.Start(b)
    Ack.AddFrame(b, frame)
    return _finish(b, Body.Body.Ack, Ack.End(b))


def ping(nonce: int) -> bytes:
    b = flatbuffers.Builder(64)
    Ping.Start(b)
    Ping.AddNonce(b, nonce)
    Ping.AddTimeUs(b, now_us())
    return _finish(b, Body.Body.Ping, Ping.End(b))


def pong(nonce: int, time_us: int) -> bytes:
    b = flatbuffers.Builder(64)
    Pong.Start(b)
    Pong.AddNonce(b, nonce)
    Pong.AddTimeUs(b, time_us)
    return _finish(b, Body.Body.Pong, Pong.End(b))


def presence(name: str, pointer: Optional[Tuple[Sequence[float], Sequence[float]]], follow: int) -> bytes:
    b = flatbuffers.Builder(128)
    text = b.CreateString(name)
    Presence.Start(b)
    Presence.AddName(b, text)
    if pointer:
        Presence.AddPointer(b, Ray.CreateRay(b, *(float(one) for place in pointer for one in place)))
    Presence.AddFollow(b, follow)
    return _finish(b, Body.Body.Presence, Presence.End(b))


def lead(person: int) -> bytes:
    b = flatbuffers.Builder(64)
    Lead.Start(b)
    Lead.AddPerson(b, person)
    return _finish(b, Body.Body.Lead, Lead.End(b))


def goodbye(reason: str) -> bytes:
    b = flatbuffers.Builder(64)
    text = b.CreateString(reason)
    Goodbye.Start(b)
    Goodbye.AddReason(b, text)
    return _finish(b, Body.Body.Goodbye, Goodbye.End(b))


# A command is a function that adds its table to the builder and returns (its type, the table).


def impulse(origin: Sequence[float], direction: Sequence[float], push: Optional[Sequence[float]],
            strength: float) -> Build:
    def build(b: Builder) -> Tuple[int, int]:
        Impulse.Start(b)
        Impulse.AddOrigin(b, _vec3(b, origin))
        Impulse.AddDirection(b, _vec3(b, direction))
        if push is not None:
            Impulse.AddPush(b, _vec3(b, push))
        Impulse.AddStrength(b, strength)
        return Command.Command.Impulse, Impulse.End(b)
    return build


def move(offset: Sequence[float]) -> Build:
    def build(b: Builder) -> Tuple[int, int]:
        MoveVolume.Start(b)
        MoveVolume.AddOffset(b, _vec3(b, offset))
        return Command.Command.MoveVolume, MoveVolume.End(b)
    return build


def restart() -> Build:
    def build(b: Builder) -> Tuple[int, int]:
        Restart.Start(b)
        return Command.Command.Restart, Restart.End(b)
    return build


def undo() -> Build:
    def build(b: Builder) -> Tuple[int, int]:
        Undo.Start(b)
        return Command.Command.Undo, Undo.End(b)
    return build


def _changes(b: Builder, values: Dict[str, Value], start: Callable[[Builder, int], Any]) -> int:
    tables: List[int] = []
    for path, told in values.items():
        value: Any = told
        name = b.CreateString(path)
        text = b.CreateString(value) if isinstance(value, str) else None
        Change.Start(b)
        Change.AddPath(b, name)
        if text is not None:
            Change.AddText(b, text)
        elif hasattr(value, '__len__'):
            if len(value) != 3:
                raise BrumeError(f'{path}: {len(value)} numbers; allowed: three, or one', 'out_of_range')
            Change.AddVector(b, _vec3(b, value))
        else:
            Change.AddNumber(b, float(value))
        tables.append(Change.End(b))
    start(b, len(tables))
    for table in reversed(tables):
        b.PrependUOffsetTRelative(table)
    end: int = b.EndVector()
    return end


def change(values: Values) -> Build:
    """values: of live settings by path; a number or boolean, three numbers, or a text."""
    def build(b: Builder) -> Tuple[int, int]:
        changes = _changes(b, values, Set.StartChangesVector)
        Set.Start(b)
        Set.AddChanges(b, changes)
        return Command.Command.Set, Set.End(b)
    return build


def add(name: str, values: Values) -> Build:
    """values: of the new element's settings by key, as for change()."""
    def build(b: Builder) -> Tuple[int, int]:
        changes = _changes(b, {f'{name}.{key}': value for key, value in values.items()}, Add.StartChangesVector)
        text = b.CreateString(name)
        Add.Start(b)
        Add.AddList(b, text)
        Add.AddChanges(b, changes)
        return Command.Command.Add, Add.End(b)
    return build


def remove(path: str) -> Build:
    def build(b: Builder) -> Tuple[int, int]:
        text = b.CreateString(path)
        Remove.Start(b)
        Remove.AddPath(b, text)
        return Command.Command.Remove, Remove.End(b)
    return build


def packed(values: Any) -> bytes:
    """Numbers, or lists of them, as the bytes of 32-bit floats; a NumPy array at once."""
    if hasattr(values, 'astype'):
        data: bytes = values.astype('<f4').tobytes()
        return data
    flat = array.array('f', (x for one in values for x in (one if hasattr(one, '__len__') else (one,))))
    if sys.byteorder == 'big':
        flat.byteswap()
    return flat.tobytes()


def particles(first: int, live: int, seconds: float, lists: Sequence[Optional[bytes]]) -> Build:
    """lists: bytes of positions, scales, extinctions and albedos; of the last also None."""
    def build(b: Builder) -> Tuple[int, int]:
        vectors: List[Optional[int]] = []
        for data in lists:
            if data is None:
                vectors.append(None)
                continue
            b.StartVector(4, len(data) // 4, 4)
            b.head = b.head - len(data)
            b.Bytes[b.head:b.head + len(data)] = data
            vectors.append(b.EndVector())
        SetParticles.Start(b)
        SetParticles.AddFirst(b, first)
        for add, vector in zip((SetParticles.AddPositions, SetParticles.AddScales, SetParticles.AddExtinctions,
                                SetParticles.AddAlbedos), vectors):
            if vector is not None:
                add(b, vector)
        SetParticles.AddLive(b, live)
        SetParticles.AddSeconds(b, seconds)
        return Command.Command.SetParticles, SetParticles.End(b)
    return build


def order(seq: int, build: Build) -> bytes:
    b = flatbuffers.Builder(MOST_BYTES)
    kind, table = build(b)
    Input.Start(b)
    Input.AddSeq(b, seq)
    Input.AddClientTimeUs(b, now_us())
    Input.AddCommandType(b, kind)
    Input.AddCommand(b, table)
    return _finish(b, Body.Body.Input, Input.End(b))


# ---- from the server ----

_BODIES: Dict[int, Any] = {Body.Body.Welcome: Welcome.Welcome, Body.Body.SceneState: SceneState.SceneState,
           Body.Body.Frame: WireFrame.Frame, Body.Body.Error: Error.Error, Body.Body.Ping: Ping.Ping,
           Body.Body.Pong: Pong.Pong, Body.Body.Goodbye: Goodbye.Goodbye,
           Body.Body.LitParticles: LitParticles.LitParticles, Body.Body.People: People.People}
_CODES = {value: name for name, value in vars(ErrorCode.ErrorCode).items() if isinstance(value, int)}


def read(data: bytes) -> Tuple[Optional[str], Table, bytes]:
    """(kind, table, bytes after it) of a server's message; kind is None for one that this version does not know."""
    try:
        (length,) = struct.unpack_from('<I', data)
        if data[8:12] != IDENTIFIER:
            raise ValueError('no brume.v1')
        message = Message.Message.GetRootAs(data, 4)
        kind = _BODIES.get(message.BodyType())
        if kind is None:
            return None, None, b''
        table, body = kind(), message.Body()
        table.Init(body.Bytes, body.Pos)
        return kind.__name__, table, data[4 + length:]
    except (AttributeError, IndexError, TypeError, ValueError, struct.error) as error:
        raise BrumeError(f'the server sent what cannot be read ({error}): another version?') from error


def text_of(value: Optional[bytes]) -> str:
    return value.decode('utf-8', 'replace') if value else ''


def vector_of(v: Table) -> Vec3:
    return (v.X(), v.Y(), v.Z())


def layers_of(told: Table, pictures: Tuple[bytes, ...]) -> Layers:
    return Layers(count=told.Count(), columns=told.Columns(), rows=told.Rows(), block_rows=told.BlockRows(),
                  spacing=told.Spacing(), first=told.First(), near=told.Near(), far=told.Far(),
                  exposure=told.Exposure(), filmic=bool(told.Filmic()), near_surface=told.NearSurface(),
                  far_surface=told.FarSurface(), pictures=pictures)


def frame_of(table: Table, rest: bytes) -> Frame:
    at = 0

    def taken(length: int) -> bytes:
        nonlocal at
        at += length
        return bytes(rest[at - length:at])
    pictures = [taken(table.JpegBytes(i)) for i in range(table.JpegBytesLength())]
    told = [table.Layers(i) for i in range(table.LayersLength())]
    layers = tuple(layers_of(one, tuple(taken(one.Bytes(i)) for i in range(one.BytesLength()))) for one in told)
    turn = table.Orientation()
    return Frame(id=table.Id(), tick=table.Tick(), hash=f'{table.StateHash():016x}', pose=table.PoseSeq(),
                 position=vector_of(table.Position()), orientation=(turn.X(), turn.Y(), turn.Z(), turn.W()),
                 fov=table.FovY(), width=table.Width(), height=table.Height(), quality=table.Quality(),
                 lossless=table.Encoding() == Encoding.Encoding.png,
                 measured=Measured(table.Measured(), table.MeasuredLow(), table.MeasuredHigh())
                 if table.Measured() > 0 else None, pictures=tuple(pictures), follows=table.Follows(),
                 layers=layers or None)


def value_of(value: Table) -> Value:
    number: Optional[float] = value.Number()
    if number is not None:
        return number
    if value.Vector() is not None:
        return vector_of(value.Vector())
    return text_of(value.Text())


_WIDE = (SettingKind.SettingKind.vector, SettingKind.SettingKind.colour, SettingKind.SettingKind.direction)


def elements_of(described: Table, told: Table) -> List[Values]:
    """The elements of a list, each a dictionary of its values by key. described: a List, told: its Elements."""
    settings = [described.Settings(i) for i in range(described.SettingsLength())]
    elements: List[Values] = []
    at = 0
    while at < told.ValuesLength():
        element: Values = {}
        for one in settings:
            width = 3 if one.Kind() in _WIDE else 1
            if at + width > told.ValuesLength():
                raise BrumeError('the server sent half an element of a list: another version?')
            value: Value = tuple(told.Values(at + i) for i in range(width)) if width == 3 else told.Values(at)
            if one.Kind() == SettingKind.SettingKind.text:
                value = text_of(one.Choices(int(told.Values(at))))
            element[text_of(one.Path()).rpartition('.')[2]] = value
            at += width
        elements.append(element)
    return elements


def error_of(table: Table) -> Tuple[int, BrumeError]:
    """(number of the input that it answers or 0, the error)"""
    return table.InputSeq(), BrumeError(text_of(table.Text()), _CODES.get(table.Code(), 'unknown'))
