#!/usr/bin/env python3
"""Viewers behind bad links: what they get, and what the others lose by them. Front door: ./dev netem.

The server has a network namespace of its own; fast viewers sit in a second one behind a clean link, one slow viewer in a third
behind the link that is tried. Root and `ip` are needed.
"""
import argparse
import contextlib
import dataclasses
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from programs import Failed, Load, Server, machine, tell, write

HERE = pathlib.Path(__file__).resolve().parent
SERVER, FAST, SLOW = 'brume-server', 'brume-fast', 'brume-slow'
PORT = 8080
QUEUE_MS = 200  # of packets before a line with a rate, as a good router has


@dataclasses.dataclass
class Case:
    name: str
    delay: float = 0  # ms, there and back
    loss: float = 0  # percent, each way
    rate: float = 0  # Mbit/s, each way
    stalls: bool = False


CLEAN = Case('clean')
CASES = [CLEAN,
         *(Case(f'{ms} ms there and back', delay=ms) for ms in (20, 100, 300)),
         *(Case(f'{percent} % loss, 20 ms', delay=20, loss=percent) for percent in (1, 5)),
         *(Case(f'{rate} Mbit/s, 20 ms', delay=20, rate=rate) for rate in (1, 5, 20)),
         Case('stops reading', stalls=True)]


def ip(*words):
    done = subprocess.run(['ip', *words], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failed(f'ip {" ".join(words)}: {done.stderr.strip()}')


def inside(space):
    return ['ip', 'netns', 'exec', space]


def up(space, name, address):
    ip('-n', space, 'addr', 'add', f'{address}/24', 'dev', name)
    ip('-n', space, 'link', 'set', name, 'up')


def pair(one, two, one_space, two_space):
    ip('link', 'add', 'name', one, 'netns', one_space, 'type', 'veth', 'peer', 'name', two, 'netns', two_space)


@contextlib.contextmanager
def spaces():
    for space in (SERVER, FAST, SLOW):
        subprocess.run(['ip', 'netns', 'del', space], capture_output=True)  # of a run that was killed
    try:
        for space in (SERVER, FAST, SLOW):
            ip('netns', 'add', space)
            ip('-n', space, 'link', 'set', 'lo', 'up')
        pair('fast0', 'fast1', SERVER, FAST)
        up(SERVER, 'fast0', '10.91.1.1')
        up(FAST, 'fast1', '10.91.1.2')
        yield
    finally:
        for space in (SERVER, FAST, SLOW):
            subprocess.run(['ip', 'netns', 'del', space], capture_output=True)


def kernel_can():
    """Is there a tc that can netem? Tried on a pair of interfaces."""
    if not shutil.which('tc'):
        return False
    pair('slow0', 'slow1', SERVER, SLOW)
    done = subprocess.run([*inside(SERVER), *'tc qdisc add dev slow0 root netem delay 1ms'.split()], capture_output=True)
    ip('-n', SERVER, 'link', 'del', 'slow0')
    return done.returncode == 0


@contextlib.contextmanager
def link(case, by_kernel):
    """slow0 in the server's namespace to slow1 in the slow viewer's, as the case says."""
    process = None
    if by_kernel:
        pair('slow0', 'slow1', SERVER, SLOW)
        how = ['delay', f'{case.delay / 2}ms', 'loss', f'{case.loss}%']
        if case.rate:
            packets = max(10, case.rate * 1e6 / 8 * QUEUE_MS * 1e-3 / 1500)
            how += ['rate', f'{case.rate}mbit', 'limit', str(round(packets))]
        for space, name in ((SERVER, 'slow0'), (SLOW, 'slow1')):
            subprocess.run([*inside(space), 'tc', 'qdisc', 'add', 'dev', name, 'root', 'netem', *how], check=True)
    else:
        process = subprocess.Popen(
            [sys.executable, str(HERE / 'link.py'), 'slow0', 'slow1', '--delay', str(case.delay), '--loss', str(case.loss),
             '--rate', str(case.rate), '--queue', str(QUEUE_MS)], stdout=subprocess.PIPE)
        if process.stdout.readline().strip() != b'ready':
            raise Failed('the link cannot be made: is there /dev/net/tun?')
        ip('link', 'set', 'slow0', 'netns', SERVER)
        ip('link', 'set', 'slow1', 'netns', SLOW)
    try:
        up(SERVER, 'slow0', '10.91.2.1')
        up(SLOW, 'slow1', '10.91.2.2')
        yield
    finally:
        if process:
            process.kill()
            process.wait()
        else:
            ip('-n', SERVER, 'link', 'del', 'slow0')


def fast(options):
    return Load(options.programs, f'ws://10.91.1.1:{PORT}/ws', options.fast, options.seconds, '--anywhere', '--warm-up', '1',
                '--width', '320', '--height', '180', inside=inside(FAST))


def beside(case, options, by_kernel):
    """The fast viewers beside the slow one, and the slow one's own run."""
    with link(case, by_kernel):
        # From before the fast ones begin until after they end.
        slow = Load(options.programs, f'ws://10.91.2.1:{PORT}/ws', 1, options.seconds + 4, '--anywhere', '--warm-up', '1',
                    '--timeout', '60', inside=inside(SLOW))
        time.sleep(2.5)
        if case.stalls:
            slow.process.send_signal(signal.SIGSTOP)
        try:
            others = fast(options).result()
        finally:
            slow.process.send_signal(signal.SIGCONT)
        return others, slow.result()


def measure(case, options, by_kernel):
    """The fast viewers beside the same viewer behind a clean link (of that case itself: alone), then beside the slow one."""
    before = fast(options).result() if case is CLEAN else beside(CLEAN, options, by_kernel)[0]
    return before, *beside(case, options, by_kernel)


def least(runs, what):
    """The run that was disturbed the least by whatever else the machine does: that only adds."""
    return min(runs, key=lambda run: run[what]['p95'])


def row(case, before, others, slow, window):
    fps = slow['fps']['median']
    two_windows = 2e3 * window / fps
    ratio = others['latency_ms']['p95'] / before['latency_ms']['p95']
    missed = []
    if slow['age_ms']['most'] > two_windows and not case.stalls:
        missed.append(f'{case.name}: the oldest frame is {slow["age_ms"]["most"]:.0f} ms old, two windows are {two_windows:.0f} ms')
    if ratio > 1.1 and case is not CLEAN:
        missed.append(f'{case.name}: the fast viewers\' p95 grows to {ratio:.2f} of what it is beside a clean link')
    cells = [case.name, f'{fps:.1f}', f'{slow["latency_ms"]["p50"]:.0f}', f'{slow["latency_ms"]["p95"]:.0f}',
             f'{slow["age_ms"]["p50"]:.0f}', f'{slow["age_ms"]["p95"]:.0f}', f'{slow["age_ms"]["most"]:.0f}', f'{two_windows:.0f}',
             f'{slow["bytes_per_second"] * 8e-6:.2f}', f'{before["fps"]["median"]:.1f}', f'{others["fps"]["median"]:.1f}',
             f'{before["latency_ms"]["p95"]:.1f}', f'{others["latency_ms"]["p95"]:.1f}', f'{ratio:.2f}']
    return '| ' + ' | '.join(cells) + ' |', missed


def report(rows, missed, options, device, by_kernel, where):
    made_by = ('`tc netem` of the kernel' if by_kernel else
               'a user-space link of whole packets (`tests/network/link.py`; this kernel has no netem)')
    lines = ['# Viewers behind bad links', '',
             f'By `./dev netem`: scene `cloud`, {device}, {where}. One slow viewer (640x360) behind a link made by {made_by}, and '
             f'{options.fast} fast viewers (320x180) behind a clean one, {options.seconds:g} s each, of each number the least p95 of '
             f'{options.rounds} rounds, `{options.start}`. Delay is there and back; loss and rate hold each way; {QUEUE_MS} ms of '
             'packets may wait for a line with a rate.', '',
             'Latency: a pose sent to the first frame of it or of a later one. Age: the pose that a frame shows sent, to the frame got; '
             f'it should stay below two windows, the time in which {2 * options.window} frames come (the server allows {options.window} '
             'unacknowledged ones, and fewer where it finds that fewer fill the link). Who `stops reading` is halted while the fast ones '
             'are measured: its oldest frame is as old as the halt is long.', '',
             'The fast viewers should not notice the link of the slow one: their p95 stays within 10 % of what it is, just before, beside '
             'the same viewer behind a clean link. The row `clean` compares with the fast ones alone: what one more viewer costs on this '
             'machine, whatever its link.', '',
             '| slow viewer\'s link | frames/s | latency p50, ms | p95 | age p50, ms | p95 | most | two windows, ms | Mbit/s | '
             'fast beside a clean link, frames/s | beside this one | p95 beside a clean link, ms | beside this one | ratio |',
             '|' + '---|' * 14, *rows, '']
    lines += ['Everything holds.'] if not missed else ['Missed:', '', *(f'- {line}' for line in missed)]
    return '\n'.join(lines) + '\n'


def main():
    about = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    about.add_argument('--programs', type=pathlib.Path, default='build/release/bin', help='folder of brume-server and brume-load')
    about.add_argument('--out', type=pathlib.Path, help='write the report here, besides printing it')
    about.add_argument('--fast', type=int, default=2, help='number of fast viewers')
    about.add_argument('--seconds', type=float, default=6, help='of each measurement')
    about.add_argument('--rounds', type=int, default=3, help='of each case; of each number the round with the least p95 counts')
    about.add_argument('--window', type=int, default=6, help='unacknowledged frames that the server allows, its --max-in-flight')
    about.add_argument('--start', default='--scene cloud', help='arguments of the server')
    about.add_argument('--only', default='', help='cases whose name holds this')
    options = about.parse_args()
    if os.geteuid() != 0 or not shutil.which('ip'):
        raise Failed('network namespaces need root, and `ip` of the package iproute2')
    options.programs = options.programs.resolve()
    rows, missed, device, where = [], [], '', machine()
    with spaces():
        by_kernel = kernel_can()
        tell('links by ' + ('tc netem' if by_kernel else 'tests/network/link.py: this kernel has no netem'))
        server = Server(options.programs, options.start.split(), host='0.0.0.0', port=PORT, inside=inside(SERVER))
        try:
            for case in CASES:
                if options.only not in case.name:
                    continue
                before, others, slow = zip(*(measure(case, options, by_kernel) for _ in range(options.rounds)))
                before, others, slow = least(before, 'latency_ms'), least(others, 'latency_ms'), least(slow, 'age_ms')
                line, more = row(case, before, others, slow, options.window)
                tell(line)
                rows.append(line)
                missed += more
                device = slow['device']
        finally:
            server.stop()
    text = report(rows, missed, options, device, by_kernel, where)
    print(text)
    if options.out:
        write(options.out, text)


if __name__ == '__main__':
    try:
        main()
    except (Failed, KeyboardInterrupt) as error:
        sys.exit(f'links: {error or "interrupted"}')
