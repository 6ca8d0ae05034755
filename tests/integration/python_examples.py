#!/usr/bin/env python3
"""The examples of the Python package as they are, against real servers: python_examples.py SERVER PACKAGE. Exit status
77: a package of the distribution is missing."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

from python_server import COLD, Serving, brume, numpy, package
from PIL import Image

LONGEST = 40  # lines of an example


class Examples(Serving):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def example(self, name, *arguments):
        path = pathlib.Path(package) / 'examples' / f'{name}.py'
        self.assertLess(len(path.read_text().splitlines()), LONGEST, name)
        done = subprocess.run([sys.executable, path, *arguments], cwd=self.folder, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=COLD, check=False,
                              env={'PYTHONPATH': package, 'PATH': ''})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def test_a_turntable_has_one_state_and_its_error_is_measured(self):
        lines = self.example('turntable', self.serve('--measure-error', '1').url)
        views, (predicted, measured) = lines[:12], lines[12:]
        self.assertEqual(len({line.split('state ')[1].split(',')[0] for line in views}), 1, views)
        pictures = numpy.load(self.folder / 'turntable.npy')
        self.assertEqual(pictures.shape, (12, 180, 320, 3))
        for i in range(12):
            self.assertGreater(pictures[i].std(), 2, 'a picture of something')
            self.assertGreater(abs(pictures[i].astype(int) - pictures[i - 1]).mean(), 0.2, 'seen from elsewhere')
        self.assertRegex(predicted, r'^error predicted: \d+\.\d\d%$')
        error, low, high = (float(word[:-1]) for word in measured.replace(',', '').split(' ')[2:6] if word != 'to')
        self.assertTrue(0 < low < error < high < 20, measured)

    def test_a_simulation_shows_its_particles_to_others(self):
        scene = self.folder / 'live.toml'
        scene.write_text('[medium]\nlayout = "live"\ncount = 1000\nextinction = 1\n')
        server = self.serve('--scene', scene)
        with brume.connect(server.url, size=(96, 64), timeout=COLD) as other:
            other.look(position=(0, 2, 30), target=(0, 0, 0))
            empty = other.frame().array().astype(int)
            (line,) = self.example('simulation', server.url, '2')
            self.assertRegex(line, r'^800 particles at tick \d+$')
            self.assertGreater(abs(other.frame().array() - empty).mean(), 3, 'they are seen')

    def test_a_sweep_is_a_sheet_of_all_values_from_all_sides(self):
        server = self.serve()
        with brume.connect(server.url, size=(96, 64), timeout=COLD) as other:
            before = other.state.settings['medium.extinction']
            self.example('sweep', server.url)
            self.assertEqual(other.frame().width, 96)  # a state that is newer than the sweep
            self.assertEqual(other.state.settings['medium.extinction'], before)
            self.assertFalse(other.state.paused)
        sheet = numpy.asarray(Image.open(self.folder / 'sweep.png')).astype(int)
        self.assertEqual(sheet.shape, (4 * 135, 3 * 240, 3))
        parts = sheet.reshape(4, 135, 3, 240, 3).swapaxes(1, 2)[:, :, 20:]  # without the label
        for column in range(3):
            for row in range(3):
                self.assertGreater(abs(parts[row, column] - parts[row + 1, column]).mean(), 1, 'another value')
        for row in range(4):
            self.assertGreater(abs(parts[row, 0] - parts[row, 2]).mean(), 1, 'another side')


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
