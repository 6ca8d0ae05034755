"""The table of docs/architecture.md says which folder of server/ uses which. It is the truth, and has no circle."""
import collections
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def wing(path):
    """The wing of a file below server/. The plan's halves of methods and effects belong to the plan."""
    parts = pathlib.PurePath(path).parts
    if len(parts) == 1:
        return 'main'
    halves = re.search(r'(_plan|_block|/plans|/effect_plan)\.(h|cpp)$', path)
    return 'plan' if parts[0] in ('methods', 'effects') and halves else parts[0]


def folder(path):
    return str(pathlib.PurePath(path).parent)


def used():
    """{wing: {wing that it includes: an example}}"""
    found = collections.defaultdict(dict)
    server = ROOT / 'server'
    for file in sorted(server.rglob('*')):
        if file.suffix not in ('.h', '.cpp'):
            continue
        path = file.relative_to(server).as_posix()
        for other in re.findall(r'#include "server/([^"]+)"', file.read_text()):
            if wing(path) != wing(other) and folder(path) != folder(other):
                found[wing(path)].setdefault(wing(other), f'{path} includes {other}')
    return found


def told():
    page = (ROOT / 'docs/architecture.md').read_text()
    table = re.search(r'^## Wings\n.*?^```\n(.*?)^```', page, re.M | re.S).group(1)
    rows = (line.split('|')[0].split() for line in table.splitlines())
    return {row[0]: set(row[1:]) for row in rows}


class Wings(unittest.TestCase):
    def test_the_page_says_what_is_used(self):
        table, found = told(), used()
        for name in sorted(set(table) | set(found)):
            with self.subTest(name):
                new = {other: example for other, example in found[name].items() if other not in table.get(name, ())}
                self.assertFalse(new, 'is not in the table')
                self.assertFalse(table.get(name, set()) - set(found[name]), 'is in the table, and not used')

    def test_there_is_no_circle(self):
        table = told()
        order = list(table)
        for name, others in table.items():
            for other in others:
                self.assertLess(order.index(name), order.index(other), f'{name} stands below {other}, which it uses')


if __name__ == '__main__':
    unittest.main()
