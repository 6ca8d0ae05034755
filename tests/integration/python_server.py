"""A brume-server as a child process, and its Python package, for tests that are called with SERVER PACKAGE. Exit status
77: a package of the distribution is missing."""
import os
import re
import subprocess
import sys
import unittest
import urllib.request

try:
    import flatbuffers  # noqa: F401
    import numpy  # noqa: F401
    import PIL  # noqa: F401
    import websockets  # noqa: F401
except ImportError as missing:
    print(f'skipped: {missing}; ./dev test integration installs python3-websockets, python3-flatbuffers, '
          'python3-numpy and python3-pil')
    sys.exit(77)

program, package = (os.path.abspath(path) for path in sys.argv[1:3])
sys.path.insert(0, package)
import brume  # noqa: E402,F401

PATIENCE = 30  # s
COLD = 4 * PATIENCE  # s, where a new machine compiles a scene's shaders first


class Server:
    def __init__(self, program, *options):
        self.process = subprocess.Popen([program, '--scene', 'cloud', '--ahead', 'off', '--most-frame-time', '60000',
                                         '--port', '0', *options],
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for line in self.process.stdout:
            if found := re.search(r'listening on (http://.*:(\d+))', line):
                self.url, self.port = found[1], found[2]
                return
        raise RuntimeError('the server does not start')

    def stop(self, kill=False):
        if self.process.poll() is None:
            self.process.kill() if kill else self.process.terminate()
        self.process.stdout.close()
        return self.process.wait(PATIENCE)

    def metric(self, name):
        text = urllib.request.urlopen(f'{self.url}/metrics').read().decode()
        return next(float(line.split(' ')[-1]) for line in text.splitlines() if line.startswith(f'{name} '))


class Serving(unittest.TestCase):
    """Tests with servers of their own."""

    def serve(self, *options):
        server = Server(program, *options)
        self.addCleanup(server.stop)
        return server


class OneServer(unittest.TestCase):
    """Tests that share a server, each with viewers of its own."""

    @classmethod
    def setUpClass(cls):
        cls.server = Server(program)

    @classmethod
    def tearDownClass(cls):
        assert cls.server.stop() == 0, 'the server survived all of it'

    def viewer(self, **options):
        view = brume.connect(self.server.url, size=(160, 96), timeout=PATIENCE, **options)
        self.addCleanup(view.close)
        return view
