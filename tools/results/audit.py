"""Counts of an audit's rows, by what they were when it was made and what they are now.

A page with sections "## Seed 000" has a table in each, with the columns "was" (done, partly, missing) and "now" (done,
no: an honest no with its reason, open).
"""
import re

WAS, NOW = ('done', 'partly', 'missing'), ('done', 'no', 'open')


def counts(page):
    """Heads and lines of the table of counts. Raises ValueError for a row without one of the words or without a reason."""
    lines = []
    for seed, section in re.findall(r'^## (Seed \d+)\n(.*?)(?=^## |\Z)', page, re.M | re.S):
        rows = [[cell.strip() for cell in line.strip('|').split('|')]
                for line in section.splitlines() if re.match(r'\| \d+ \|', line)]
        for row in rows:
            if row[2] not in WAS or row[3] not in NOW or (row[2] != 'done' and not row[4]):
                raise ValueError(f'{seed}, row {row[0]}: {row[2]}, {row[3]}, "{row[4]}"')
        lines.append([seed, str(len(rows))] + [str(sum(row[2] == was for row in rows)) for was in WAS]
                     + [str(sum(row[3] == now for row in rows)) for now in NOW])
    total = ['all'] + [str(sum(int(line[i]) for line in lines)) for i in range(1, 8)]
    return ['', 'rows', *(f'{was} before' for was in WAS), *(f'{now} now' for now in NOW)], lines + [total]
