#!/usr/bin/env python3
"""Renews the tables and figures of pages from kept results, and looks for numbers that no result has.

    tools/results/pages.py [--check] [PAGE...]      pages of docs/results; without: all that begin with <!-- page -->
    tools/results/pages.py --data PAGE              names of the files that it is made from

--check changes nothing and fails where a page is not as it would be made.
"""
import re
import sys
import tomllib

import audit
import figures
import kept
import prose
import tables

PAGES = kept.ROOT / 'docs' / 'results'
HEAD = re.compile(r'<!-- page\n(.*?)-->', re.S)
BLOCK = re.compile(r'(<!-- (table|figure|made|counts)\n(.*?)-->\n)(.*?)(<!-- end -->)', re.S)


def made(data):
    """Where and when the series of a file were measured."""
    lines = {}
    for series in kept.load(data)['series']:
        of = series['made']
        lines.setdefault((of['cpu'], of['device'], of['date']), []).append(of['commit'])
    return '; '.join(f'{date}, {cpu}, {device}, commit {", ".join(sorted(set(commits)))}'
                     for (cpu, device, date), commits in lines.items()) + '.'


def renewed(path, files):
    """The page's text, and numbers that stand nowhere; a page without results has none to look for.

    `files`: text of each figure by its path."""
    text = path.read_text()
    head = tomllib.loads(HEAD.search(text)[1])
    datas = [head['data']] if isinstance(head['data'], str) else head['data']
    used, names = set(datas), head.get('names', {})

    def block(found):
        kind, spec = found[2], tomllib.loads(found[3])
        data = spec.get('data', datas[0] if datas else '')
        used.update({data} - {''})
        try:
            if kind == 'made':
                body = made(data)
            elif kind == 'counts':
                body = tables.markdown(*audit.counts(text))
            elif kind == 'figure':
                files[PAGES / spec['file']] = figures.svg(spec, data, names)
                body = f'![{spec["title"]}]({spec["file"]})'
            else:
                body = tables.markdown(*tables.lines_of(spec, data, names))
        except Exception as error:
            line = text[:found.start()].count('\n') + 1
            sys.exit(f'{path}:{line}: {type(error).__name__}: {error}')
        return f'{found[1]}\n{body}\n\n{found[5]}'

    text = BLOCK.sub(block, text)
    return text, prose.strays(text, sorted(used), path.stem) if used else []


def main(arguments):
    if arguments[:1] == ['--data']:
        data = tomllib.loads(HEAD.search((PAGES / arguments[1]).read_text())[1])['data']
        print(data if isinstance(data, str) else '\n'.join(data))
        return
    check = '--check' in arguments
    named = [PAGES / name for name in arguments if name != '--check']
    wrong = []
    for path in named or [page for page in sorted(PAGES.glob('*.md')) if HEAD.search(page.read_text())]:
        files = {}
        text, strays = renewed(path, files)
        for file, now in {path: text, **files}.items():
            if not file.exists() or file.read_text() != now:
                if check:
                    wrong.append(f'{file}: not as its results are; run tools/results/pages.py')
                else:
                    file.write_text(now)
        wrong += [f'{path}: no table, series or print has {stray}' for stray in strays]
    if wrong:
        sys.exit('\n'.join(wrong))


if __name__ == '__main__':
    main(sys.argv[1:])
