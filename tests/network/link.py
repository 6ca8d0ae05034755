"""A link with delay, loss and a rate between two network interfaces that it makes: link.py NAME NAME [--delay MS] ...

Whole packets are passed in user space (two TUN devices), so that TCP meets them as it would outside: it retransmits what is lost and
slows down where packets queue. Prints "ready" once both interfaces exist; whoever started it moves them where they belong.
Needs root. Resolution: about 1 ms, and what the machine's other work adds.
"""
import argparse
import collections
import fcntl
import os
import random
import select
import struct
import time

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
MTU = 1500


def tun(name):
    device = os.open('/dev/net/tun', os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, TUNSETIFF, struct.pack('16sH22x', name.encode(), IFF_TUN | IFF_NO_PI))
    return device


class Way:
    """One direction: packets that wait for the line, then for the delay."""

    def __init__(self, source, sink, options):
        self.source, self.sink = source, sink
        self.delay, self.loss = options.delay * 1e-3 / 2, options.loss * 1e-2
        self.rate = options.rate * 1e6 / 8  # bytes/s; 0: any
        self.free = 0.0  # when the line has sent all that waits
        self.most_wait = options.queue * 1e-3
        self.flying = collections.deque()  # (when it arrives, packet)
        self.random = random.Random(1)

    def take(self):
        try:
            while True:
                packet = os.read(self.source, 65536)
                now = time.monotonic()
                if self.random.random() < self.loss:
                    continue
                sent = now
                if self.rate:
                    if self.free - now > self.most_wait:  # the queue before the line is full
                        continue
                    sent = self.free = max(now, self.free) + len(packet) / self.rate
                self.flying.append((sent + self.delay, packet))
        except BlockingIOError:
            pass

    def give(self):
        while self.flying and self.flying[0][0] <= time.monotonic():
            try:
                os.write(self.sink, self.flying.popleft()[1])
            except OSError:  # the interface is not up, yet or any more
                pass

    def due(self):
        return self.flying[0][0] if self.flying else float('inf')


def main():
    about = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    about.add_argument('names', nargs=2)
    about.add_argument('--delay', type=float, default=0, help='ms, there and back')
    about.add_argument('--loss', type=float, default=0, help='percent of the packets, each way')
    about.add_argument('--rate', type=float, default=0, help='Mbit/s, each way; 0: any')
    about.add_argument('--queue', type=float, default=200, help='ms of packets that wait for a line with a rate; more are lost')
    options = about.parse_args()
    one, two = map(tun, options.names)
    there, back = Way(one, two, options), Way(two, one, options)
    print('ready', flush=True)
    while True:
        wait = min(there.due(), back.due()) - time.monotonic()
        readable, _, _ = select.select([one, two], [], [], max(0, min(wait, 1)))
        for way in (there, back):
            if way.source in readable:
                way.take()
            way.give()


if __name__ == '__main__':
    main()
