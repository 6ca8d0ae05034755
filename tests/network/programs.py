"""The programs that the measurements of networks run, and what they say of themselves."""
import contextlib
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request


signal.signal(signal.SIGTERM, signal.default_int_handler)  # tidied up as after Ctrl-C


def tell(line):
    print(line, file=sys.stderr, flush=True)


class Failed(Exception):
    """One line."""


class Server:
    """brume-server on `port`, 0 for a free one; `inside` is a command's head, such as ip netns exec NAME."""

    def __init__(self, programs, arguments, host='127.0.0.1', port=0, inside=(), wait=True, environment=None):
        self.host, self.log = host, tempfile.TemporaryFile('w+')
        self.process = subprocess.Popen(
            [*inside, str(programs / 'brume-server'), '--listen', host, '--port', str(port),
             *(['--open'] if host == '0.0.0.0' else []), *arguments],
            stdout=self.log, stderr=subprocess.STDOUT, env=os.environ | (environment or {}))
        self.port = port
        if wait:
            self.wait()

    def wait(self):
        """Until it says that it listens."""
        end = time.monotonic() + 120  # a CPU driver compiles its shaders first
        while not (found := re.search(r'listening on http://.*:(\d+)', self.said())):
            if self.process.poll() is not None or time.monotonic() > end:
                raise Failed('the server does not start: ' + (self.said().strip().splitlines() or ['silent'])[-1])
            time.sleep(0.02)
        self.port = int(found[1])

    def said(self):
        return os.pread(self.log.fileno(), 1 << 20, 0).decode(errors='replace')

    @property
    def pid(self):
        return self.process.pid

    def get(self, path, timeout=10):
        with urllib.request.urlopen(f'http://{self.host}:{self.port}{path}', timeout=timeout) as answer:
            return answer.read()

    def metrics(self):
        lines = [line.rsplit(' ', 1) for line in self.get('/metrics').decode().splitlines() if not line.startswith('#')]
        return {name: float(value) for name, value in lines}

    def stop(self, number=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            return self.process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise Failed('the server does not stop in 20 s') from None


class Load:
    """brume-load with one number of viewers; result() is that run in its load.json."""

    def __init__(self, programs, url, viewers, seconds, *more, inside=()):
        self.folder = tempfile.TemporaryDirectory(prefix='brume-')
        self.log = tempfile.TemporaryFile('w+')
        self.process = subprocess.Popen(
            [*inside, str(programs / 'brume-load'), '--server', url, '--viewers', str(viewers), '--seconds', str(seconds),
             '--out', self.folder.name, *more],
            stdout=subprocess.DEVNULL, stderr=self.log)

    def said(self):
        return os.pread(self.log.fileno(), 1 << 20, 0).decode(errors='replace').strip()

    def result(self, timeout=120):
        if self.process.wait(timeout=timeout) != 0:
            raise Failed(self.said() or 'brume-load was ended by a signal')
        whole = json.loads((pathlib.Path(self.folder.name) / 'load.json').read_text())
        return whole['runs'][0] | {'device': whole['device'], 'scene': whole['scene']}


def machine():
    return f'{os.cpu_count()} cores, load average {os.getloadavg()[0]:.2f} when it began'


def write(out, text):
    """Into a file that belongs to whom its folder belongs to, though root may run this."""
    out.write_text(text)
    with contextlib.suppress(PermissionError):
        owner = out.resolve().parent.stat()
        os.chown(out, owner.st_uid, owner.st_gid)
