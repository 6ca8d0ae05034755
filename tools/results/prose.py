"""Numbers that a person wrote on a page, in prose or in a table of verdicts: each stands in a table that was made from
results, in the names and settings of its series, or in docs/results/data/published.toml, rounded as it is written.

Not looked at: code, links' targets, heads, what is called by number (figure 3, section 4.2), days, and whole numbers up
to twelve without a unit, which count things.
"""
import re
import tomllib

import kept

MADE = re.compile(r'<!-- (?:made|table|figure|counts)\n.*?<!-- end -->', re.S)
NUMBER = re.compile(r'(?<![\w.#/])[-−+]?(\d+(?:,\d{3})+|\d+\.\d+|\d+)(e-?\d+)?(?![\w]*[-–]\w*\d)')
UNIT = re.compile(r'\s*(%|ms\b|m\b|times\b|MiB|MB|GB|dB|×|of a per)')
CALLED = re.compile(r'\b(?:[Ff]igures?|[Tt]ables?|[Ee]quations?|[Ee]qs?|[Ss]ections?|[Ss]eeds?|[Rr]ows?|GTX|RTX|GeForce|'
                    r'[Aa]lgorithm|Mesa|Debian|LLVM|[Vv]iews?)\s+\(?(?:\d+(?:\.\d+)*[a-z]?(?:\s*(?:,|and|to)\s*)?)+')
DAY = re.compile(r'\b\d{1,2} [A-Z][a-z]+ 20\d\d\b|\b(?:19|20)\d\d\b|\b[A-Z]\.?\d(?:\.\d)?\b|'
                 r'\(\d\.\d+(?:\.\d+)?(?:, \d\.\d+(?:\.\d+)?)*\)')


def parsed(text, power=''):
    return float(text.replace(',', '') + (power or ''))


def digits_after(text):
    return len(text.partition('.')[2])


def prose_of(page):
    """The page without what was made, code, comments, heads and links' targets."""
    text = MADE.sub('', page)
    text = re.sub(r'<!--.*?-->', '', text, flags=re.S)
    text = re.sub(r'```.*?```', '', text, flags=re.S)
    text = '\n'.join(line for line in text.splitlines() if not line.startswith('#'))
    text = re.sub(r'`[^`]*`', '', text)
    text = re.sub(r'\]\([^)]*\)', ']', text)
    return DAY.sub('', CALLED.sub('', text))


def all_numbers(of):
    """Numbers of texts and of structures of them."""
    if isinstance(of, dict):
        return [n for v in of.values() for n in all_numbers(v)]
    if isinstance(of, list):
        return [n for v in of for n in all_numbers(v)]
    if isinstance(of, (int, float)):
        return [float(of)]
    return [parsed(*found) for found in re.findall(r'(\d+(?:,\d{3})+|\d+\.\d+|\d+)(e-?\d+)?', str(of))]


def known_numbers(page, datas, name):
    """Numbers of tables that were made, of the series' names, settings and texts, and of what the paper prints."""
    out = [n for made in MADE.finditer(page) for line in made[0].splitlines() if line.startswith('|')
           for n in all_numbers(line)]
    for data in datas:
        for series in kept.load(data)['series']:
            out += all_numbers([series.get(key, '') for key in ('name', 'about', 'set', 'error')])
            for row in series['rows']:
                out += all_numbers([row.get('variant', ''), row.get('set', []), row.get('size', ''),
                                    row.get('viewers', 0), row.get('published_ms', 0), row.get('particles', 0)])
    published = tomllib.loads((kept.DATA / 'published.toml').read_text())
    return set(out + all_numbers(published.get(name, {})))


def strays(page, datas, name):
    """Numbers of the prose that stand nowhere else, each with the words around it."""
    known = known_numbers(page, datas, name)
    prose = prose_of(page)
    out = []
    for found in NUMBER.finditer(prose):
        text, power = found[1], found[2]
        number, places = parsed(text, power), digits_after(text)
        if not power and places == 0 and number <= 12 and not UNIT.match(prose[found.end():]):
            continue
        step = 0.5 * 10 ** -places * float('1' + (power or 'e0')) * 1.0001
        if any(abs(one - number) <= step for one in known):
            continue
        out.append(f'{found[0]}  in: …{" ".join(prose[max(0, found.start() - 50):found.end() + 30].split())}…')
    return out
