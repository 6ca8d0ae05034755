#!/usr/bin/env python3
"""The server's WebSocket against an implementation that has nothing in common with ours: Python's `websockets` (package
python3-websockets), its protocol without input or output, on a plain socket. What RFC 6455 asks for, section by section.

websocket_conformance.py SERVER: the program to start. Exit status 77: the package is missing.
"""
import contextlib
import pathlib
import re
import socket
import struct
import subprocess
import sys
import time
import unittest

try:
    from websockets.frames import Frame, Opcode
    from websockets.uri import parse_uri
    try:
        from websockets.client import ClientProtocol
    except ImportError:  # before 11
        from websockets.client import ClientConnection as ClientProtocol
except ImportError:
    print('skipped: the package python3-websockets is missing; ./dev test integration installs it')
    sys.exit(77)

PATIENCE = 20  # s: nothing should take this long; a loaded machine may
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / 'protocol' / 'examples'
HELLO, POSE, PING = ((EXAMPLES / f'{name}.bin').read_bytes() for name in ('hello_defaults', 'pose', 'ping'))
program = None


class Peer:
    """One connection. Frames that come are kept in order; `websockets` checks each one and answers pings and closes."""

    def __init__(self, port, subprotocols=('brume.v1',)):
        self.socket = socket.create_connection(('127.0.0.1', port), timeout=PATIENCE)
        self.protocol = ClientProtocol(parse_uri(f'ws://127.0.0.1:{port}/ws'), subprotocols=list(subprotocols) or None)
        self.protocol.send_request(self.protocol.connect())
        self.frames, self.ended = [], False
        self.flush()

    def flush(self):
        for data in self.protocol.data_to_send():
            with contextlib.suppress(OSError):  # it may have closed already
                self.socket.sendall(data) if data else self.socket.shutdown(socket.SHUT_WR)

    def receive(self):
        """Whatever comes next; False at the end."""
        try:
            data = self.socket.recv(65536)
        except ConnectionError:
            data = b''
        if self.ended:
            return False
        if data:
            self.protocol.receive_data(data)
        else:
            self.protocol.receive_eof()
            self.ended = True
        self.frames += [event for event in self.protocol.events_received() if isinstance(event, Frame)]
        self.flush()
        return not self.ended

    def opened(self):
        # A refused connection stays in that state until its end, which comes late: another request may follow.
        while self.protocol.state.name == 'CONNECTING' and not self.protocol.handshake_exc and self.receive():
            pass
        return self.protocol.state.name == 'OPEN'

    def wait(self, wanted):
        """The first frame not yet seen for which wanted(frame) holds; those before it are passed over. None at the end."""
        while True:
            while self.frames:
                frame = self.frames.pop(0)
                if wanted(frame):
                    return frame
            if not self.receive():
                return None

    def raw(self, opcode, data=b'', mask=True, **bits):
        self.bytes(Frame(opcode, data, **bits).serialize(mask=mask))

    def bytes(self, data):
        with contextlib.suppress(ConnectionError):
            self.socket.sendall(data)

    def close_code(self):
        """What the server closes with, after everything else that it sends; None for a connection that just ends."""
        while self.receive():
            pass
        return self.protocol.close_rcvd.code if self.protocol.close_rcvd else None


def body_of(frame):
    """The type of a message's body, as in brume.fbs: 1 Hello ... 8 Welcome, 9 SceneState, 10 Frame, 11 Error."""
    data = frame.data
    table = 4 + struct.unpack_from('<I', data, 4)[0]
    vtable = table - struct.unpack_from('<i', data, table)[0]
    return data[table + struct.unpack_from('<H', data, vtable + 4)[0]]


def message(kind):
    return lambda frame: frame.opcode == Opcode.BINARY and body_of(frame) == kind


PONG_MESSAGE, GOODBYE, WELCOME, FRAME, ERROR = map(message, (6, 7, 8, 10, 11))


class Conformance(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = subprocess.Popen([program, '--port', '0', '--scene', 'cloud', '--ahead', 'off', '--idle', '4000',
                                       '--handshake', '3000'],
                                      stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for line in cls.server.stdout:
            if found := re.search(r'listening on http://.*:(\d+)', line):
                cls.port = int(found[1])
                return
        raise RuntimeError('the server does not start')

    @classmethod
    def tearDownClass(cls):
        cls.server.terminate()
        assert cls.server.wait(PATIENCE) == 0, 'the server survived all of it'
        cls.server.stdout.close()

    def peer(self, welcomed=True):
        peer = Peer(self.port)
        self.addCleanup(peer.socket.close)
        self.assertTrue(peer.opened(), peer.protocol.handshake_exc)
        if welcomed:
            peer.raw(Opcode.BINARY, HELLO)
            self.assertIsNotNone(peer.wait(WELCOME))
        return peer

    def alive(self, peer):
        peer.raw(Opcode.PING, b'alive')
        self.assertIsNotNone(peer.wait(lambda f: f.opcode == Opcode.PONG and f.data == b'alive'))

    # 4: the opening handshake. `websockets` checks Upgrade, Connection and Sec-WebSocket-Accept.
    def test_handshake_takes_our_subprotocol_and_no_extension(self):
        peer = Peer(self.port, ['brume.v2', 'brume.v1'])
        self.addCleanup(peer.socket.close)
        self.assertTrue(peer.opened())
        self.assertEqual(peer.protocol.subprotocol, 'brume.v1')
        self.assertEqual(peer.protocol.extensions, [])

    def test_handshake_without_our_subprotocol_is_refused(self):
        for names in ([], ['brume.v2']):
            peer = Peer(self.port, names)
            self.addCleanup(peer.socket.close)
            self.assertFalse(peer.opened())
            self.assertIn('400', str(peer.protocol.handshake_exc))

    def test_handshake_of_another_version_is_refused(self):
        peer = socket.create_connection(('127.0.0.1', self.port), timeout=PATIENCE)
        self.addCleanup(peer.close)
        peer.sendall(b'GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
                     b'Sec-WebSocket-Protocol: brume.v1\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n'
                     b'Sec-WebSocket-Version: 8\r\n\r\n')
        answer = peer.recv(4096)
        self.assertRegex(answer, rb'^HTTP/1.1 4(26|00) ')
        self.assertRegex(answer, rb'(?i)\r\nSec-WebSocket-Version: 13\r\n')  # 4.4: which version would do

    # 5.4: fragments, with control frames between them.
    def test_a_fragmented_message_is_one_message(self):
        peer = self.peer(welcomed=False)
        peer.raw(Opcode.BINARY, HELLO[:7], fin=False)
        peer.raw(Opcode.CONT, b'', fin=False)
        peer.raw(Opcode.PING, b'between')
        peer.raw(Opcode.CONT, HELLO[7:], fin=True)
        self.assertIsNotNone(peer.wait(lambda f: f.opcode == Opcode.PONG and f.data == b'between'))
        self.assertIsNotNone(peer.wait(WELCOME))

    def test_every_byte_a_fragment_and_a_packet(self):
        peer = self.peer(welcomed=False)
        peer.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for at in range(len(HELLO)):
            for byte in Frame(Opcode.CONT if at else Opcode.BINARY, HELLO[at:at + 1], fin=at + 1 == len(HELLO)).serialize(mask=True):
                peer.bytes(bytes([byte]))
        self.assertIsNotNone(peer.wait(WELCOME))

    def test_frames_come_unmasked_and_whole(self):  # `websockets` refuses masked ones
        peer = self.peer()
        peer.raw(Opcode.BINARY, POSE)
        frame = peer.wait(FRAME)
        self.assertIsNotNone(frame)
        self.assertTrue(frame.fin)
        self.assertIn(b'\xff\xd8\xff', frame.data)

    # 5.5: control frames.
    def test_pings_are_answered_in_order_with_their_bytes(self):
        peer = self.peer()
        for data in (b'', b'x' * 125, bytes(range(100))):
            peer.raw(Opcode.PING, data)
            self.assertEqual(peer.wait(lambda f: f.opcode == Opcode.PONG).data, data)
        peer.raw(Opcode.PONG, b'nobody asked')
        self.alive(peer)

    def test_our_own_ping_is_answered_by_a_message(self):
        peer = self.peer(welcomed=False)
        peer.raw(Opcode.BINARY, PING)
        self.assertIsNotNone(peer.wait(PONG_MESSAGE))

    def test_a_silent_peer_is_pinged_and_one_that_answers_stays(self):
        peer = self.peer()
        peer.raw(Opcode.BINARY, POSE)  # without one it would be told goodbye
        self.assertIsNotNone(peer.wait(lambda f: f.opcode == Opcode.PING))
        end = time.monotonic() + 6  # beyond --idle; `websockets` answers the pings
        while time.monotonic() < end:
            self.assertTrue(peer.receive())
        self.alive(peer)

    # 5.6: text is not ours, though well formed: told, and borne twice.
    def test_text_is_answered_and_the_third_closes(self):
        peer = self.peer()
        for _ in range(2):
            peer.raw(Opcode.TEXT, 'schön'.encode())
            self.assertIsNotNone(peer.wait(ERROR))
        self.alive(peer)
        peer.raw(Opcode.TEXT, b'again')
        self.assertEqual(peer.close_code(), 1002)

    # 5.1, 5.2, 5.5, 8.1: what must fail the connection.
    def test_violations_close_with_the_right_code(self):
        huge = struct.pack('!BBQ', 0x82, 0xFF, 1 << 63) + bytes(4)
        for name, data, codes in (
                ('an unmasked frame', Frame(Opcode.BINARY, PING).serialize(mask=False), {1002}),
                ('a reserved bit', b'\xc2' + Frame(Opcode.BINARY, PING).serialize(mask=True)[1:], {1002}),
                ('a reserved opcode', bytes([0x83, 0x80, 0, 0, 0, 0]), {1002}),
                ('a reserved control opcode', bytes([0x8B, 0x80, 0, 0, 0, 0]), {1002}),
                ('a continuation of nothing', Frame(Opcode.CONT, b'x').serialize(mask=True), {1002}),
                ('a message within a message', 2 * Frame(Opcode.BINARY, b'x', fin=False).serialize(mask=True), {1002}),
                ('a fragmented ping', bytes([0x09, 0x80, 0, 0, 0, 0]), {1002}),
                ('a ping of 126 bytes', bytes([0x89, 0xFE, 0, 126, 0, 0, 0, 0]) + bytes(126), {1002}),
                ('a close of one byte', bytes([0x88, 0x81, 0, 0, 0, 0, 3]), {1002}),
                ('a close code that may not be sent', bytes([0x88, 0x82, 0, 0, 0, 0]) + struct.pack('!H', 1005), {1002}),
                ('a length of 64 bits with the highest set', huge, {1002, 1009}),
                ('text that is not UTF-8', Frame(Opcode.TEXT, b'\xc3\x28').serialize(mask=True), {1007})):
            with self.subTest(name):
                peer = self.peer()
                peer.bytes(data)
                self.assertIn(peer.close_code(), codes)

    def test_a_message_over_the_limit_closes_with_1009(self):
        whole = self.peer()
        whole.raw(Opcode.BINARY, bytes(64 * 1024 + 1))
        self.assertEqual(whole.close_code(), 1009)
        pieces = self.peer()  # each below it
        pieces.raw(Opcode.BINARY, bytes(40 * 1024), fin=False)
        pieces.raw(Opcode.CONT, bytes(40 * 1024))
        self.assertEqual(pieces.close_code(), 1009)
        at_the_limit = self.peer()  # zeros are no message of ours, but not too many
        at_the_limit.raw(Opcode.BINARY, bytes(64 * 1024))
        self.assertIsNotNone(at_the_limit.wait(ERROR))
        self.alive(at_the_limit)

    # 5.5.1, 7: closing.
    def test_a_close_is_echoed_and_the_connection_ends(self):
        for code in (1000, 1001, 3000, 4999):
            peer = self.peer()
            peer.protocol.send_close(code, 'enough')
            peer.flush()
            self.assertEqual(peer.close_code(), code)
            self.assertTrue(peer.ended)
        empty = self.peer()
        empty.raw(Opcode.CLOSE)
        empty.close_code()
        self.assertTrue(empty.ended)

    def test_nothing_follows_a_close(self):
        peer = self.peer()
        peer.raw(Opcode.BINARY, POSE)
        self.assertIsNotNone(peer.wait(FRAME))
        peer.protocol.send_close(1000)
        peer.flush()
        while peer.receive():
            pass
        opcodes = [frame.opcode for frame in peer.frames]
        self.assertEqual(opcodes.index(Opcode.CLOSE), len(opcodes) - 1)

    def test_who_never_says_hello_is_told_goodbye_and_closed(self):
        peer = self.peer(welcomed=False)
        self.assertIsNotNone(peer.wait(GOODBYE))
        self.assertEqual(peer.close_code(), 1008)
        self.assertIn('Hello', peer.protocol.close_rcvd.reason)


if __name__ == '__main__':
    program = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
