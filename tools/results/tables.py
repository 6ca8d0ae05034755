"""Tables of a page, from kept results. A page has

    <!-- table
    series = "Simpson steps (4.2.1)"
    cells = [["ms", "medium_ms"], ["error, %", "100*error.relative_rmse"]]
    -->
    | ... |
    <!-- end -->

TOML between the marks says what stands below them:
    data       file of docs/results/data without .json; by default that of the page
    series     a series, or several
    where      expression: rows that are true
    split      pattern with named groups, matched with a row's variant; the groups are keys of the row
    lines      expression of a line's label; "variant" by default
    corner     head of the labels
    cells      heads and expressions, and digits where three are wrong
    transpose  true: cells are lines and labels are heads
    across     expression: one column for each of its values. Each cell is a line, or all stand in one with `join`
    extra      with across: more columns, heads and names of kept.fits() over the numbers of a line
    other      name, series and expression of one more row, to which cells refer by that name
    printed    lines as the paper prints them, label first
    digits     of all numbers

`names` in the page's head are shown in place of labels and of values of `across`.
"""
import kept


def lines_of(spec, data, names):
    """Heads and lines, as texts."""
    rows = kept.rows_of(spec.get('data', data), spec['series'], spec.get('where'), spec.get('split'))
    if not rows:
        raise KeyError('no row is left')
    if 'other' in spec:
        name, series, where = spec['other']
        for row in rows:
            row[name] = kept.rows_of(spec.get('data', data), series, where)[0]
    label = spec.get('lines', 'variant')
    digits = spec.get('digits', 3)
    cells = [(cell[0], cell[1], cell[2] if len(cell) > 2 else digits) for cell in spec['cells']]
    corner = spec.get('corner', '')
    if 'across' in spec:
        return pivot(rows, spec, label, cells, corner, names)
    lines = [[named(kept.value(label, row), names)] + [kept.number(kept.value(what, row), d) for _, what, d in cells]
             for row in rows]
    heads = [corner] + [head for head, _, _ in cells]
    lines += spec.get('printed', [])
    if spec.get('transpose'):
        turned = [list(line) for line in zip(heads, *lines)]
        return turned[0], turned[1:]
    return heads, lines


def named(of, names):
    return names.get(str(of), str(of))


def pivot(rows, spec, label, cells, corner, names):
    columns, labels = [], []
    for row in rows:
        for value, known in ((kept.value(spec['across'], row), columns), (kept.value(label, row), labels)):
            if value not in known:
                known.append(value)
    extra = spec.get('extra', [])
    lines = []
    for one in labels:
        def at(column, what):
            """Of several rows of a place, the last that has the value."""
            values = [kept.value(what, row) for row in rows if kept.value(label, row) == one
                      and kept.value(spec['across'], row) == column]
            return next((value for value in reversed(values) if value is not None), None)
        texts = []
        for head, what, digits in cells:
            values = [at(column, what) for column in columns]
            if all(value is None for value in values):
                continue
            text = [kept.number(value, digits) for value in values]
            if extra:
                known = [(float(c), v) for c, v in zip(columns, values) if v is not None]
                fitted = kept.fits(*zip(*known)) if len(known) > 1 else {}
                text += [kept.number(fitted.get(name), digits) for _, name in extra]
            texts.append((head, text))
        if 'join' in spec:
            both = [spec['join'].join(part for part in parts if part) for parts in zip(*(text for _, text in texts))]
            lines.append([named(one, names), *both])
        else:
            lines += [[', '.join(part for part in (named(one, names), head) if part), *text] for head, text in texts]
    return [corner] + [named(c, names) for c in columns] + [head for head, _ in extra], lines + spec.get('printed', [])


def markdown(heads, lines):
    wide = [[cell or '' for cell in line] for line in lines]
    text = [heads, ['---'] * len(heads)] + wide
    return '\n'.join('| ' + ' | '.join(cells) + ' |' for cells in text)
