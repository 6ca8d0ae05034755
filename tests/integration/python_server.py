"""A brume-server as a child process, for tests of its Python package."""
import re
import subprocess
import urllib.request

PATIENCE = 30  # s


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
