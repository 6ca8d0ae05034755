#!/usr/bin/env python3
"""Renews the tables of docs/scenes.md from the built server: tools/settings_page.py [brume-server]"""
import re
import subprocess
import sys
from pathlib import Path

TABLE = re.compile(r'<!-- settings: (\S+) -->\n\n((?:\|.*\n)*)')
PAGE = Path(__file__).parent.parent / 'docs' / 'scenes.md'

server = sys.argv[1] if len(sys.argv) > 1 else 'build/release/bin/brume-server'
printed = subprocess.run([server, '--print-settings'], check=True, capture_output=True, text=True).stdout
tables = {m[1]: m[0] for m in TABLE.finditer(printed)}
page = PAGE.read_text()
there = {m[1] for m in TABLE.finditer(page)}
if there != tables.keys():
    sys.exit(f'{PAGE}: write a heading and "<!-- settings: NAME -->" for {sorted(tables.keys() - there)}; '
             f'there is no table for {sorted(there - tables.keys())}')
PAGE.write_text(TABLE.sub(lambda m: tables[m[1]], page))
