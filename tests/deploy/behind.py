"""What every proxy of deploy/ must pass on to one real server behind it."""
import http.client
import os
import re
import signal
import socket
import tempfile
import time

from support import PROGRAMS, ROOT, Part, free_ports, get, until

HELLO = (ROOT / 'protocol/examples/hello_defaults.bin').read_bytes()
PREFIX = '/clouds/brume/'


def open_socket(port, path='/ws', host='127.0.0.1', headers=(), **more):
    """(socket, answer): a WebSocket's handshake through the proxy, as a page of it would make it."""
    name = f'[{host}]' if ':' in host else host
    peer = socket.create_connection((host, port), timeout=10, **more)
    lines = [f'GET {path} HTTP/1.1', f'Host: {name}:{port}', f'Origin: http://{name}:{port}', 'Connection: Upgrade',
             'Upgrade: websocket', 'Sec-WebSocket-Version: 13', 'Sec-WebSocket-Protocol: brume.v1',
             'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', *headers, '', '']
    peer.sendall('\r\n'.join(lines).encode())
    answer = b''
    while b'\r\n\r\n' not in answer:
        part = peer.recv(4096)
        if not part:
            break
        answer += part
    return peer, answer


def say_hello(peer):
    """Sends a Hello, as one binary frame masked with zeros, and waits for the first bytes of the Welcome."""
    peer.sendall(bytes([0x82, 0x80 | len(HELLO), 0, 0, 0, 0]) + HELLO)
    return peer.recv(4)


class Behind:
    """A mixin for unittest.TestCase: `start_proxy` starts one before the server at `server_port`, at `port`."""
    server_options = ('--open', '--trusted-proxy', '127.0.0.1')

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix='brume-')
        cls.addClassCleanup(cls.folder.cleanup)
        cls.port, cls.server_port = free_ports(2)
        cls.url = f'http://127.0.0.1:{cls.port}'
        cls.server = Part(PROGRAMS / 'brume-server', '--port', cls.server_port, '--scene', 'cloud', '--ahead', 'off',
                          '--measure-error', '0', *cls.server_options)
        cls.addClassCleanup(cls.server.stop, signal.SIGKILL)
        cls.server.says('listening on http://')
        cls.proxy = cls.start_proxy(cls.folder.name)
        cls.addClassCleanup(cls.proxy.stop)
        until('the proxy answers', lambda: get(f'{cls.url}/healthz')[0] == 200)

    def test_page_at_the_root_and_below_a_prefix(self):
        for prefix in ('/', PREFIX):
            status, headers, body = get(self.url + prefix)
            self.assertEqual(status, 200)
            self.assertIn("default-src 'self'", headers['Content-Security-Policy'])
            script = re.search(rb'src="\./(assets/[^"]*\.js)"', body)[1].decode()
            self.assertEqual(get(self.url + prefix + script)[0], 200)
            self.assertEqual(get(f'{self.url}{prefix}snapshot.jpg?w=64&h=36')[2][:2], b'\xff\xd8')

    def test_an_address_without_its_slash_leads_to_the_page(self):
        asked = http.client.HTTPConnection('127.0.0.1', self.port, timeout=10)
        asked.request('GET', PREFIX[:-1])
        answer = asked.getresponse()
        self.assertIn(answer.status, (301, 302, 308))
        self.assertTrue(answer.headers['Location'].endswith(PREFIX), answer.headers['Location'])
        asked.close()

    def test_websockets_pass(self):
        for host in ('127.0.0.1', '::1'):
            for path in ('/ws', f'{PREFIX}ws'):
                peer, answer = open_socket(self.port, path, host)
                with peer:
                    self.assertIn(b' 101 ', answer.split(b'\r\n')[0])
                    self.assertTrue(say_hello(peer))

    def test_the_log_has_the_visitors_address_and_no_other_that_it_claims(self):
        for i, claimed in enumerate(((), ('X-Forwarded-For: 203.0.113.9',), ('X-Forwarded-For: 127.0.0.1, 127.0.0.1',),
                                     ('Forwarded: for=203.0.113.9', 'X-Real-IP: 203.0.113.9'))):
            peer, answer = open_socket(self.port, headers=claimed, source_address=(f'127.0.0.{77 + i}', 0))
            with peer:
                self.assertIn(b' 101 ', answer.split(b'\r\n')[0])
                say_hello(peer)
                self.server.says(rf'viewer \d+.* from 127\.0\.0\.{77 + i},')
        self.assertNotIn('from 203.0.113.9', self.server.said())

    def test_a_picture_comes_although_none_follows(self):
        """The stream of a scene at rest: a proxy that waits for more would hold its one picture back."""
        self.assertEqual(get(f'{self.url}/pause', method='POST')[0], 200)
        self.addCleanup(get, f'{self.url}/resume', method='POST')
        self.assertTrue(any(self.pictures_at_first() == 1 for _ in range(3)), 'the next ones come with it')

    def pictures_at_first(self):
        """How many pictures of a stream have come once the first one is whole. The server sends one a second."""
        asked = http.client.HTTPConnection('127.0.0.1', self.port, timeout=20)
        asked.request('GET', '/stream.mjpg?w=16&h=16')
        stream, got = asked.getresponse(), b''
        while b'\xff\xd9' not in got:
            part = stream.read1(65536)
            self.assertTrue(part, 'the stream goes on')
            got += part
        asked.close()
        return got.count(b'\xff\xd8')

    def test_an_upload_of_a_few_megabytes_reaches_the_server(self):
        status, _, body = get(f'{self.url}/cloud?name=none', method='POST', data=os.urandom(3 << 20))
        self.assertEqual((status, body[:14]), (422, b'none.ply:1: PL'), 'the server has read it')

    def test_what_passes_is_not_delayed(self):
        peer, _ = open_socket(self.port)
        with peer:
            say_hello(peer)
            peer.setblocking(False)
            until('news of the scene come each second', lambda: self.read(peer), 5)

    @staticmethod
    def read(peer):
        try:
            return peer.recv(4096)
        except BlockingIOError:
            time.sleep(0.01)
            return b''
