"""Particles: the medium with the light on it, for programs that draw or measure it by themselves. connect(draw_hz=30)
asks for them, Viewer.particles() gives them. Needs NumPy."""
from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy

from brume import columns
from brume.error import BrumeError
from brume.frame import Measured
from brume.kinds import Array, Table, Vec3
from brume.messages import vector_of
from brume.wire import Vec3 as WireVec3

MOST_HUES, MOST_OBJECTS = 3, 64
KINDS = ('plane', 'box', 'sphere')  # of objects, by number
ALL_CHANNELS = 7  # bits of red, green and blue
LEAST_FALLOFF, MOST_FALLOFF = 1e-6, 1e6


class Phase(NamedTuple):
    """The medium's phase function: `part` of it by Draine, the rest by Henyey-Greenstein (shaders/shared/phase.h)."""
    part: float
    asymmetry: float
    draine: float
    second: float  # asymmetry of the rest


@dataclass(frozen=True)
class Object:
    kind: str  # plane, box or sphere
    centre: Vec3  # m; of a plane y alone counts
    half_size: Vec3  # m; of a sphere x is the radius; of a plane x is its structure, 0 ... 1, and y that one's size, m
    yaw: float  # rad, of a box, about +y
    albedo: Vec3


@dataclass(frozen=True)
class Hue:
    """Channels in which the medium's extinction is the same, and the sun's light in them: in each particle a fit to the
    part that arrives, T(u) = middle + slope · u + u · M u. bend is the diagonal of M, twist its elements yz, zx and xy.
    u = (x - centre) / (√2 deviation) is a place in the particle."""
    channels: Tuple[int, ...]  # 0 for red, 1 for green, 2 for blue
    extinction: float  # factor on the particles' extinctions
    middle: Array = field(repr=False)  # n
    slope: Array = field(repr=False)  # n x 3
    bend: Array = field(repr=False)  # n x 3
    twist: Array = field(repr=False)  # n x 3

    def at(self, u: Array) -> Array:
        """The fit at places in the particles, ... x n x 3. It may be below 0 or above 1."""
        others = numpy.roll(u, -1, axis=-1) * numpy.roll(u, -2, axis=-1)  # y z, z x, x y
        fit: Array = self.middle + (self.slope * u + self.bend * u * u + 2 * self.twist * others).sum(axis=-1)
        return fit


@dataclass(frozen=True)
class Particles:
    """The medium of one tick: n Gaussian particles. What they have one by one are NumPy arrays of 32-bit floats."""
    number: int  # of the message; the server counts from 1, and a viewer gets some of them
    tick: int  # of the simulation, 60 a second
    hash: str  # of the simulation's state: equal for all viewers at equal ticks
    falloff: float  # extinction at the distance r from a centre: at the centre · exp(-50 r² / (scale falloff)²)
    to_light: Vec3  # direction to the sun, unit
    irradiance: Vec3  # of the sun
    phase: Phase
    ambient: Vec3  # radiance that comes from all sides
    emission: Vec3  # a particle emits max(1 - albedo / cold_albedo, 0) times this radiance
    cold_albedo: Vec3
    straight: Vec3  # with fluence: light that scatters straight on passes this part of the extinction
    mean_cosine: float  # with fluence: of the phase function
    zenith: Vec3  # radiance of the sky
    horizon: Vec3
    haze: float  # 1/m
    exposure: float
    filmic: bool  # True: the tone map is Narkowicz's curve
    objects: Tuple[Object, ...] = field(repr=False)  # surfaces
    predicted: Optional[float]  # relative RMSE of what the server's viewers draw of this; None: not known
    measured: Optional[Measured]  # the same, measured; None: not known
    _rows: columns.Rows = field(repr=False)
    _origin: Vec3 = field(repr=False)  # m
    _step: float = field(repr=False)  # m
    _hues: Tuple[Tuple[Tuple[int, ...], float], ...] = field(repr=False)  # channels and factor of each

    def __len__(self) -> int:
        return self._rows.count

    def _numbers(self, of: Callable[[Array], Array], first: int, count: int = 3) -> Array:
        return numpy.stack([of(self._rows.codes(first + i)) for i in range(count)], axis=-1)

    @cached_property
    def ids(self) -> Array:
        """n whole numbers of 64 bits: a particle has the same one in every message."""
        ids: Array = numpy.uint64(self._rows.first) + numpy.arange(len(self), dtype=numpy.uint64)
        return ids

    @cached_property
    def places(self) -> Array:
        """Centres, n x 3, m."""
        steps = self._numbers(lambda codes: codes.astype(float), columns.PLACE)
        places: Array = (numpy.array(self._origin) + self._step * steps).astype(numpy.float32)
        return places

    @cached_property
    def scales(self) -> Array:
        """n, m: from the centre to a vertex of the particle's tetrahedron."""
        return columns.of_log(self._rows.codes(columns.SCALE))

    @cached_property
    def deviations(self) -> Array:
        """Standard deviations, n, m."""
        deviations: Array = self.scales * numpy.float32(0.1 * self.falloff)
        return deviations

    @cached_property
    def extinctions(self) -> Array:
        """At the centres, n, 1/m, to be multiplied by `extinction_colour`."""
        return columns.of_log(self._rows.codes(columns.EXTINCTION))

    @cached_property
    def extinction_colour(self) -> Array:
        """Factors on `extinctions` in red, green and blue."""
        colour = numpy.zeros(3, numpy.float32)
        for channels, factor in self._hues:
            colour[list(channels)] = factor
        return colour

    @cached_property
    def albedos(self) -> Array:
        """n x 3."""
        return self._numbers(lambda codes: codes / numpy.float32(65_535), columns.ALBEDO)

    @cached_property
    def hues(self) -> Tuple[Hue, ...]:
        """Of each Hue the sun's light on the particles; one where the medium has no colour of its own."""
        def hue(at: int, channels: Tuple[int, ...], factor: float) -> Hue:
            slope, bend, twist = (self._numbers(columns.of_signed, at + i) for i in (1, 4, 7))
            return Hue(channels, factor, columns.of_root(self._rows.codes(at)), slope, bend, twist)
        return tuple(hue(columns.FIT + i * columns.FIT_COLUMNS, *one) for i, one in enumerate(self._hues))

    @cached_property
    def _lit_channels(self) -> List[int]:
        """First columns of fluence in red, green and blue; empty: no light scattered more than once."""
        at = [columns.FLUENCE + channel * columns.FLUENCE_COLUMNS for channel in range(3)]
        if self._rows.has(at[1]) or self._rows.has(at[2]):
            return at
        return [at[0]] * 3 if self._rows.has(at[0]) else []

    @cached_property
    def fluence(self) -> Optional[Array]:
        """Fluence of light that scattered more than once, in red, green and blue, for an irradiance of 1: 3 x n. None:
        the scene has no such light."""
        if not self._lit_channels:
            return None
        return numpy.stack([columns.of_log(self._rows.codes(at)) for at in self._lit_channels])

    @cached_property
    def flux(self) -> Optional[Array]:
        """Net flux of that light, along its travel, for an irradiance of 1: 3 x n x 3. None: the scene has no such
        light."""
        if self.fluence is None:
            return None
        parts = numpy.stack([self._numbers(columns.of_signed, at + 1) for at in self._lit_channels])
        flux: Array = parts * self.fluence[..., None]
        return flux

    def light_at(self, offsets: Union[Sequence[float], Array] = (0, 0, 0)) -> Array:
        """The part of the sun's light that arrives near the particles' centres, in red, green and blue.

        offsets: m, from each centre: three numbers for all particles, or n x 3, or ... x n x 3. Returns ... x n x 3
        numbers, each 0 ... 1. The fits hold within about two deviations of a centre.
        """
        per = numpy.zeros(len(self), numpy.float32)
        numpy.divide(numpy.float32(math.sqrt(0.5)), self.deviations, out=per, where=self.deviations > 0)
        u = numpy.asarray(offsets, numpy.float32) * per[:, None]
        light = numpy.empty(u.shape, numpy.float32)
        for hue in self.hues:
            light[..., list(hue.channels)] = hue.at(u).clip(0, 1)[..., None]
        return light


# ---- from messages ----


def _all_finite(what: str, numbers: Sequence[float]) -> Sequence[float]:
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f'{what} is not finite')
    return numbers


def _finite(what: str, number: float) -> float:
    return _all_finite(what, (number,))[0]


def _vector(what: str, told: Table) -> Vec3:
    if told is None:
        raise ValueError(f'{what} is missing')
    vector = vector_of(told)
    _all_finite(what, vector)
    return vector


def _hues(table: Table) -> Tuple[Tuple[Tuple[int, ...], float], ...]:
    count, seen = table.HuesLength(), 0
    hues: List[Tuple[Tuple[int, ...], float]] = []
    if not 1 <= count <= MOST_HUES:
        raise ValueError(f'they have {count} hues: 1 ... {MOST_HUES} are allowed')
    for told in map(table.Hues, range(count)):
        bits = told.Channels()
        if bits == 0 or bits & seen or bits & ~ALL_CHANNELS:
            raise ValueError('a hue has no channel, or one of another hue')
        seen |= bits
        factor = _finite("a hue's extinction", told.Extinction())
        if factor < 0:
            raise ValueError("a hue's extinction is below 0")
        hues.append((tuple(channel for channel in range(3) if bits >> channel & 1), factor))
    if seen != ALL_CHANNELS:
        raise ValueError('a channel is in no hue')
    return tuple(hues)


def _object(told: Table) -> Object:
    if told.Kind() >= len(KINDS):
        raise ValueError(f'an object has the kind {told.Kind()}')
    centre, half_size, albedo = (_vector("an object's place, size or albedo", of(WireVec3.Vec3()))
                                 for of in (told.Centre, told.HalfSize, told.Albedo))
    return Object(KINDS[told.Kind()], centre, half_size, _finite("an object's yaw", told.Yaw()), albedo)


def _objects(table: Table) -> Tuple[Object, ...]:
    count = table.ObjectsLength()
    if count > MOST_OBJECTS:
        raise ValueError(f'{count} objects are with them: at most {MOST_OBJECTS} are allowed')
    return tuple(_object(table.Objects(i)) for i in range(count))


def _phase(table: Table) -> Phase:
    if table.PhaseLength() != len(Phase._fields):
        raise ValueError(f'their phase function has {table.PhaseLength()} numbers: {len(Phase._fields)} are due')
    return Phase(*_all_finite('the phase function', [table.Phase(i) for i in range(len(Phase._fields))]))


def _particles(table: Table, data: bytes, held: columns.Held) -> Particles:
    if table.Bytes() != len(data):
        raise ValueError(f'{len(data)} bytes follow them: {table.Bytes()} are told')
    origin, step, falloff = _vector('origin', table.Origin()), table.Step(), table.Falloff()
    with numpy.errstate(over='ignore'):
        farthest = numpy.float32(max(abs(one) for one in origin) + 65_535 * abs(step))
    if not numpy.isfinite(farthest) or step < 0:
        raise ValueError('their places are not finite')
    if not LEAST_FALLOFF <= falloff <= MOST_FALLOFF:
        raise ValueError(f'falloff is {falloff}: {LEAST_FALLOFF:g} ... {MOST_FALLOFF:g} is allowed')
    cold_albedo = _vector('cold_albedo', table.ColdAlbedo()) if table.ColdAlbedo() else (1.0, 1.0, 1.0)
    if min(cold_albedo) <= 0:
        raise ValueError(f'cold_albedo is {cold_albedo}: it is above 0')
    error = _all_finite('an error', (table.Measured(), table.MeasuredLow(), table.MeasuredHigh()))
    rows = held.take(table.Number(), table.Reference(), table.First(), table.Count(), table.Present(), data)
    return Particles(
        number=table.Number(), tick=table.Tick(), hash=f'{table.StateHash():016x}', falloff=falloff,
        to_light=_vector('to_light', table.ToLight()), irradiance=_vector('irradiance', table.Irradiance()),
        phase=_phase(table), ambient=_vector('ambient', table.Ambient()),
        emission=_vector('emission', table.Emission()) if table.Emission() else (0.0, 0.0, 0.0),
        cold_albedo=cold_albedo,
        straight=_vector('straight', table.Straight()), mean_cosine=_finite('mean_cosine', table.MeanCosine()),
        zenith=_vector('zenith', table.Zenith()), horizon=_vector('horizon', table.Horizon()),
        haze=_finite('haze', table.Haze()), exposure=_finite('exposure', table.Exposure()),
        filmic=bool(table.Filmic()), objects=_objects(table),
        predicted=_finite('predicted', table.Predicted()) or None,
        measured=Measured(*error) if error[0] > 0 else None, _hues=_hues(table), _rows=rows,
        _origin=origin, _step=step)


class Reader:
    """Reads the LitParticles of one connection, all of them in their order."""

    def __init__(self) -> None:
        self._held = columns.Held()

    def read(self, table: Table, data: bytes) -> Particles:
        """The Particles of a message and the bytes behind it. Raises BrumeError if they are not as they should be;
        messages that refer to those cannot be read then, either."""
        try:
            return _particles(table, data, self._held)
        except (AttributeError, IndexError, OverflowError, TypeError, ValueError, struct.error, zlib.error) as error:
            raise BrumeError(f'the server sent particles that cannot be read: {error}') from error
