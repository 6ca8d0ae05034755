"""Every command of the pages runs: each block that is marked `sh`, as it stands but for ports and windows. Blocks whose
commands need another machine, Docker or root are marked `sh elsewhere`. Whole layer: BRUME_TESTS=whole."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from support import PROGRAMS, ROOT, free_ports

PAGES = [ROOT / 'README.md', *sorted(ROOT.glob('docs/*.md')), *sorted(ROOT.glob('client/*/README.md'))]
COMMANDS = (r'(?:\./dev|curl|ffmpeg|brume-\w+|build/release|docker|kubectl|apt|apt-get|openssl|python3|cut|flatc|'
            r'xdg-open|vlc)(?=\s|$)')
# Starts a server in place of the one before, and waits until it answers.
PRELUDE = r'''
set -euo pipefail
stop() { [[ -z "${server:-}" ]] || { kill "$server" && wait "$server" || true; server=; }; }
serve() {
    stop
    "$@" --port "$port" &>server.log & server=$!
    until grep -q 'listening on' server.log; do kill -0 "$server" || { cat server.log >&2; exit 1; }; sleep 0.1; done
    local address
    address=$(sed -n 's/.*listening on //p' server.log)
    curl -ksf --retry 30 --retry-delay 1 --retry-all-errors -o first.jpg "$address/snapshot.jpg?w=64&h=36"
    curl -ksf -X POST "$address/pause" && curl -ksf -X POST "$address/resume" # something to record
}
trap stop EXIT
'''
STUBS = {
    'dev': 'case "$1" in build) ;; load | bench) exec "brume-$@" ;; *) exit 1 ;; esac',
    'xdg-open': 'curl -sfo /dev/null "$1"',
    'brume-client': '[[ " $*" == *" --url"* ]] || set -- --url "http://127.0.0.1:$port" "$@"\n'
                    '[[ " $*" == *" --headless"* ]] || set -- --headless --frames 3 "$@"\n'
                    f'exec {PROGRAMS}/brume-client "$@"',
    'vlc': 'curl -sf --max-time 2 -o part "$1" || test -s part',
    'ffmpeg': 'exit 0  # where there is none',
}


def blocks(page):
    """(line, language, text) of every block of a page."""
    text = page.read_text()
    for found in re.finditer(r'^( *)```([^\n]*)\n(.*?)^ *```', text, re.M | re.S):
        yield text[:found.start()].count('\n') + 1, found[2].strip(), found[3]


def script(text, port):
    """A block's commands, with servers that go on beside what follows."""
    text = text.replace('build/release/bin/', '').replace('./dev run', 'brume-server')
    text = re.sub(r'(127\.0\.0\.1|localhost):\d{4,5}\b', rf'\1:{port}', text)
    text = re.sub(r' --port \d+', '', text)
    lines = [f'serve {line}' if re.match(r'brume-server\b(?!.*(--make-token|--replay(?!.*--look)))', line) else
             f'stop; {line}' if line.startswith('brume-server --replay') else line for line in text.splitlines()]
    if re.search(f':{port}|brume-client', text) and not any(line.startswith('serve') for line in lines):
        lines.insert(0, 'serve brume-server')
    return PRELUDE + f'export port={port}\n' + '\n'.join(lines)


class Docs(unittest.TestCase):
    def test_blocks_with_commands_are_marked(self):
        for page in PAGES:
            for line, language, text in blocks(page):
                if re.match(rf'\s*{COMMANDS}', text):
                    self.assertIn(language, ('sh', 'sh elsewhere'), f'{page}:{line}')

    @unittest.skipUnless(os.environ.get('BRUME_TESTS') == 'whole', 'whole layer')
    def test_every_command_runs(self):
        files = {text.split()[0]: text for _, _, text in blocks(ROOT / 'docs/scenes.md')}
        for page in PAGES:
            with tempfile.TemporaryDirectory(prefix='brume-docs-') as folder:
                path = pathlib.Path(folder)
                (path / 'bin').mkdir()
                for name, body in STUBS.items():
                    if name == 'ffmpeg' and shutil.which(name):
                        continue
                    stub = path / 'dev' if name == 'dev' else path / 'bin' / name
                    stub.write_text(f'#!/bin/bash\n{body}\n')
                    stub.chmod(0o755)
                for name in ('build', 'protocol', 'tools'):
                    (path / name).symlink_to(ROOT / name)
                if page.name == 'methods.md':
                    (path / 'mine.toml').write_text(files['name'])
                (path / 'mine.ply').write_text(files['ply'])
                shutil.copy(ROOT / 'build/release/python/example.py', path / 'yours.py')
                for line, language, text in blocks(page):
                    if language != 'sh':
                        continue
                    with self.subTest(f'{page.name}:{line}'):
                        port = free_ports(1)[0]
                        done = subprocess.run(
                            ['bash', '-c', script(text, port)], cwd=path, text=True, timeout=300,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            env=os.environ | {'PATH': f'{path}/bin:{PROGRAMS}:{os.environ["PATH"]}'})
                        self.assertEqual(done.returncode, 0, done.stdout[-3000:])


if __name__ == '__main__':
    unittest.main()
