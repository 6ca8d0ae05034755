"""Columns of LitParticles: particles and the light on them as whole numbers, and how messages pack them. What each
column is: protocol/lit_particles.h. Needs NumPy."""
from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import List, Optional, Tuple

import numpy

from brume.kinds import Array

PLACE, SCALE, EXTINCTION, ALBEDO, FIT, FLUENCE, COLUMNS = 0, 3, 4, 5, 8, 38, 50
FIT_COLUMNS, FLUENCE_COLUMNS = 10, 4  # of each hue, of each channel
MOST_PARTICLES = 65_536  # of a message
LAYERS = 4  # of message numbers

# Numbers of codes.
_OF_LOG = numpy.exp2(numpy.arange(65_536) / 1024 - 32).astype(numpy.float32)
_OF_LOG[0] = 0


def of_log(codes: Array) -> Array:
    """Numbers from 2^-32 to 2^32, and 0."""
    numbers: Array = _OF_LOG[codes]
    return numbers


def of_root(codes: Array) -> Array:
    """Numbers from 0 to 1, finer near 0."""
    numbers: Array = numpy.square(codes / numpy.float32(255))
    return numbers


def of_signed(codes: Array) -> Array:
    """Numbers from -1 to 1, finer near 0."""
    part: Array = codes.astype(numpy.uint8).view(numpy.int8) / numpy.float32(127)
    numbers: Array = part * abs(part)
    return numbers


@dataclass(frozen=True)
class Rows:
    """Particles first, first + 1 ... first + count - 1."""
    first: int
    count: int
    columns: Tuple[Optional[Array], ...]  # of each an array of `count` codes, 16 bits each; None: all are 0

    def codes(self, column: int) -> Array:
        codes = self.columns[column]
        return numpy.zeros(self.count, numpy.uint16) if codes is None else codes

    def has(self, column: int) -> bool:
        """True: some code of it is not 0."""
        codes = self.columns[column]
        return codes is not None and bool(codes.any())

    def meant_for(self, column: int, first: int, count: int) -> Optional[Array]:
        """Codes of other particles: 0 of those that are not among these. None: the column is not there."""
        known = self.columns[column]
        if known is None:
            return None
        codes = numpy.zeros(count, numpy.uint16)
        begin, end = max(first, self.first), min(first + count, self.first + self.count)
        if begin < end:
            codes[begin - first:end - first] = known[begin - self.first:end - self.first]
        return codes


def _is_wide(column: int) -> bool:
    """True: a code has 16 bits; False: 8."""
    return column < FIT or (column >= FLUENCE and (column - FLUENCE) % FLUENCE_COLUMNS == 0)


def _inflated(data: bytes, size: int) -> bytes:
    """What zlib packed, of exactly so many bytes. No more than those are ever made."""
    stream = zlib.decompressobj()
    plain = stream.decompress(data, size + 1)
    if len(plain) > size:
        raise ValueError(f'their columns have more than {size} bytes')
    if not stream.eof:
        raise ValueError('their columns end too early')
    if len(plain) < size:
        raise ValueError(f'their columns have {len(plain)} bytes: {size} are due')
    if stream.unused_data:
        raise ValueError(f'{len(stream.unused_data)} bytes follow their columns')
    return plain


def unpack(first: int, count: int, present: int, data: bytes, reference: Optional[Rows] = None) -> Rows:
    """The Rows of a message, which has these numbers and packed bytes. reference: Rows of the message that it names.
    Raises ValueError or zlib.error for bytes that are not exactly those of its columns."""
    if count > MOST_PARTICLES:
        raise ValueError(f'they are {count}: at most {MOST_PARTICLES} are allowed')
    if first + count > 1 << 64:
        raise ValueError('their ids are beyond 64 bits')
    if present >> COLUMNS:
        raise ValueError(f'they have a column beyond {COLUMNS}')
    there = [present >> column & 1 for column in range(COLUMNS)]
    size = sum((2 if _is_wide(column) else 1) * count for column in range(COLUMNS) if there[column])
    plain, at = numpy.frombuffer(_inflated(data, size), numpy.uint8), 0
    columns: List[Optional[Array]] = []
    for column in range(COLUMNS):
        codes = reference.meant_for(column, first, count) if reference is not None else None
        if there[column]:
            folded: Array = plain[at:at + count].astype(numpy.uint16)
            at += count
            if _is_wide(column):
                folded = folded | plain[at:at + count].astype(numpy.uint16) << numpy.uint16(8)
                at += count
            change = (folded >> 1) ^ numpy.negative(folded & 1)  # small changes, up or down, come as small numbers
            changed: Array = change if codes is None else codes + change
            codes = changed & numpy.uint16(0xffff if _is_wide(column) else 0xff)
        columns.append(codes)
    return Rows(first, count, tuple(columns))


class Held:
    """Rows of earlier messages, which later ones are changes to: of each layer of message numbers the newest. Whoever
    leaves out the lower layers, and so gets each second, fourth or eighth message, misses no reference."""

    def __init__(self) -> None:
        self._rows: List[Tuple[int, Optional[Rows]]] = [(0, None)] * LAYERS

    @staticmethod
    def layer(number: int) -> int:
        """How often two divides it, at most 3."""
        return min((number & -number).bit_length(), LAYERS) - 1

    def take(self, number: int, reference: int, first: int, count: int, present: int, data: bytes) -> Rows:
        """The Rows of message `number`, which are held from now on. reference: number of the message that it is
        changes to; 0: it is whole. Raises as unpack() does."""
        if number == 0:
            raise ValueError('their number is 0')
        held, rows = self._rows[self.layer(reference)] if reference else (0, None)
        if held != reference:
            raise ValueError(f'they are changes to those of message {reference}, which are not held')
        made = unpack(first, count, present, data, rows)
        self._rows[self.layer(number)] = (number, made)
        return made
