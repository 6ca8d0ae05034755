#!/usr/bin/env python3
"""Particles that a program sets through the Python package: python_live.py SERVER PACKAGE. Exit status 77: a package of
the distribution is missing."""
import pathlib
import sys
import tempfile
import time
import unittest

from python_server import PATIENCE, Serving, brume, numpy


class Live(Serving):
    def live(self, rows):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scene = pathlib.Path(folder.name) / 'live.toml'
        scene.write_text(f'[medium]\nlayout = "live"\ncount = {rows}\nextinction = 1\n')
        return self.serve('--scene', scene)

    def test_particles_of_a_simulation_elsewhere(self):
        server = self.live(7000)
        with brume.connect(server.url, size=(96, 64), timeout=PATIENCE) as view:
            view.look(position=(0, 0, 30), target=(0, 0, 0))
            empty = view.frame().array().astype(float)
            # More than two messages, each below 64 KiB; with albedos more than three.
            places = numpy.random.default_rng(1).uniform(-4, 4, (7000, 3))
            for albedos in (None, numpy.tile((1.0, 0.1, 0.1), (7000, 1))):
                view.set_particles(places, 0.6, numpy.full(7000, 3.0), albedos)
                self.assertEqual(self.particles(view), 7000)
            view.pause()
            red = view.frame().array().astype(float)
            middle = red[28:36, 44:52]
            self.assertGreater(abs(middle - empty[28:36, 44:52]).mean(), 10, 'they are seen')
            self.assertGreater(middle[..., 0].mean(), 1.3 * middle[..., 2].mean(), 'and are red')
            # The same by lists, and fewer of them; then none.
            view.set_particles([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [1, 1, 2], 5, seconds=0.1)
            self.assertEqual(self.particles(view), 3)
            view.set_particles([], [], [])
            self.assertEqual(self.particles(view), 0)

    def particles(self, view):
        """How many there are a second later, which the server reports."""
        tick, deadline = view.state.tick, time.monotonic() + PATIENCE
        while view.state.tick < tick + 30 and time.monotonic() < deadline:
            time.sleep(0.02)
        return view.state.particles

    def test_particles_that_cannot_be_set(self):
        server = self.live(10)
        with brume.connect(server.url, size=(96, 64)) as view:
            for line, act in (('medium.count = 10 rows', lambda: view.set_particles([(0, 0, 0)] * 11, 1, 1)),
                              ('the scale of row 0', lambda: view.set_particles([(0, 0, 0)], -1, 1)),
                              ('pushes move nothing here', lambda: view.push((0, 0, 0), (0, 0, 1)))):
                with self.assertRaisesRegex(brume.BrumeError, line):
                    act()
            with self.assertRaisesRegex(brume.BrumeError, '2 numbers of scales for 1 particles: 1 each'):
                view.set_particles([(0, 0, 0)], [1, 2], 1)

    def test_a_scene_of_its_own_takes_no_particles(self):
        with brume.connect(self.serve().url, size=(96, 64)) as view:
            with self.assertRaisesRegex(brume.BrumeError, 'sets its own particles'):
                view.set_particles([(0, 0, 0)], 1, 1)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
