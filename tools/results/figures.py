"""Figures of a page, from kept results. A page has

    <!-- figure
    file = "data/seed-000-steps.svg"
    title = "Time by steps"
    x = ["steps", "float(steps)"]
    y = ["time, of the first", "medium_ms/base.medium_ms"]
    series = "Steps and counts (figure 26)"
    split = "(?P<count>\\d+) particles, (?P<steps>\\d+)"
    lines = "count"
    -->
    ![...](...)
    <!-- end -->

Keys are those of tables. `twin`: expression and prefix of names of the paper's lines, which are broken. `log`: axes
that are logarithmic, "x", "y" or "xy".
"""
import math
from html import escape

import kept

WIDE, HIGH, LEFT, RIGHT, TOP, BOTTOM = 720, 400, 70, 190, 36, 48
COLOURS = ('#1b6ca8', '#c8553d', '#3a7d44', '#8e5aa8', '#b8860b', '#4a4a4a', '#d0679d', '#2a9d8f')


def lines_of(spec, data, names):
    """Names and points of the lines, ours first, and whether they are the paper's."""
    ways = [(spec['y'][1], '', False)] + ([(*spec['twin'], True)] if 'twin' in spec else [])
    rows = kept.rows_of(spec.get('data', data), spec['series'], spec.get('where'), spec.get('split'))
    out = []
    for expression, prefix, printed in ways:
        lines = {}
        for row in rows:
            x, y = kept.value(spec['x'][1], row), kept.value(expression, row)
            if x is not None and y is not None:
                name = str(kept.value(spec.get('lines', '""'), row))
                lines.setdefault(prefix + names.get(name, name), []).append((float(x), float(y)))
        out += [(name, points, printed) for name, points in lines.items()]
    return out


def ticks(low, high, log):
    if log:
        return [10 ** e * m for e in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
                for m in (1, 2, 5) if low <= 10 ** e * m <= high]
    step = 10 ** math.floor(math.log10((high - low) or 1))
    step = next(step * m for m in (0.1, 0.2, 0.5, 1, 2) if (high - low) / (step * m) <= 7)
    return [n * step for n in range(math.ceil(low / step), math.floor(high / step) + 1)]


class Axis:
    def __init__(self, values, log, first, last):
        self.log, self.first, self.last = log, first, last
        self.low, self.high = min(values), max(values)
        if not log:
            self.low = min(self.low, 0)
        if self.low == self.high:
            self.high = self.low + 1

    def at(self, value):
        turn = math.log if self.log else float
        part = (turn(value) - turn(self.low)) / (turn(self.high) - turn(self.low))
        return self.first + (self.last - self.first) * part


def svg(spec, data, names):
    lines = lines_of(spec, data, names)
    log = spec.get('log', '')
    x = Axis([p[0] for _, points, _ in lines for p in points], 'x' in log, LEFT, WIDE - RIGHT)
    y = Axis([p[1] for _, points, _ in lines for p in points], 'y' in log, HIGH - BOTTOM, TOP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE} {HIGH}" font-family="sans-serif" '
           f'font-size="12"><rect width="{WIDE}" height="{HIGH}" fill="white"/>'
           f'<text x="{LEFT}" y="20" font-size="14">{escape(spec["title"])}</text>']
    for value in ticks(x.low, x.high, x.log):
        at = f'{x.at(value):.1f}'
        out.append(f'<path d="M{at} {TOP}V{HIGH - BOTTOM}" stroke="#e4e4e4"/>'
                   f'<text x="{at}" y="{HIGH - BOTTOM + 16}" text-anchor="middle">{value:g}</text>')
    for value in ticks(y.low, y.high, y.log):
        at = f'{y.at(value):.1f}'
        out.append(f'<path d="M{LEFT} {at}H{WIDE - RIGHT}" stroke="#e4e4e4"/>'
                   f'<text x="{LEFT - 6}" y="{at}" dy="4" text-anchor="end">{value:g}</text>')
    out.append(f'<text x="{(LEFT + WIDE - RIGHT) / 2}" y="{HIGH - 10}" text-anchor="middle">'
               f'{escape(spec["x"][0])}</text>'
               f'<text transform="translate(16 {(TOP + HIGH - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
               f'{escape(spec["y"][0])}</text>')
    for i, (name, points, printed) in enumerate(lines):
        colour = COLOURS[i % len(COLOURS)]
        places = [(f'{x.at(a):.1f}', f'{y.at(b):.1f}') for a, b in sorted(points)]
        dash = ' stroke-dasharray="5 4"' if printed else ''
        out.append(f'<polyline points="{" ".join(",".join(p) for p in places)}" fill="none" stroke="{colour}"{dash}/>')
        out += [f'<circle cx="{a}" cy="{b}" r="3" fill="{"white" if printed else colour}" stroke="{colour}"/>'
                for a, b in places]
        out.append(f'<text x="{WIDE - RIGHT + 12}" y="{TOP + 14 + 18 * i}" fill="{colour}">{escape(name)}</text>')
    return '\n'.join(out) + '\n</svg>\n'
