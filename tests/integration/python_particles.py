#!/usr/bin/env python3
"""Particles with their light through the Python package: python_particles.py SERVER PACKAGE. Exit status 77: a package
of the distribution is missing."""
import contextlib
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
import urllib.request

from python_server import COLD, PATIENCE, Serving, brume, numpy, package

from brume import splats


class Drawn(Serving):
    """The particles of a real server."""

    def viewer(self, *options):
        view = brume.connect(self.serve(*options).url, timeout=COLD, draw_hz=30)
        self.addCleanup(view.close)
        return view

    def test_a_cloud_and_the_suns_light_in_it(self):
        view = self.viewer()
        ticks = [lit.tick for lit in view.particle_stream(30)]
        self.assertEqual(ticks, sorted(set(ticks)), 'each newer than the one before')
        view.pause()
        lit, state = view.particles(), view.state
        self.assertEqual((len(lit), lit.hash, state.particles), (500, state.hash, 500))
        self.assertIsNone(state.not_drawable)
        reach = 2 * lit.deviations[:, None] - 0.01  # m; places are rounded
        self.assertTrue((lit.places - reach >= state.box[0]).all() and (lit.places + reach <= state.box[1]).all())
        numpy.testing.assert_allclose(lit.scales, 6, rtol=4e-4)
        numpy.testing.assert_allclose(lit.irradiance, (16, 15.2, 13.8), rtol=1e-6)
        self.assertIs(view.particles(), lit, 'a scene at rest')
        for offset in ((0, 0, 0), (0.5, 0, 0), (0, -0.4, 0.5)):  # m; a deviation is 0.96 m
            fit, true = lit.light_at(offset)[::10, 1], self.arriving(lit, lit.places[::10] + offset)
            self.assertLess(math.sqrt(((fit - true) ** 2).mean()), 0.02, offset)
        with self.assertRaisesRegex(brume.BrumeError, 'this viewer gets particles in place of pictures'):
            view.frame()

    def arriving(self, lit, places):
        """The part of the sun's light there, from the sum of all Gaussians on the way."""
        apart = lit.places[None].astype(float) - places[:, None]
        along = apart @ numpy.array(lit.to_light)
        aside = (apart ** 2).sum(axis=-1) - along ** 2
        before = 0.5 + 0.5 * numpy.vectorize(math.erf)(along / (math.sqrt(2) * lit.deviations))
        through_centre = lit.extinctions * math.sqrt(2 * math.pi) * lit.deviations
        lines = through_centre * numpy.exp(-0.5 * aside / lit.deviations ** 2)
        return numpy.exp(-(lines * before).sum(axis=-1))

    def test_light_that_scatters_more_than_once(self):
        lit = self.viewer('--set', 'render.scattering=propagation').particles()
        self.assertEqual((lit.fluence.shape, lit.flux.shape), ((3, 500), (3, 500, 3)))
        self.assertTrue((lit.fluence > 0).all() and (lit.fluence < 10).all(), 'for an irradiance of 1')
        self.assertTrue((numpy.linalg.norm(lit.flux, axis=2) <= lit.fluence).all())
        self.assertLess((lit.flux @ numpy.array(lit.to_light)).mean(), 0, 'it goes away from the sun')
        self.assertIsNone(self.viewer().particles().fluence)

    def test_a_setting_is_in_the_next_particles(self):
        view = self.viewer()
        for paused in (False, True):
            view.pause(paused)
            before = view.particles()
            for extinction in (26, 52):
                view.set('medium.extinction', extinction)
                lit = view.particles()
                numpy.testing.assert_allclose(lit.extinctions, before.extinctions * extinction / 52, rtol=1e-3)
            view.set('medium.extinction_colour', (1, 0.5, 0.5))
            lit = view.particles()
            self.assertEqual(lit.extinction_colour.tolist(), [1, 0.5, 0.5])
            self.assertEqual([hue.channels for hue in lit.hues], [(0,), (1, 2)])
            self.assertGreater(lit.light_at()[:, 1].mean(), lit.light_at()[:, 0].mean(), 'green passes better')
            view.set('medium.extinction_colour', (1, 1, 1))
        view.resume()

    def test_particles_of_a_plume_are_born_and_die(self):
        view = self.viewer('--scene', 'plume', '--set', 'medium.emitter.life=1')
        born = died = 0
        last = None
        deadline = time.monotonic() + PATIENCE
        while born < 100 or died < 100:
            self.assertLess(time.monotonic(), deadline)
            lit = view.particles()
            both = last and numpy.intersect1d(lit.ids, last.ids, return_indices=True)
            if both and lit.tick < last.tick + 10:
                moved = numpy.linalg.norm(lit.places[both[1]] - last.places[both[2]], axis=1)
                self.assertLess(moved.max(initial=0), 2, 'm')
                born, died = born + len(lit) - len(both[0]), died + len(last) - len(both[0])
            last = lit
        self.assertEqual([one.kind for one in lit.objects], ['plane'])
        self.assertLess(lit.places[:, 1].max(), view.state.box[1][1] + 3)

    def test_scenes_that_the_server_alone_can_draw_say_why(self):
        view = self.viewer('--scene', 'dusk')
        with self.assertRaisesRegex(brume.BrumeError, 'the server alone can draw this scene: it has fog'):
            view.particles()
        self.assertEqual(view.state.not_drawable, 'it has fog')
        self.assertGreater(numpy.std(view.frame().array()), 2, 'pictures come in their place')
        view.show_scene('cloud')
        self.assertEqual(len(view.particles()), 500)
        view.show_scene('dusk')
        with self.assertRaisesRegex(brume.BrumeError, 'it has fog'):
            view.particles()

    def test_none_come_for_a_viewer_that_does_not_ask(self):
        server = self.serve()
        with brume.connect(server.url, draw_hz=30, timeout=COLD) as view:
            first = view.particles()
            deadline = time.monotonic() + PATIENCE
            while True:  # until a second without any
                known, begin = view._link.particles, server.metric('brume_tick_seconds_count')
                while server.metric('brume_tick_seconds_count') < begin + 60:
                    time.sleep(0.05)
                if view._link.particles is known:
                    break
                self.assertLess(time.monotonic(), deadline, 'particles for nobody')
            again = view.particles()
            self.assertGreater(again.tick, known.tick + 30, 'not what was left')
            self.assertGreater(known.tick, first.tick)

    def test_a_new_connection_begins_with_whole_rows(self):
        server = self.serve()
        with brume.connect(server.url, draw_hz=60, timeout=COLD) as view:
            for lit in view.particle_stream(20):
                self.assertEqual(len(lit), 500)
            with unittest.mock.patch('brume.columns.unpack', side_effect=ValueError('torn')):
                with self.assertRaisesRegex(brume.BrumeError, 'the server sent particles that cannot be read: torn'):
                    for _ in view.particle_stream():
                        pass
            for _ in range(100):  # the tries of the meantime have failed, too
                with contextlib.suppress(brume.BrumeError):
                    self.assertEqual(len(view.particles()), 500)
                    break
            else:
                self.fail('it goes on failing')
            reader = view._link._reader
            server.stop(kill=True)
            again = self.serve('--port', server.port)
            with view._link.changed:
                self.assertTrue(view._link.changed.wait_for(lambda: view._link._reader is not reader, PATIENCE))
            self.assertEqual(len(view.particles()), 500)
            again.stop()

    def test_the_lit_cloud_becomes_splats_that_are_read_back(self):
        server = self.serve('--paused')
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / 'lit.ply'
            with brume.connect(server.url, draw_hz=30, timeout=COLD) as view:
                lit = view.particles()
                splats.save(path, lit)
                box = view.state.box
            shown = splats.colours(lit)
            self.assertGreater(shown.max() - shown.min(), 0.1, 'some lie in shadow')
            upload = urllib.request.Request(f'{server.url}/cloud?name=lit', path.read_bytes(), method='POST',
                                            headers={'Accept': 'application/json'})
            answer = json.load(urllib.request.urlopen(upload))
            self.assertEqual(answer['points'], 500)
            self.assertIn('Gaussian splatting', ' '.join(answer['notes']))
            with brume.connect(server.url, draw_hz=30, timeout=COLD) as view:
                again = view.particles()
                self.assertTrue(numpy.allclose(view.state.box, box, atol=0.02))
        for name in ('places', 'deviations', 'extinctions'):
            self.assertTrue(numpy.allclose(getattr(again, name), getattr(lit, name), rtol=2e-3, atol=2e-3), name)
        self.assertTrue(numpy.allclose(again.albedos, shown, atol=1e-3), 'their light is their albedo now')

    def test_what_is_asked_for_and_what_it_needs(self):
        url = self.serve().url
        with brume.connect(url) as view:
            with self.assertRaisesRegex(brume.BrumeError, r'connect\(draw_hz=30\)'):
                view.particles()
        for wrong in (-1, 61, 0.5):
            with self.assertRaisesRegex(brume.BrumeError, 'allowed are whole numbers from 0 to 60'):
                brume.connect(url, draw_hz=wrong)
        with unittest.mock.patch.dict(sys.modules, {'numpy': None}):
            with self.assertRaisesRegex(brume.BrumeError, 'python3-numpy'):
                brume.connect(url, draw_hz=30)

    def test_the_example_runs_as_it_is(self):
        text = (pathlib.Path(package) / 'README.md').read_text('utf-8')
        (example,) = (one for one in re.findall(r'```python\n(.*?)```', text, re.S) if 'draw_hz' in one)
        code = f'import sys; sys.path.insert(0, {package!r})\n' + example
        code = code.replace('http://127.0.0.1:8080', self.serve().url)
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, '-c', code], cwd=folder, timeout=COLD, text=True,
                                  stdout=subprocess.PIPE, check=True)
            self.assertIn('particles 500', done.stdout)
            for name in ('cloud.png', 'depth.png'):
                self.assertTrue((pathlib.Path(folder) / name).read_bytes().startswith(b'\x89PNG'))


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
