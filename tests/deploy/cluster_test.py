"""./dev cluster: it starts, and ends as a whole."""
import os
import pathlib
import shutil
import signal
import socket
import unittest

from support import ROOT, Part, free_ports, get, until

PORTS = 23  # that it takes, one after the other


def children(pid):
    """{PID: command line} of the processes that it started and that run."""
    found = {}
    for child in pathlib.Path(f'/proc/{pid}/task/{pid}/children').read_text().split():
        found[int(child)] = pathlib.Path(f'/proc/{child}/cmdline').read_text().replace('\0', ' ')
    return found


def is_there(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


class DevCluster(unittest.TestCase):
    def start(self, *more):
        self.port, = free_ports(1, PORTS)
        self.addCleanup(shutil.rmtree, ROOT / f'build/cluster/{self.port}', ignore_errors=True)
        return self.dev('--nodes', 2, '--scene', 'cloud', '--port', self.port, *more)

    def dev(self, *options):
        cluster = Part('./dev', 'cluster', *options)
        self.addCleanup(self.clean, cluster)
        return cluster

    def clean(self, cluster):
        """Nothing stays, also where a test has failed."""
        parts = children(cluster.process.pid) if cluster.process.poll() is None else {}
        try:
            cluster.stop()
        finally:
            for pid in filter(is_there, parts):
                os.kill(pid, signal.SIGKILL)

    def assert_ends(self, cluster, code):
        self.assertEqual(cluster.process.wait(timeout=40), code, cluster.said())

    def test_a_dead_node_is_started_again_and_one_that_dies_again_ends_it(self):
        cluster = self.start('--', '--ahead', 'off')
        cluster.says(f'The cloud: http://127.0.0.1:{self.port}')
        parts = children(cluster.process.pid)
        self.assertEqual(sum('brume-server' in command for command in parts.values()), 2)
        self.assertEqual(get(f'http://127.0.0.1:{self.port}/')[0], 200)
        self.assertEqual(get(f'http://127.0.0.1:{self.port + 10}/-/ready')[0], 200)
        ticks = f'http://127.0.0.1:{self.port + 20}/node/n2/metrics'
        until('n2 is in the cluster', lambda: b'\nbrume_cluster_nodes 2\n' in get(ticks)[2])
        self.kill_n1(cluster)
        cluster.says('n1 has ended and is started again')
        own = f'http://127.0.0.1:{self.port + 20}/node/n1/metrics'
        until('n1 follows the log again', lambda: b'\nbrume_cluster_connected 1\n' in get(own)[2])
        parts |= children(cluster.process.pid)
        self.kill_n1(cluster)
        self.assert_ends(cluster, 1)
        self.assertRegex(cluster.said(), rf'dev: n1 has ended; .* Its log: .*/build/cluster/{self.port}/n1\.log\n$')
        self.assertEqual([pid for pid in parts if is_there(pid)], [])

    def kill_n1(self, cluster):
        os.kill(next(pid for pid, command in children(cluster.process.pid).items()
                     if f'--port {self.port + 1} ' in command), signal.SIGKILL)

    def test_a_signal_ends_it(self):
        cluster = self.start('--', '--ahead', 'off')
        cluster.says('Starting NATS')
        parts = until('some run', lambda: children(cluster.process.pid))
        cluster.process.terminate()
        self.assert_ends(cluster, 143)
        self.assertEqual([pid for pid in parts if is_there(pid)], [])

    def test_a_node_that_does_not_start_is_told_of(self):
        cluster = self.start('--', '--scene-dir', '/nonexistent')
        self.assert_ends(cluster, 1)
        self.assertRegex(cluster.said(), r'/nonexistent[^\n]*\n(?s:.*)dev: n[12] has ended; ')

    def test_a_port_in_use_is_one_line(self):
        self.port, = free_ports(1, PORTS)
        with socket.create_server(('127.0.0.1', self.port + 2)):
            cluster = self.dev('--port', self.port)
            self.assert_ends(cluster, 1)
        self.assertRegex(cluster.said(), rf'\ndev: port {self.port + 2} is in use\. [^\n]*\n$')

    def test_wrong_options_are_one_line(self):
        for options, line in (
                (('--nodes', '10'), '--nodes takes 1 to 9.'),
                (('--port', '65530'), '--port takes 1 to 65513.'),
                (('--shards', '2'), "./dev cluster knows no '--shards';")):
            cluster = self.dev(*options)
            self.assert_ends(cluster, 1)
            self.assertIn(f'dev: {line}', cluster.said())


if __name__ == '__main__':
    unittest.main()
