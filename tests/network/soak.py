#!/usr/bin/env python3
"""Viewers that come and go, and a server that is killed. Front door: ./dev soak.

Rounds of random viewers, some of them cut off without a goodbye. After each round everyone leaves, and what the server holds then
(memory, descriptors, threads) is compared: it must stay. Then the server is killed and started again under its viewers.
"""
import argparse
import os
import pathlib
import random
import signal
import socket
import statistics
import sys
import time
import urllib.error

from programs import Failed, Load, Server, machine, tell, write

MOST_VIEWERS = 16
ROUND_S = 20
SIZES = [(160, 96), (320, 180), (480, 270)]
# Memory may grow until the allocator has met the busiest moment; after the first quarter it may not, but for its own granules:
# a leak of one small picture (8 KiB) a second would be 14 MiB in half an hour.
GRANULES_MIB = 8
BACK_S = 2


def held(pid):
    status = dict(line.split(':', 1) for line in pathlib.Path(f'/proc/{pid}/status').read_text().splitlines())
    mib = {name: int(status[name].split()[0]) / 1024 for name in ('VmRSS', 'RssAnon')}
    return {'rss': mib['VmRSS'], 'heap': mib['RssAnon'], 'threads': int(status['Threads']),
            'descriptors': len(os.listdir(f'/proc/{pid}/fd'))}


def until(what, holds, timeout):
    end = time.monotonic() + timeout
    while not holds():
        if time.monotonic() > end:
            raise Failed(f'{what}: not within {timeout:g} s')
        time.sleep(0.1)


def url(server):
    return f'ws://127.0.0.1:{server.port}/ws'


def fullest(server, options):
    """As many viewers with two eyes as there may be, of the largest pictures: buffers on the device keep the size of the largest
    batch that there ever was."""
    width, height = SIZES[-1]
    Load(options.programs, url(server), MOST_VIEWERS, 8, '--warm-up', '0', '--paths', 'stereo', '--timeout', '60', '--width', str(width),
         '--height', str(height)).result()


def busy(server, options, rng):
    """One round. Returns how many viewers came, how many were cut off, and the most at one time."""
    parties, came, cut, most = [], 0, 0, 0
    end = time.monotonic() + ROUND_S
    while time.monotonic() < end:
        for party in [p for p in parties if p[0].process.poll() is not None]:
            parties.remove(party)
            if party[0].process.returncode != 0 and not party[3]:
                raise Failed('a viewer failed: ' + party[0].said())
        room = MOST_VIEWERS - sum(size for _, size, _, _ in parties)
        if room > 0:
            size, seconds = rng.randint(1, min(4, room)), rng.uniform(0.5, 8)
            paths = rng.choice(['orbit', 'fly', 'still', 'stereo'])
            width, height = rng.choice(SIZES)
            load = Load(options.programs, url(server), size, f'{seconds:.2f}', '--warm-up', '0', '--paths', paths, '--timeout', '60',
                        '--width', str(width), '--height', str(height))
            doomed = rng.random() < 0.2
            parties.append([load, size, time.monotonic() + rng.uniform(0.3, seconds) if doomed else end + 100, doomed])
            came += size
            most = max(most, MOST_VIEWERS - room + size)
        for load, size, when, doomed in parties:
            if doomed and time.monotonic() > when and load.process.poll() is None:
                load.process.kill()
                cut += size
        time.sleep(rng.uniform(0, 0.4))
    for load, _, _, doomed in parties:
        if doomed:
            load.process.kill()
            load.process.wait()
        else:
            load.result()
    return came, cut, most


def gives_picture(server):
    """False while shaders of a picture at rest are being compiled, which a server with a sanitizer takes long for."""
    try:
        return len(server.get('/snapshot.jpg?w=160&h=96', timeout=30)) >= 500
    except urllib.error.HTTPError as error:
        if error.code != 503:
            raise
        return False


def quiet(server):
    """What the server holds with nobody there; and that it still works."""
    until('everyone has left', lambda: server.metrics()['brume_viewers'] == 0, 30)
    until('their connections are closed', lambda: server.metrics()['brume_connections'] <= 1, 30)  # our own
    before = server.metrics()['brume_tick']
    until('after a round there is a picture', lambda: gives_picture(server), 120)
    if server.get('/readyz').strip() != b'ready':
        raise Failed('after a round it is not ready')
    until('ticks go on', lambda: server.metrics()['brume_tick'] > before, 10)
    time.sleep(0.5)  # the snapshot's connection ends
    metrics = server.metrics()
    return held(server.pid) | {'device': metrics['brume_device_memory_bytes'] / 2**20,
                               'sent': metrics.get('brume_frames_total{fate="sent"}', float('nan'))}


def soak(server, options):
    rng = random.Random(options.seed)
    rounds, begin = [], time.monotonic()
    fullest(server, options)
    busy(server, options, rng)  # makes what is made once: pipelines, pools, the allocator's arenas
    quiet(server)
    while time.monotonic() - begin < options.minutes * 60:
        came, cut, most = busy(server, options, rng)
        rounds.append(quiet(server) | {'minute': (time.monotonic() - begin) / 60, 'came': came, 'cut': cut, 'most': most})
        r = rounds[-1]
        tell(f'{r["minute"]:.1f} min: {came} came, {cut} cut off, {r["rss"]:.1f} MiB ({r["heap"]:.1f} heap, {r["device"]:.1f} device), '
             f'{r["descriptors"]} descriptors, {r["threads"]} threads')
    return rounds


def opened(port, timeout):
    """When the port took a connection, on the clock that the viewers measure with."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        try:
            socket.create_connection(('127.0.0.1', port), timeout=1).close()
            return time.monotonic()
        except OSError:
            time.sleep(0.005)
    raise Failed('the killed server does not come back')


def killed(options, outage):
    """Seconds from the open port to each viewer's first frame, after a SIGKILL and so many seconds without a server."""
    server = Server(options.programs, options.start.split())
    load = Load(options.programs, url(server), 8, outage + 15, '--reconnect', '--warm-up', '1', '--width', '320', '--height', '180')
    until('viewers are in', lambda: server.metrics()['brume_viewers'] == 8, 60)
    time.sleep(3)
    server.stop(signal.SIGKILL)
    time.sleep(outage)
    begin = time.monotonic()
    again = Server(options.programs, options.start.split(), port=server.port, wait=False)
    try:
        at = opened(server.port, 120)
        back = [us * 1e-6 - at for _, us in load.result()['returns_us']]
    finally:
        again.stop()
    if len(back) != 8:
        raise Failed(f'{len(back)} of 8 viewers came back')
    return {'outage': outage, 'start': at - begin, 'first': min(back), 'median': statistics.median(back), 'last': max(back)}


def judged(rounds, kills):
    missed = []
    settled = rounds[:max(1, len(rounds) // 4)]
    most = max(r['rss'] for r in settled)
    if rounds[-1]['rss'] > most + GRANULES_MIB:
        missed.append(f'memory grows: {rounds[-1]["rss"]:.1f} MiB at the end, {most:.1f} MiB at most in the first quarter')
    for what in ('descriptors', 'threads'):
        if rounds[-1][what] > max(r[what] for r in settled):
            missed.append(f'{what} grow: {rounds[-1][what]} at the end, {settled[0][what]} at the beginning')
    for kill in kills:
        if kill['last'] > BACK_S:
            missed.append(f'the last viewer is back {kill["last"]:.2f} s after the port opened')
    return missed


def report(rounds, kills, missed, options, where):
    lines = ['# Viewers that come and go', '',
             f'By `./dev soak --minutes {options.minutes:g}`: `{options.start}`, {where}. Rounds of {ROUND_S} s: up to {MOST_VIEWERS} '
             'viewers at a time, 1 to 4 in a group, for 0.5 to 8 s each, in three sizes, moving, still and with two eyes; every fifth '
             f'group is cut off by SIGKILL. {sum(r["came"] for r in rounds)} viewers in {len(rounds)} rounds, after one and one '
             f'of {MOST_VIEWERS} with two large eyes, which are not counted. The heap and what a software driver has as the device\'s memory are '
             'parts of the process\' memory. After each round, with nobody there:', '',
             '| minute | viewers came | cut off | most at once | memory (RSS), MiB | heap | device | descriptors | threads | frames sent so far |',
             '|' + '---|' * 10]
    step = max(1, len(rounds) // 30)
    for r in rounds[::step] if (len(rounds) - 1) % step == 0 else [*rounds[::step], rounds[-1]]:
        lines.append(f'| {r["minute"]:.1f} | {r["came"]} | {r["cut"]} | {r["most"]} | {r["rss"]:.1f} | {r["heap"]:.1f} | {r["device"]:.1f} | {r["descriptors"]} | '
                     f'{r["threads"]} | {r["sent"]:.0f} |')
    lines += ['', f'Allowed: memory at the end at most {GRANULES_MIB} MiB over the most of the first quarter; no more descriptors and '
              'threads than there.', '',
              '## A killed server', '',
              'SIGKILL under eight viewers (`brume-load --reconnect`: they try four times a second), a time without any server, and '
              'the same port again. From the moment the port takes connections to a viewer\'s next frame:', '',
              '| without a server, s | start to open port, s | first viewer, s | median | last |', '|' + '---|' * 5]
    for k in kills:
        lines.append(f'| {k["outage"]:g} | {k["start"]:.2f} | {k["first"]:.2f} | {k["median"]:.2f} | {k["last"]:.2f} |')
    lines += ['', f'Allowed: {BACK_S} s.', '']
    lines += ['Everything holds.'] if not missed else ['Missed:', '', *(f'- {line}' for line in missed)]
    return '\n'.join(lines) + '\n'


def main():
    about = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    about.add_argument('--minutes', type=float, default=30)
    about.add_argument('--seed', type=int, default=1, help='of who comes when')
    about.add_argument('--start', default='--scene cloud', help='arguments of the server')
    about.add_argument('--programs', type=pathlib.Path, default='build/release/bin', help='folder of brume-server and brume-load')
    about.add_argument('--out', type=pathlib.Path, help='write the report here, besides printing it')
    options = about.parse_args()
    options.programs = options.programs.resolve()
    where = machine()
    server = Server(options.programs, options.start.split())
    try:
        rounds = soak(server, options)
    finally:
        code = server.stop()
    if code != 0:
        raise Failed(f'the server exits with {code}')
    kills = [killed(options, outage) for outage in (0, 1, 5)]
    missed = judged(rounds, kills)
    text = report(rounds, kills, missed, options, where)
    print(text)
    if options.out:
        write(options.out, text)
    if missed:
        raise Failed('; '.join(missed))


if __name__ == '__main__':
    try:
        main()
    except (Failed, urllib.error.URLError, KeyboardInterrupt) as error:
        sys.exit(f'soak: {error or "interrupted"}')
