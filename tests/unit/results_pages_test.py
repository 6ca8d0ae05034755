"""Pages of results: their tables and figures are as their kept results make them, and no number of their text stands
nowhere. The tool itself finds a changed cell, a changed figure and a number that nobody measured."""
import json
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools' / 'results'))
import kept  # noqa: E402
import pages  # noqa: E402

PAGE = '''<!-- page
data = "some"
-->
With two steps it takes 126 ms, 1.18 times as long as with one, of 500 particles; the paper says 3.24 ms.

| it says | carried by |
|---|---|
| steps are linear | 19.0 ms a step |

<!-- table
series = "Steps"
transpose = true
cells = [["ms", "medium_ms"], ["over 1", "medium_ms/base.medium_ms"], ["error, %", "100*error.relative_rmse"]]
-->
<!-- end -->

<!-- table
series = "Steps"
across = "steps"
lines = "''"
split = "(?P<steps>\\\\d+) step"
cells = [["ms", "medium_ms"]]
extra = [["a step", "slope"], ["R²", "r2"], ["last over first", "last_over_first"]]
-->
<!-- end -->

<!-- figure
file = "data/steps.svg"
title = "Time by steps"
series = "Steps"
split = "(?P<steps>\\\\d+) step"
x = ["steps", "float(steps)"]
y = ["ms", "medium_ms"]
twin = ["published_ms", "theirs"]
-->
<!-- end -->
'''


def row(steps, ms, error):
    return {'variant': f'{steps} steps', 'medium_ms': ms, 'scene': 'cloud', 'particles': 500, 'published_ms': ms / 30,
            'error': {'relative_rmse': error}}


RESULTS = {'series': [{'name': 'Steps', 'baseline': '1 steps', 'made': {},
                       'rows': [row(1, 107, 0.295), row(2, 126, 0.0742), row(3, 145, 0.0858)]}]}


class Tool(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.pages = pathlib.Path(folder.name)
        data = self.pages / 'data'
        data.mkdir()
        (data / 'some.json').write_text(json.dumps(RESULTS))
        (data / 'published.toml').write_text('[page]\ntable_1_ms = [3.24]\n')
        self.page = self.pages / 'page.md'
        self.page.write_text(PAGE)
        for patch in (mock.patch.object(kept, 'DATA', data), mock.patch.object(pages, 'PAGES', self.pages)):
            patch.start()
            self.addCleanup(patch.stop)
        pages.main(['page.md'])

    def check(self):
        pages.main(['--check', 'page.md'])

    def test_fills_tables_and_figures(self):
        text = self.page.read_text()
        self.assertIn('| ms | 107 | 126 | 145 |', text)
        self.assertIn('| over 1 | 1.00 | 1.18 | 1.36 |', text)
        self.assertIn('| error, % | 29.5 | 7.42 | 8.58 |', text)
        self.assertIn('| 19.0 | 1.00 | 1.36 |', text)
        self.assertIn('![Time by steps](data/steps.svg)', text)
        self.check()

    def test_finds_a_changed_cell(self):
        self.page.write_text(self.page.read_text().replace('| 7.42 |', '| 7.52 |'))
        with self.assertRaisesRegex(SystemExit, 'not as its results are'):
            self.check()

    def test_finds_a_changed_figure(self):
        (self.pages / 'data' / 'steps.svg').write_text('<svg/>')
        with self.assertRaisesRegex(SystemExit, 'steps.svg: not as its results are'):
            self.check()

    def test_finds_numbers_that_nobody_measured(self):
        for good, bad in (('126 ms', '125 ms'), ('1.18 times', '1.28 times'), ('3.24 ms', '3.4 ms'), ('500', '600'),
                          ('19.0 ms a step', '19.4 ms a step')):
            self.page.write_text(PAGE.replace(good, bad))
            with self.assertRaisesRegex(SystemExit, f'no table, series or print has {bad.split()[0]} '):
                pages.main(['page.md'])

    def test_a_series_that_is_not_there_is_said(self):
        self.page.write_text(PAGE.replace('series = "Steps"', 'series = "Stairs"', 1))
        with self.assertRaisesRegex(SystemExit, 'page.md:10: .*no series .*Stairs.*there are: Steps'):
            pages.main(['page.md'])


class Pages(unittest.TestCase):
    def test_are_as_their_results_are(self):
        pages.main(['--check'])


class Fits(unittest.TestCase):
    def test_find_the_law(self):
        x = [1, 2, 4, 8]
        line, power, rate = ([f(a) for a in x] for f in (lambda a: 3 + 2 * a, lambda a: 5 * a ** 1.5, lambda a: 2 ** a))
        self.assertAlmostEqual(kept.fits(x, line)['slope'], 2)
        self.assertAlmostEqual(kept.fits(x, line)['r2'], 1)
        self.assertAlmostEqual(kept.fits(x, power)['power'], 1.5)
        self.assertAlmostEqual(kept.fits(x, power)['r2_power'], 1)
        self.assertLess(kept.fits(x, power)['r2_exponential'], 0.9)
        self.assertAlmostEqual(kept.fits(x, [3 - 2 * a + 0.5 * a * a for a in x])['r2_quadratic'], 1)
        self.assertLess(kept.fits(x, rate)['r2_quadratic'], 0.999)
        self.assertAlmostEqual(kept.fits(x, rate)['rate'], 0.6931, 3)
        self.assertAlmostEqual(kept.fits(x, rate)['r2_exponential'], 1)
        self.assertLess(kept.fits(x, rate)['r2'], 0.9)

    def test_numbers_have_digits_that_count(self):
        for of, text in ((0.000012345, '1.23e-5'), (0.012345, '0.0123'), (1.2345, '1.23'), (123.45, '123'),
                         (12345.6, '12346'), (123456, '123456'), (0, '0'), (None, ''),
                         (-1.2345, '-1.23'), (99.96, '100')):
            self.assertEqual(kept.number(of), text)


if __name__ == '__main__':
    unittest.main()
