#!/usr/bin/env python3
"""Messages with lit particles, read by the Python package alone: python_particle_messages.py SERVER PACKAGE. Exit
status 77: a package of the distribution is missing."""
import math
import random
import sys
import unittest
import zlib

from python_server import brume, numpy

import flatbuffers
from brume import messages
from brume.particles import Reader
from brume.wire import Body, Hue, LitParticles, Message, Object, Vec3

ONE = 32 * 1024  # code of 1 in columns of scales, extinctions and fluences


def is_wide(column):
    return column < 8 or column in (38, 42, 46)


def layer(number):
    return next((i for i in range(3) if number >> i & 1), 3)


def reference_of(number):
    """The message that the server's message is changes to; 0: none."""
    return number & (number - 1) if layer(number) < 3 else max(number - 8, 0)


def packed(rows, before):
    """(columns that are there, plain bytes) of rows: by id a dictionary of codes by column."""
    present, plain = 0, b''
    for column in range(50):
        bits = 16 if is_wide(column) else 8
        folded = []
        for number, codes in rows.items():
            change = (codes.get(column, 0) - before.get(number, {}).get(column, 0)) % (1 << bits)
            is_down = change >> (bits - 1)
            folded.append((2 * ((1 << bits) - change) - 1) if is_down else 2 * change)
        if any(folded):
            present |= 1 << column
            plain += bytes(one & 255 for one in folded) + (bytes(one >> 8 for one in folded) if bits == 16 else b'')
    return present, plain


def message(rows, before=None, *, number=1, reference=0, hues=((7, 1.0),), objects=(), phase=(0.25, 0.5, 0, -0.5),
            **told):
    """Bytes of a message. told: fields in place of the usual ones; `data`: the packed columns in place of them."""
    present, plain = packed(rows, before or {})
    data = told.pop('data', zlib.compress(plain))
    numbers = dict(Number=number, Reference=reference, First=min(rows, default=0), Count=len(rows), Present=present,
                   Step=0.5, Falloff=2.0, Bytes=len(data)) | told
    b = flatbuffers.Builder(1024)
    LitParticles.StartHuesVector(b, len(hues))
    for channels, extinction in reversed(hues):
        Hue.CreateHue(b, channels, extinction)
    hue_vector = b.EndVector()
    LitParticles.StartObjectsVector(b, len(objects))
    for kind in reversed(objects):
        Object.CreateObject(b, kind, 1, 2, 3, 4, 5, 6, 0.5, 0.25, 0.5, 0.75)
    object_vector = b.EndVector()
    LitParticles.StartPhaseVector(b, len(phase))
    for one in reversed(phase):
        b.PrependFloat32(one)
    phase_vector = b.EndVector()
    vectors = {name: numbers.pop(name, (1, 2, 3)) for name in
               ('Origin', 'ToLight', 'Irradiance', 'Ambient', 'Straight', 'Zenith', 'Horizon', 'ColdAlbedo')}
    LitParticles.Start(b)
    for name, value in numbers.items():
        getattr(LitParticles, f'Add{name}')(b, value)
    for name, value in vectors.items():
        if value:
            getattr(LitParticles, f'Add{name}')(b, Vec3.CreateVec3(b, *value))
    LitParticles.AddPhase(b, phase_vector)
    LitParticles.AddHues(b, hue_vector)
    LitParticles.AddObjects(b, object_vector)
    body = LitParticles.End(b)
    Message.Start(b)
    Message.AddBodyType(b, Body.Body.LitParticles)
    Message.AddBody(b, body)
    b.FinishSizePrefixed(Message.End(b), b'BRM1')
    return bytes(b.Output()) + data


def read(data, reader=None):
    kind, table, rest = messages.read(data)
    assert kind == 'LitParticles', kind
    return (reader or Reader()).read(table, rest)


class Messages(unittest.TestCase):
    """Bytes that are made here."""

    def codes_of(self, particles):
        return {int(number): {column: int(codes[i]) for column, codes in enumerate(particles._rows.columns)
                              if codes is not None and codes[i]} for i, number in enumerate(particles.ids)}

    def test_numbers_of_codes(self):
        codes = {0: 4, 1: 65535, 3: ONE, 4: ONE + 1024, 5: 65535, 8: 255, 9: 127, 12: 129, 15: 64}
        lit = read(message({2 ** 64 - 2: codes, 2 ** 64 - 1: {}}, objects=(0, 2), Tick=7, StateHash=255, Measured=0.5))
        self.assertEqual((len(lit), lit.tick, lit.hash, lit.number), (2, 7, '00000000000000ff', 1))
        self.assertEqual([int(one) for one in lit.ids], [2 ** 64 - 2, 2 ** 64 - 1])
        self.assertEqual(lit.places.tolist(), [[3, 2 + 65535 / 2, 3], [1, 2, 3]])
        self.assertEqual((lit.scales.tolist(), lit.extinctions.tolist()), ([1, 0], [2, 0]))
        numpy.testing.assert_allclose(lit.deviations, [0.2, 0])
        self.assertEqual(lit.albedos.tolist(), [[1, 0, 0], [0, 0, 0]])
        (hue,) = lit.hues
        self.assertEqual((hue.channels, hue.middle.tolist(), hue.slope[0].tolist()), ((0, 1, 2), [1, 0], [1, 0, 0]))
        self.assertEqual(hue.bend[0].tolist(), [-1, 0, 0])
        numpy.testing.assert_allclose(hue.twist[0], [(64 / 127) ** 2, 0, 0])
        self.assertEqual((lit.phase.second, lit.zenith), (-0.5, (1, 2, 3)))
        self.assertEqual((lit.predicted, lit.measured.error), (None, 0.5))
        self.assertEqual([one.kind for one in lit.objects], ['plane', 'sphere'])
        self.assertEqual((lit.objects[0].centre, lit.objects[0].half_size), ((1, 2, 3), (4, 5, 6)))
        for array in (lit.places, lit.scales, lit.deviations, lit.extinctions, lit.albedos, hue.middle, lit.light_at()):
            self.assertEqual(array.dtype, numpy.float32)
        self.assertEqual(read(message({})).light_at().shape, (0, 3))

    def test_light_is_a_fit_around_each_centre(self):
        fit = {8: 180, 9: 20, 10: 236, 11: 30, 12: 10, 13: 250, 14: 12, 15: 25, 16: 9, 17: 240}
        lit = read(message({0: {3: ONE, **fit}, 1: {3: ONE + 1024, **fit}}))
        (hue,) = lit.hues
        matrix = numpy.diag(hue.bend[0].astype(float))
        for (i, j), x in zip(((1, 2), (2, 0), (0, 1)), hue.twist[0]):
            matrix[i, j] = matrix[j, i] = x
        for offset in numpy.random.default_rng(1).uniform(-0.3, 0.3, (20, 3)):
            for i, scale in enumerate((1, 2)):
                u = math.sqrt(50) / (scale * 2) * offset
                true = hue.middle[0] + hue.slope[0] @ u + u @ matrix @ u
                numpy.testing.assert_allclose(lit.light_at(offset)[i], [min(max(true, 0), 1)] * 3, atol=1e-6)
        self.assertEqual(lit.light_at(numpy.zeros((5, 1, 3))).shape, (5, 2, 3))

    def test_hues_and_light_that_scattered_more_than_once(self):
        rows = {0: {8: 255, 18: 51, 38: ONE, 39: 127, 41: 129}}
        lit = read(message(rows, hues=((4, 2.0), (3, 0.5))))
        self.assertEqual(lit.extinction_colour.tolist(), [0.5, 0.5, 2])
        numpy.testing.assert_allclose(lit.light_at()[0], [0.04, 0.04, 1], rtol=1e-6)
        self.assertEqual(lit.fluence.tolist(), [[1]] * 3, 'red is of all')
        self.assertEqual(lit.flux.tolist(), [[[1, 0, -1]]] * 3)
        lit = read(message({0: {38: ONE, 46: ONE + 1024, 47: 127}}))
        self.assertEqual((lit.fluence.tolist(), lit.flux[2].tolist()), ([[1], [0], [2]], [[2, 0, 0]]))
        lit = read(message({0: {8: 1}}))
        self.assertIsNone(lit.fluence)
        self.assertIsNone(lit.flux)

    def test_changes_births_and_deaths(self):
        for every in (1, 2, 4, 8):
            random.seed(every)
            reader, sent, rows = Reader(), {}, {1000 + i: {} for i in range(9)}
            for number in range(1, 60):
                rows = dict(list(rows.items())[random.choice((0, 0, 2)):])  # the oldest die
                newest = max(rows, default=number)
                rows |= {newest + 1 + i: {} for i in range(random.choice((0, 0, 3)))}
                if number == 30:
                    rows = {5: {}, 6: {}}  # another scene: others of lower ids
                rows = {one: codes | {column: random.randrange(1 << (16 if is_wide(column) else 8))
                                      for column in random.sample((0, 3, 8, 12, 49), 2)} for one, codes in rows.items()}
                sent[number] = rows
                if number % every:
                    continue
                reference = reference_of(number)
                lit = read(message(rows, sent.get(reference), number=number, reference=reference), reader)
                kept = {one: {column: code for column, code in codes.items() if code} for one, codes in rows.items()}
                self.assertEqual(self.codes_of(lit), kept, number)

    def test_what_is_not_held(self):
        row = {0: {0: 1}}
        reader = Reader()
        read(message(row), reader)
        for number in (2, 3):
            read(message(row, row, number=number, reference=1 if number == 2 else 2), reader)
        for reference in (1, 8, 9):  # 3 took the place of 1
            with self.assertRaisesRegex(brume.BrumeError, f'to those of message {reference}, which are not held'):
                read(message(row, row, number=4, reference=reference), reader)
        self.assertEqual(self.codes_of(read(message(row, row, number=5, reference=3), reader)), row)

    def test_what_cannot_be_read_is_said_in_one_line(self):
        rows = {0: {0: 1, 9: 1}, 1: {}}
        plain = packed(rows, {})[1]
        nan, far = float('nan'), 3e38
        for line, told in (
                ('they are 65537: at most 65536', dict(Count=65537)), ('beyond 64 bits', dict(First=2 ** 64 - 1)),
                ('a column beyond 50', dict(Present=1 << 50)), ('have more than 4 bytes', dict(Present=1)),
                ('have 6 bytes: 8 are due', dict(Present=3)),
                ('end too early', dict(data=zlib.compress(plain)[:-1])), ('end too early', dict(data=b'')),
                ('1 bytes follow their columns', dict(data=zlib.compress(plain) + b'x')),
                ('incorrect', dict(data=zlib.compress(plain)[:-1] + b'x')), ('incorrect header', dict(data=b'none')),
                ('have more than 6 bytes', dict(data=zlib.compress(bytes(10 ** 8)))),
                ('bytes follow them: 5 are told', dict(Bytes=5)), ('their number is 0', dict(number=0)),
                ('origin is missing', dict(Origin=None)), ('to_light is not finite', dict(ToLight=(nan, 0, 0))),
                ('cold_albedo is .*above 0', dict(ColdAlbedo=(1, 0, 1))),
                ('places are not finite', dict(Step=nan)),
                ('places are not finite', dict(Origin=(far, 0, 0), Step=far)),
                ('falloff is 0', dict(Falloff=0)), ('falloff is inf', dict(Falloff=math.inf)),
                ('haze is not finite', dict(Haze=math.inf)), ('0 hues: 1 ... 3', dict(hues=())),
                ('4 hues', dict(hues=((1, 1), (2, 1), (4, 1), (4, 1)))),
                ('or one of another', dict(hues=((3, 1), (6, 1)))),
                ('no channel', dict(hues=((0, 1), (7, 1)))), ('in no hue', dict(hues=((3, 1),))),
                ("hue's extinction is not", dict(hues=((7, nan),))), ('is below 0', dict(hues=((7, -1),))),
                ('65 objects', dict(objects=(1,) * 65)), ('the kind 3', dict(objects=(3,))),
                ('has 3 numbers: 4', dict(phase=(0, 0, 0))), ('phase function is not', dict(phase=(0, 0, 0, nan)))):
            line = 'the server sent particles that cannot be read: .*' + line
            with self.assertRaisesRegex(brume.BrumeError, line) as caught:
                read(message(rows, **told))
            self.assertNotIn('\n', str(caught.exception))

    def test_broken_bytes_are_refused_and_nothing_else_happens(self):
        random.seed(1)
        whole = message({i: {0: i, 8: i} for i in range(20)}, objects=(0, 1))
        refused = 0
        for _ in range(3000):
            data = bytearray(whole)
            for _ in range(random.choice((1, 1, 4))):
                data[random.randrange(len(data))] = random.choice((0, 1, 127, 128, 255, random.randrange(256)))
            del data[random.choice((len(data), random.randrange(len(data)))):]
            try:
                kind, table, rest = messages.read(bytes(data))
                if kind == 'LitParticles':
                    self.assertTrue(numpy.isfinite(Reader().read(table, rest).places).all())
            except brume.BrumeError:
                refused += 1
        self.assertGreater(refused, 1000)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
