"""HAProxy with our configuration, in front of two real servers."""
import signal
import socket
import subprocess
import tempfile
import time
import unittest

from support import DEPLOY, PROGRAMS, ROOT, Cloud, Part, get, until

DRAIN_MS = 4000


def open_socket(cloud, node, **more):
    """A WebSocket by HAProxy to that node, after its handshake."""
    peer = socket.create_connection(('127.0.0.1', cloud.port), timeout=10, **more)
    peer.sendall((f'GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{cloud.port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n'
                  f'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: brume.v1\r\nCookie: brume={node}\r\n'
                  'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n').encode())
    answer = peer.recv(4096)
    if b' 101 ' not in answer:
        raise AssertionError(answer)
    return peer


class Proxy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cloud = Cloud(2, ['--drain-time', DRAIN_MS, '--handshake', '60000'])
        cls.addClassCleanup(cls.cloud.stop)

    def setUp(self):
        """Every test begins with two nodes."""
        for name, node in self.cloud.nodes.items():
            if node.process.poll() is not None:
                self.cloud.start(name)
        for name in self.cloud.ports:
            until(f'{name} is back', lambda name=name: self.cloud.is_up(name))

    def test_page_and_cookie(self):
        status, headers, body = get(self.cloud.url + '/')
        self.assertEqual(status, 200)
        self.assertIn(b'<html', body)
        cookie = headers['Set-Cookie']
        self.assertRegex(cookie, r'^brume=n[12]; .*HttpOnly; SameSite=Strict')
        for _ in range(4):  # whoever has a cookie gets no other: it is the same node
            status, headers, _ = get(self.cloud.url + '/readyz', {'Cookie': cookie.split(';')[0]})
            self.assertEqual((status, headers['Set-Cookie']), (200, None))

    def test_new_viewers_go_to_both_nodes(self):
        held = [open_socket(self.cloud, 'n1') for _ in range(3)]
        cookies = {get(self.cloud.url + '/readyz')[1]['Set-Cookie'].split(';')[0] for _ in range(2)}
        self.assertEqual(cookies, {'brume=n2'}, 'n1 has three connections, n2 has none')
        for peer in held:
            peer.close()

    def test_metrics_are_of_the_node_that_was_asked(self):
        for name in self.cloud.ports:
            self.assertEqual(self.cloud.metric(name, 'brume_ready'), 1)
        peer = open_socket(self.cloud, 'n2')
        until('n2 counts the WebSocket, n1 does not', lambda: (
            self.cloud.metric('n2', 'brume_connections') >= self.cloud.metric('n1', 'brume_connections') + 1))
        peer.close()
        self.assertEqual(get(self.cloud.metrics_url('n9'))[0], 404)
        self.assertEqual(get(f'http://127.0.0.1:{self.cloud.metrics_port}/viewers')[0], 404)

    def test_nodes_know_the_viewers_address(self):
        peer = open_socket(self.cloud, 'n1', source_address=('127.0.0.77', 0))
        hello = (ROOT / 'protocol/examples/hello_defaults.bin').read_bytes()
        # One binary frame, masked with zeros.
        peer.sendall(bytes([0x82, 0x80 | len(hello), 0, 0, 0, 0]) + hello)
        self.cloud.nodes['n1'].says(r'viewer \d+.* from 127\.0\.0\.77,')
        peer.close()

    def test_nobody_comes_past_the_proxy(self):
        self.assertEqual(get(f'http://127.0.0.1:{self.cloud.ports["n1"][0]}/readyz')[0], 0)

    def test_health_check_of_the_image(self):
        for proxied, code in (('true', 0), ('', 1)):
            environment = {'PATH': '/usr/bin:/bin', 'BRUME_PORT': str(self.cloud.ports['n1'][0]),
                           'BRUME_PROXY_PROTOCOL': proxied}
            done = subprocess.run(DEPLOY / 'container/brume-health', env=environment, stderr=subprocess.DEVNULL,
                                  timeout=20, check=False)
            self.assertEqual(done.returncode, code)

    def test_requests_of_a_killed_node_go_to_the_other(self):
        peer = open_socket(self.cloud, 'n1')
        self.cloud.nodes['n1'].stop(signal.SIGKILL)
        killed = time.monotonic()
        status, headers, _ = get(self.cloud.url + '/readyz', {'Cookie': 'brume=n1'})
        took = time.monotonic() - killed
        self.assertEqual((status, headers['Set-Cookie'].split(';')[0]), (200, 'brume=n2'))
        self.assertLess(took, 1)
        self.assertEqual(peer.recv(4096), b'', 'its WebSockets end')
        self.assertLess(time.monotonic() - killed, 1)
        peer.close()
        until('HAProxy notices', lambda: not self.cloud.is_up('n1'), 2)

    def test_viewer_of_a_killed_node_goes_on_at_the_other(self):
        with tempfile.TemporaryDirectory() as folder:
            viewer = Part(PROGRAMS / 'brume-client', '--url', f'ws://127.0.0.1:{self.cloud.port}', '--headless',
                          '--size', '160x90', '--path', 'orbit', '--seconds', 600, '--out', folder, '--no-save')
            self.addCleanup(viewer.stop, signal.SIGKILL)
            name = until('the viewer is in', lambda: next(
                (name for name in self.cloud.ports if self.cloud.metric(name, 'brume_viewers') == 1), None))
            other = {'n1': 'n2', 'n2': 'n1'}[name]
            self.cloud.nodes[name].stop(signal.SIGKILL)
            killed = time.monotonic()
            until('the viewer is in again', lambda: self.cloud.metric(other, 'brume_viewers') == 1, 5)
            print(f'a viewer was on the other node {time.monotonic() - killed:.2f} s after its node was killed')
            sent = 'brume_frames_total{fate="sent"}'
            until('and has frames', lambda: self.cloud.metric(other, sent) > 3)

    def test_a_node_that_drains_keeps_its_sockets_and_gets_no_new_ones(self):
        peer = open_socket(self.cloud, 'n1')
        node = self.cloud.nodes['n1']
        self.addCleanup(node.stop, signal.SIGKILL)
        node.process.terminate()
        asked = time.monotonic()
        for headers in ({}, {'Cookie': 'brume=n1'}):
            def goes_on(headers=headers):
                cookie = get(self.cloud.url + '/readyz', headers)[1]['Set-Cookie']
                return cookie and cookie.startswith('brume=n2;')
            until('new requests go to the other node', goes_on, DRAIN_MS / 3000)
        self.assertIsNone(node.process.poll(), 'it still drains')
        peer.settimeout(20)
        try:
            peer.recv(4096)  # the Goodbye, or the end
        except ConnectionResetError:
            pass
        self.assertGreater(time.monotonic() - asked, DRAIN_MS / 1000 - 0.2, 'nobody was cut before the drain time')
        self.assertEqual(node.process.wait(timeout=20), 0)
        peer.close()


if __name__ == '__main__':
    unittest.main()
