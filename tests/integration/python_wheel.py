#!/usr/bin/env python3
"""The wheel of the Python package, installed as others do: python_wheel.py SERVER PACKAGE. Exit status 77: a package of
the distribution is missing."""
import hashlib
import pathlib
import subprocess
import sys
import tempfile
import unittest
import venv
import zipfile

from python_server import COLD, Serving, package

try:
    import ensurepip  # noqa: F401
except ImportError as missing:
    print(f'skipped: {missing}; ./dev test integration installs python3-venv')
    sys.exit(77)

USE = '''
import importlib.metadata, sys
import brume
with brume.connect(sys.argv[1], size=(96, 64), timeout=120) as view:
    frame = view.frame()
    print(brume.__file__, brume.__version__, importlib.metadata.version('brume'), frame.array().shape)
'''


class Wheel(Serving):
    def setUp(self):
        (self.wheel,) = (pathlib.Path(package).parent / 'wheels').glob('*.whl')
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def command(self, *arguments):
        done = subprocess.run(arguments, cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=COLD, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def test_pip_installs_it_and_a_program_connects(self):
        server = self.serve()
        venv.create(self.folder / 'venv', with_pip=True, system_site_packages=True)
        python, pip = self.folder / 'venv/bin/python', (self.folder / 'venv/bin/python', '-m', 'pip')
        version = self.wheel.name.split('-')[1]
        for what in (self.wheel, package):  # pip builds the folder by itself, without network
            self.command(*pip, 'install', '--no-index', '--no-deps', '--force-reinstall', what)
            file, said, known, shape = self.command(python, '-c', USE, server.url).strip().split(' ', 3)
            self.assertTrue(file.startswith(str(self.folder / 'venv')), file)
            self.assertEqual((said, known, shape), (version, version, '(64, 96, 3)'))
        shown = self.command(*pip, 'show', '--verbose', 'brume')
        for line in ('License: Apache-2.0', 'Requires: flatbuffers, websockets', 'Name: brume'):
            self.assertIn(line, shown)

    def test_it_holds_what_it_must_and_equal_files_give_equal_bytes(self):
        with zipfile.ZipFile(self.wheel) as archive:
            names = archive.namelist()
            (metadata,) = (archive.read(name).decode() for name in names if name.endswith('/METADATA'))
        head, _, text = metadata.partition('\n\n')
        for name in ('brume/py.typed', 'brume/widget.js', 'brume/wire/Hello.py', 'brume/version.py'):
            self.assertIn(name, names)
        self.assertFalse([name for name in names if '__pycache__' in name or name.startswith('/')])
        for line in ('Requires-Python: >=3.9', "Requires-Dist: numpy; extra == 'pictures'",
                     'Requires-Dist: websockets>=10'):
            self.assertIn(line, head.splitlines())
        self.assertIn('# The Python package', text)
        self.command(sys.executable, pathlib.Path(package) / 'packing.py', self.folder)
        again = self.folder / self.wheel.name
        self.assertEqual(*(hashlib.sha256(path.read_bytes()).hexdigest() for path in (again, self.wheel)))


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
