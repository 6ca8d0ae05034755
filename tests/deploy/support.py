"""A cloud as it is deployed, on free ports of this machine: nodes, HAProxy with our files, NATS and Prometheus."""
import contextlib
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEPLOY = ROOT / 'deploy'
PROGRAMS = pathlib.Path(os.environ.get('BRUME_PROGRAMS', ROOT / 'build/release/bin'))
PATIENCE = 60  # s: nothing should take this long; a loaded machine may


def run(*command, **more):
    """What a command printed; it must succeed."""
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=PATIENCE * 2, **more)
    if done.returncode != 0:
        raise AssertionError(f'{command[0]} ended with {done.returncode}:\n{done.stdout}')
    return done.stdout


def until(what, holds, timeout=PATIENCE):
    """What `holds` returns, once it is true."""
    end = time.monotonic() + timeout
    while not (value := holds()):
        if time.monotonic() > end:
            raise AssertionError(f'{what}: not within {timeout:g} s')
        time.sleep(0.02)
    return value


def free_ports(count, run_of=1):
    """The first port of `count` runs of so many that nobody listens at."""
    found = []
    with contextlib.ExitStack() as held:
        while len(found) < count:
            sockets = [held.enter_context(socket.socket()) for _ in range(run_of)]
            with contextlib.suppress(OSError, OverflowError):
                sockets[0].bind(('127.0.0.1', 0))
                first = sockets[0].getsockname()[1]
                for i, other in enumerate(sockets[1:], 1):
                    other.bind(('127.0.0.1', first + i))
                found.append(first)
    return found


def get(url, headers=(), timeout=10, method='GET', data=None):
    """(status, headers, body), whatever the status; status 0: nobody answers."""
    request = urllib.request.Request(url, headers=dict(headers), method=method, data=data)
    try:
        with urllib.request.urlopen(request, timeout=timeout) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()
    except OSError:
        return 0, {}, b''


class Part:
    """A process with its log."""

    def __init__(self, *command, env=None):
        self.log = tempfile.TemporaryFile('w+')
        self.process = subprocess.Popen([str(part) for part in command], stdout=self.log, stderr=subprocess.STDOUT,
                                        env=os.environ | (env or {}), cwd=ROOT)

    def said(self):
        return os.pread(self.log.fileno(), 1 << 20, 0).decode(errors='replace')

    def says(self, pattern):
        """Waits until the log has it."""
        def look():
            found = re.search(pattern, self.said())
            if not found and self.process.poll() is not None:
                raise AssertionError(f'{self.process.args[0]} has ended:\n{self.said()}')
            return found
        return until(f'{self.process.args[0]} says {pattern}', look)

    def stop(self, number=signal.SIGTERM):
        self.log.close()
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            return self.process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise


class Cloud:
    """`nodes` servers behind HAProxy, called n1, n2 ...; in a cluster if the server can be in one and `cluster` is
    true."""

    def __init__(self, nodes=2, options=(), cluster=False):
        self.folder = tempfile.TemporaryDirectory(prefix='brume-')
        self.path = pathlib.Path(self.folder.name)
        self.options, self.parts, self.nodes = list(options), [], {}
        # All at once: what one call gave is free again until somebody listens, and the next call may give the same.
        self.port, self.metrics_port, self.nats_port, *ports = free_ports(3 + 2 * nodes)
        self.url = f'http://127.0.0.1:{self.port}'
        try:
            if cluster:
                self.parts.append(Part('nats-server', '-a', '127.0.0.1', '-p', self.nats_port, '-js',
                                       '-sd', self.path / 'nats'))
                self.parts[-1].says('Server is ready')
                self.options += ['--cluster', f'nats://127.0.0.1:{self.nats_port}']
            self.ports = {f'n{i + 1}': (ports[2 * i], ports[2 * i + 1]) for i in range(nodes)}
            for name in self.ports:
                self.start(name)
            for part in self.nodes.values():
                part.says(r'listening on http://')
            binds = {'BRUME_BIND': f'127.0.0.1:{self.port}', 'BRUME_METRICS_BIND': f'127.0.0.1:{self.metrics_port}'}
            self.parts.append(Part('haproxy', '-db', '-f', DEPLOY / 'haproxy/haproxy.cfg', '-f', self.list_of_nodes(),
                                   env=binds))
            until('HAProxy has all nodes', lambda: all(self.is_up(name) for name in self.ports))
        except BaseException:
            self.stop()
            raise

    def start(self, name):
        port, agent = self.ports[name]
        self.nodes[name] = Part(PROGRAMS / 'brume-server', '--port', port, '--agent-port', agent, '--proxy-protocol',
                                '--open', '--scene', 'cloud', '--ahead', 'off', '--measure-error', '0.5', *self.options)

    def list_of_nodes(self):
        """As deploy/haproxy/nodes.cfg, with our addresses."""
        given = (DEPLOY / 'haproxy/nodes.cfg').read_text()
        lines = re.findall(r'^ *(?:backend|use-server|force-persist).*$', given, re.M)
        lines += [f'    server {name} 127.0.0.1:{port} cookie {name} agent-port {agent}'
                  for name, (port, agent) in self.ports.items()]
        (self.path / 'nodes.cfg').write_text('\n'.join(lines) + '\n')
        return self.path / 'nodes.cfg'

    def haproxy(self, sample):
        """A value of HAProxy's own metrics, None if it has none."""
        text = get(f'http://127.0.0.1:{self.metrics_port}/metrics')[2].decode()
        found = re.search(re.escape(sample) + r' (\S+)$', text, re.M)
        return float(found[1]) if found else None

    def is_up(self, name):
        return self.haproxy(f'haproxy_server_status{{proxy="nodes",server="{name}",state="UP"}}') == 1

    def metrics_url(self, name):
        return f'http://127.0.0.1:{self.metrics_port}/node/{name}/metrics'

    def metric(self, name, metric):
        """Of one node; None while it does not answer."""
        status, _, body = get(self.metrics_url(name))
        found = re.search(f'^{re.escape(metric)} (\\S+)$', body.decode(), re.M)
        return float(found[1]) if status == 200 and found else None

    def prometheus(self):
        """Prometheus with our files, which asks all nodes and HAProxy; returns its URL."""
        address = f'127.0.0.1:{self.metrics_port}'
        targets = [{'targets': [address], 'labels': {'instance': name, '__metrics_path__': f'/node/{name}/metrics'}}
                   for name in self.ports]
        targets.append({'targets': [address], 'labels': {'job': 'haproxy', 'instance': 'haproxy'}})
        folder = self.path / 'prometheus'
        folder.mkdir()
        (folder / 'targets.json').write_text(json.dumps(targets))
        for name in ('prometheus.yml', 'rules.yml', 'alerts.yml'):
            text = (DEPLOY / 'prometheus' / name).read_text()
            # Quicker than a cloud in use needs.
            (folder / name).write_text(re.sub(r'(scrape|evaluation)_interval: 5s', r'\1_interval: 1s', text))
        port, = free_ports(1)
        self.parts.append(Part('prometheus', f'--config.file={folder}/prometheus.yml',
                               f'--storage.tsdb.path={folder}/data', f'--web.listen-address=127.0.0.1:{port}'))
        url = f'http://127.0.0.1:{port}'
        until('Prometheus is ready', lambda: get(url + '/-/ready')[0] == 200)
        return url

    def stop(self):
        for node in self.nodes.values():
            node.stop(signal.SIGKILL)
        for part in reversed(self.parts):
            part.stop()
        self.folder.cleanup()
