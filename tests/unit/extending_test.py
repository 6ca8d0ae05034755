"""The examples of docs/extending.md apply to the tree as it is, and compile."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
COMPILER, GLSLANG, *INCLUDES = sys.argv[1:]  # INCLUDES: options for the compiler
FLAGS = '-std=c++20 -fsyntax-only -Wall -Wextra -Wshadow -Werror -Wno-missing-field-initializers'.split()


class Examples(unittest.TestCase):
    def run_in(self, folder, *command, **more):
        ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, **more)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_they_apply_and_compile(self):
        diffs = re.findall(r'^```diff\n(.*?)^```', (ROOT / 'docs/extending.md').read_text(), re.M | re.S)
        self.assertGreaterEqual(len(diffs), 2)
        with tempfile.TemporaryDirectory() as folder:
            for part in ('common', 'protocol', 'server', 'shaders'):
                self.run_in(folder, 'cp', '-r', ROOT / part, '.')
            for diff in diffs:
                self.run_in(folder, 'git', 'apply', '--whitespace=error', '-', input=diff)
            added = re.findall(r'^\+\+\+ b/(.*)$', ''.join(diffs), re.M)
            for shader in (name for name in added if name.startswith('shaders/')):
                path = pathlib.Path(shader)
                header = f'shaders/{path.stem}_{path.suffix[1:]}.h'
                self.run_in(folder, GLSLANG, '--quiet', '-V', '--target-env', 'vulkan1.3', '--auto-map-bindings', '-I.',
                            '--vn', f'{path.stem}_{path.suffix[1:]}', '-o', header, shader)
            sources = [name for name in added if name.endswith('.cpp')]
            together = ''.join(f'#include "{name}"\n' for name in sources)
            self.run_in(folder, COMPILER, *FLAGS, '-I.', *INCLUDES, '-x', 'c++', '-', input=together)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
