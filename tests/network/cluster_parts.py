"""The parts of a cluster that measurements start, cut and kill: NATS servers, the way to them, and nodes with their recordings."""
import contextlib
import json
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time

from programs import Failed, Server

PREFIX = 17  # characters before the JSON of a recording's line: its hash and a blank


def free_ports(count):
    """So many different ports that nobody listens at."""
    with contextlib.ExitStack() as held:
        sockets = [held.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(('127.0.0.1', 0))
        return [one.getsockname()[1] for one in sockets]


class Engine:
    """nats-server with JetStream, one or three of them, each with a store of its own."""

    def __init__(self, servers=1):
        self.folder = tempfile.TemporaryDirectory(prefix='brume-nats-')
        ports = free_ports(2 * servers)
        self.ports, self.routes = ports[:servers], ports[servers:]
        self.processes = [None] * servers
        for i in range(servers):
            self.start(i)

    def store(self, i=0):
        return pathlib.Path(self.folder.name) / f'store{i}'

    def start(self, i=0):
        command = ['/usr/sbin/nats-server', '-a', '127.0.0.1', '-p', str(self.ports[i]), '-js', '-sd', str(self.store(i)),
                   '-l', str(pathlib.Path(self.folder.name) / f'log{i}')]
        if len(self.ports) > 1:
            config = pathlib.Path(self.folder.name) / f'{i}.conf'
            routes = ', '.join(f'"nats://127.0.0.1:{port}"' for port in self.routes)
            config.write_text(f'server_name: n{i}\ncluster {{ name: c, listen: "127.0.0.1:{self.routes[i]}", '
                              f'routes: [{routes}] }}\n')
            command += ['-c', str(config)]
        self.processes[i] = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 30
        while time.monotonic() < end:
            with contextlib.suppress(OSError):
                socket.create_connection(('127.0.0.1', self.ports[i]), timeout=1).close()
                return
            time.sleep(0.01)
        raise Failed('nats-server does not start')

    def kill(self, i=0):
        self.processes[i].kill()
        self.processes[i].wait()

    def forget(self, i=0):
        shutil.rmtree(self.store(i))

    def url(self):
        return ','.join(f'nats://127.0.0.1:{port}' for port in self.ports)

    def stop(self):
        for process in self.processes:
            process.kill()
            process.wait()
        self.folder.cleanup()


class Way:
    """A TCP connection through this program to a port, which can be cut: nothing passes then, and nobody is told."""

    def __init__(self, port):
        self.to, self.cut = port, threading.Event()
        self.listener = socket.create_server(('127.0.0.1', 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            near, _ = self.listener.accept()
            if self.cut.is_set():
                near.close()
                continue
            far = socket.create_connection(('127.0.0.1', self.to))
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self.carry, args=(source, sink), daemon=True).start()

    def carry(self, source, sink):
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                if not self.cut.is_set():
                    sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)


class Node(Server):
    """brume-server in a cluster, which records what it simulates."""

    def __init__(self, programs, engine, arguments, url=None, environment=None, wait=True):
        self.folder = tempfile.TemporaryDirectory(prefix='brume-node-')
        self.record = pathlib.Path(self.folder.name) / 'session'
        self.began = time.monotonic()
        super().__init__(programs, [*arguments, '--cluster', url or engine.url(), '--record', str(self.record), '--ahead', 'off'],
                         wait=wait, environment=environment)

    def cluster(self, name):
        return self.metrics()['brume_cluster_' + name]

    def ready(self, timeout=120):
        """Seconds from its start until it has the others' state."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            with contextlib.suppress(OSError):
                if self.get('/readyz').strip() == b'ready':
                    return time.monotonic() - self.began
            time.sleep(0.02)
        raise Failed('a node does not get ready: ' + (self.said().strip().splitlines() or ['silent'])[-1])

    def recordings(self):
        return sorted(self.record.parent.glob('session*'))


def recorded(node):
    """State by tick and commands by tick, without who asked: others' viewers are not known to a node."""
    states, commands = {}, {}
    for file in node.recordings():
        for line in file.read_text().splitlines()[1:]:
            record = json.loads(line[PREFIX:])
            if 'state' not in record:
                continue
            states[record['tick']] = record['state']
            if 'commands' in record:
                commands[record['tick']] = [{k: v for k, v in c.items() if k != 'viewer'} for c in record['commands']]
    return states, commands


def compare(nodes):
    """Ticks whose states two or more recordings have. Raises Failed where a state or a command differs."""
    all_states, all_commands = zip(*(recorded(node) for node in nodes))
    compared = 0
    for tick in sorted(set().union(*all_states)):
        seen = {states[tick] for states in all_states if tick in states}
        if len(seen) > 1:
            raise Failed(f'states differ at tick {tick}: {", ".join(sorted(seen))}')
        compared += sum(tick in states for states in all_states) > 1
    for tick in sorted(set().union(*all_commands)):
        # A node that had this tick recorded its commands, for each tick with some is recorded.
        there = [commands.get(tick) for commands, states in zip(all_commands, all_states)
                 if states and min(states) <= tick <= max(states) and tick in states]
        if any(one != there[0] for one in there):
            raise Failed(f'commands differ at tick {tick}')
    return compared, sum(map(len, all_commands[0].values()))


def until(what, holds, timeout=30):
    end = time.monotonic() + timeout
    while not holds():
        if time.monotonic() > end:
            raise Failed(f'{what}: not within {timeout:g} s')
        time.sleep(0.05)
    return time.monotonic()


def ticker(nodes):
    """The node that makes the ticks, once one does."""
    found = []

    def one():
        found[:] = [node for node in nodes if node.process.poll() is None and node.cluster('ticker')]
        return len(found) == 1
    until('one node makes the ticks', one)
    return found[0]


def stop(*parts):
    for part in parts:
        with contextlib.suppress(Failed, ProcessLookupError):
            if isinstance(part, Node):
                if part.process.poll() is None:
                    part.process.send_signal(signal.SIGCONT)
                part.stop()
            else:
                part.stop()
