"""Kept results: the series of docs/results/data/*.json, and expressions over a measured row.

A row of a sweep is a dict. An expression is Python over its keys, with nested ones by dots:
    medium_ms                   of the row
    100 * error.relative_rmse
    medium_ms / base.medium_ms  base: the row of the series' baseline at the same place
    passes["medium"]            median ms of a pass
"""
import json
import math
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / 'docs' / 'results' / 'data'
PLACE = ('scene', 'camera', 'size', 'viewers', 'mover')


class Fields:
    """A dict's keys as attributes."""

    def __init__(self, of):
        self.of = of

    def __getattr__(self, key):
        if key not in self.of:
            raise KeyError(f'{key}; there are: {", ".join(sorted(self.of))}')
        value = self.of[key]
        return Fields(value) if isinstance(value, dict) else value


def load(name):
    """A file's results. What brume-load wrote is one series, `runs`, whose rows have the viewers' number as variant."""
    of = json.loads((DATA / f'{name}.json').read_text())
    if 'runs' not in of:
        return of
    rows = [dict(run, variant=str(run['viewers'])) for run in of['runs']]
    made = {'cpu': of['machine'], 'device': of['device'], 'date': of.get('date', ''), 'commit': of['program']}
    return {'series': [{'name': 'runs', 'rows': rows, 'made': made}]}


def series_of(name, wanted):
    """The series of that name. Raises KeyError with those there are."""
    for one in load(name)['series']:
        if one['name'] == wanted:
            return one
    raise KeyError(f'{name}.json has no series "{wanted}"; there are: '
                   + ', '.join(one['name'] for one in load(name)['series']))


def place(row):
    return tuple(row.get(key) for key in PLACE)


def rows_of(name, wanted, where=None, split=None):
    """Rows of one or several series, each with `base`, `series`, `passes` by name and what `split` finds in a variant."""
    out = []
    for one in [wanted] if isinstance(wanted, str) else wanted:
        series = series_of(name, one)
        for row in series['rows']:
            row = dict(row, series=one)
            row['passes'] = {p['name']: p['median'] for p in row.get('passes', [])}
            if split and (found := re.search(split, row.get('variant', ''))):
                row.update(found.groupdict())
            out.append((row, series))
    for row, series in out:
        row['base'] = next((other for other, _ in out if other['series'] == row['series']
                            and other.get('variant') == series.get('baseline') and place(other) == place(row)), {})
    rows = [row for row, _ in out]
    return [row for row in rows if where is None or value(where, row)]


def value(expression, row):
    """The expression's value for a row, or None where the row lacks a key."""
    names = {key: Fields(v) if isinstance(v, dict) and key != 'passes' else v for key, v in row.items()}
    names.update(sqrt=math.sqrt, float=float, int=int, sum=sum, abs=abs, log10=math.log10, str=str, len=len)
    try:
        return eval(expression, {'__builtins__': {}, **names})  # the pages' own text, as trusted as this file
    except (KeyError, NameError, ZeroDivisionError):
        return None


def number(of, digits=3):
    """A number with so many digits that count, a whole one with all of them; "" for None."""
    if of is None:
        return ''
    if isinstance(of, int):
        return str(of)
    if isinstance(of, str) or not math.isfinite(of):
        return str(of)
    if of == 0:
        return '0'
    shown = float(f'{of:.{digits}g}')
    places = max(0, digits - 1 - math.floor(math.log10(abs(shown))))
    if abs(shown) < 1e-4:
        mantissa, exponent = f'{shown:.{digits - 1}e}'.split('e')
        return f'{mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa}e{int(exponent)}'
    return f'{of:.0f}' if abs(shown) >= 10 ** digits else f'{shown:.{places}f}'


def line_fit(x, y):
    """Slope and intercept of the least squares' line, and R²."""
    n, mx, my = len(x), sum(x) / len(x), sum(y) / len(y)
    sxx, sxy = sum((a - mx) ** 2 for a in x), sum((a - mx) * (b - my) for a, b in zip(x, y))
    slope = sxy / sxx
    left = sum((b - my - slope * (a - mx)) ** 2 for a, b in zip(x, y))
    all_of_it = sum((b - my) ** 2 for b in y)
    return slope, my - slope * mx, 1 - left / all_of_it if all_of_it else 1.0


def quadratic_r2(x, y):
    """R² of the least squares' parabola, by orthogonal polynomials; None below four values."""
    if len(x) < 4:
        return None
    n, mx, my = len(x), sum(x) / len(x), sum(y) / len(y)
    first = [a - mx for a in x]
    squares = [a * a for a in first]
    mean, tilt = sum(squares) / n, sum(a * b for a, b in zip(squares, first)) / sum(squares)
    second = [b - mean - tilt * a for a, b in zip(first, squares)]
    explained = sum(sum(p * b for p, b in zip(part, y)) ** 2 / sum(p * p for p in part) for part in (first, second))
    return explained / (sum((b - my) ** 2 for b in y) or 1)


def fits(x, y):
    """What a line of numbers over x is fitted with. R² of power and exponential: of the values, not of their logs."""
    def r2(of):
        mean = sum(y) / len(y)
        return 1 - sum((b - of(a)) ** 2 for a, b in zip(x, y)) / (sum((b - mean) ** 2 for b in y) or 1)
    slope, start, line = line_fit(x, y)
    out = {'slope': slope, 'start': start, 'r2': line, 'last_over_first': y[-1] / y[0] if y[0] else None}
    square = line_fit([a * a for a in x], y)
    out.update(r2_square=square[2], r2_quadratic=quadratic_r2(x, y))
    if min(x) > 0 and min(y) > 0:
        power, log_start, _ = line_fit([math.log(a) for a in x], [math.log(b) for b in y])
        out.update(power=power, r2_power=r2(lambda a: math.exp(log_start) * a ** power))
    if min(y) > 0:
        rate, log_start, _ = line_fit(x, [math.log(b) for b in y])
        out.update(rate=rate, r2_exponential=r2(lambda a: math.exp(log_start + rate * a)))
    return out
