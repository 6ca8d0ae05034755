#!/usr/bin/env python3
"""Several servers of one cloud: measured, and broken on purpose. Front door: ./dev nodes.

First 1, 2 and 3 servers of each scene under viewers who push at random, and how long a server takes to join. Then faults, each followed
by a comparison of the servers' recordings: every tick that two of them have must be the same state, by the same commands.
"""
import argparse
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from cluster_faults import FAULTS
from cluster_parts import Engine, Node, compare, stop
from programs import Failed, Load, Server, machine, tell, write

SCENES = ['cloud', 'plume', 'cloud-65535']
LATE_MS = 5  # that a cluster may add to a command's way, besides one tick
SMALL = ['--width', '160', '--height', '96', '--timeout', '60', '--warm-up', '2']


def ws(nodes):
    return ','.join(f'ws://127.0.0.1:{node.port}/ws' for node in nodes)


def measured(options, scene, count):
    """One row: `count` servers, 0 for a server that is alone."""
    arguments = ['--scene', scene, '--max-viewers', '16']
    engine = Engine() if count else None
    nodes = []
    try:
        for _ in range(max(count, 1)):
            nodes.append(Node(options.programs, engine, arguments) if engine else Server(options.programs, [*arguments, '--ahead', 'off']))
            if engine:
                nodes[-1].ready()
        run = Load(options.programs, ws(nodes), options.viewers, options.seconds, '--push', str(options.push), *SMALL).result(options.seconds + 180)
        servers = run['servers']
        row = {'scene': scene, 'servers': count, 'viewers': options.viewers,
               'p50': max(s['command_to_tick_ms']['p50'] for s in servers), 'p95': max(s['command_to_tick_ms']['p95'] for s in servers),
               'picture': max(s['tick_to_picture_ms']['p95'] for s in servers),
               'rate': min(s['ticks_per_second'] for s in servers), 'fps': sum(s['frames_per_second'] for s in servers),
               'refused': sum(s['inputs_refused'] for s in servers), 'sent': sum(s['inputs_sent'] for s in servers)}
        if engine:
            row |= {'log': servers[0]['log_bytes_per_second'] / 1e3, 'lag': max(s['lag_ticks'] for s in servers),
                    'compared': run.get('agreement', {}).get('ticks_compared'), 'equal': run.get('agreement', {}).get('ticks_equal')}
            time.sleep(1.5)  # a record of each server follows
            row['recorded'] = compare(nodes)
        return row
    finally:
        stop(*nodes, *([engine] if engine else []))


def joined(options, arguments, name):
    """How long a server takes to join, beside the start of one that is alone."""
    alone = Server(options.programs, [*arguments, '--ahead', 'off'], wait=False)
    began = time.monotonic()
    alone.wait()
    start = time.monotonic() - began
    alone.stop()
    engine = Engine()
    first = Node(options.programs, engine, [*arguments, '--cluster-snapshot', '2'])
    second = None
    try:
        first.ready()
        Load(options.programs, ws([first]), 1, 4, '--push', '20', *SMALL).result()  # so that particles are not where they were at the start
        time.sleep(4)
        second = Node(options.programs, engine, arguments, wait=False)
        second.wait()
        took = second.ready()
        return {'scene': name, 'bytes': first.cluster('snapshot_bytes'), 'alone': start, 'took': took}
    finally:
        stop(*[node for node in (first, second) if node], engine)


def without_avx2(options):
    """A recording of two servers, stepped anew by a processor without AVX2. Needs qemu-x86_64."""
    engine = Engine()
    nodes = []
    try:
        for _ in range(2):
            nodes.append(Node(options.programs, engine, ['--scene', 'plume']))
            nodes[-1].ready()
        Load(options.programs, ws(nodes), 2, 5, '--push', '5', *SMALL).result()
        time.sleep(1.5)
        compare(nodes)
        first = nodes[0].record
        for node in nodes:
            node.stop()
        said = subprocess.run(['qemu-x86_64', '-cpu', 'Nehalem', str(options.programs / 'brume-server'), '--replay', str(first)],
                              capture_output=True, text=True, timeout=600)
        if said.returncode != 0:
            raise Failed('without AVX2 the recording is another: ' + (said.stderr or said.stdout).strip().splitlines()[-1])
        return next(line for line in said.stdout.splitlines() if line.startswith('replayed')) + '.'
    finally:
        stop(*nodes, engine)


def table(rows):
    lines = ['| scene | servers | viewers | ticks compared by viewers | equal | ticks compared in recordings | commands | command to tick, ms: p50 | p95 '
             '| tick to picture p95, ms | ticks/s, least | frames/s, all | pushes sent | refused | log, kB/s | lag, ticks |', '|' + '---|' * 16]
    for r in rows:
        number = lambda key, form: '' if r.get(key) is None else format(r[key], form)
        recorded = r.get('recorded', ('', ''))
        lines.append(f'| {r["scene"]} | {r["servers"] or "alone"} | {r["viewers"]} | {number("compared", "d")} | {number("equal", "d")} | {recorded[0]} | {recorded[1]} '
                     f'| {r["p50"]:.1f} | {r["p95"]:.1f} | {r["picture"]:.0f} | {r["rate"]:.1f} | {r["fps"]:.1f} | {r["sent"]} | {r["refused"]} '
                     f'| {number("log", ".1f")} | {number("lag", ".0f")} |')
    return lines


def report(rows, joins, faults, qemu, missed, options, where):
    lines = ['# Several servers of one cloud, measured and broken', '',
             f'By `./dev nodes --seconds {options.seconds:g} --viewers {options.viewers} --push {options.push:g}`: {where}. All servers, NATS, '
             'and the viewers share these cores, so times are of a busy machine; sameness is not a matter of time. Pictures of 160 x 96.', '',
             '## Under viewers who push at random', '', *table(rows), '',
             'Command to tick: from its arrival at a server to the tick that takes it there, of the slowest server.', '',
             '## Joining', '',
             '| scene | snapshot, kB | start of a server that is alone, s | start until it has the others\' state, s |', '|---|---|---|---|']
    lines += [f'| {j["scene"]} | {j["bytes"] / 1e3:.1f} | {j["alone"]:.2f} | {j["took"]:.2f} |' for j in joins]
    lines += ['', '## Faults', '', '| what | what was seen | ticks compared | commands |', '|---|---|---|---|']
    lines += [f'| {name} | {seen} | {compared} | {commands} |' for name, seen, (compared, commands) in faults]
    lines += ['', f'A processor without AVX2 (qemu-x86_64 -cpu Nehalem) steps a recording of the cluster anew: {qemu}', '']
    lines += ['Everything holds.'] if not missed else ['Missed:', '', *(f'- {line}' for line in missed)]
    return '\n'.join(lines) + '\n'


def late(rows):
    """Commands that take longer than one tick and LATE_MS more than on a server that is alone."""
    missed = []
    for r in rows:
        if not r['servers']:
            alone = r['p95']
        elif r['p95'] > alone + 1000 / 60 + LATE_MS:
            missed.append(f'{r["scene"]}, {r["servers"]} servers: commands take {r["p95"]:.1f} ms (p95), alone {alone:.1f} ms')
    return missed


def main():
    about = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    about.add_argument('--seconds', type=float, default=20, help='of each run under viewers')
    about.add_argument('--viewers', type=int, default=3)
    about.add_argument('--push', type=float, default=10, help='pushes a second of each viewer')
    about.add_argument('--scenes', default=','.join(SCENES), help='empty: none')
    about.add_argument('--faults', default=','.join(f.__name__ for f in FAULTS), help='which, by name; empty: none')
    about.add_argument('--programs', type=pathlib.Path, default='build/release/bin', help='folder of the programs')
    about.add_argument('--out', type=pathlib.Path, help='write the report here, besides printing it')
    options = about.parse_args()
    options.programs = options.programs.resolve()
    where = machine()
    rows, joins, faults, missed = [], [], [], []
    qemu = 'not run: there is no qemu-x86_64.'
    for scene in filter(None, options.scenes.split(',')):
        for count in (0, 1, 2, 3):
            rows.append(measured(options, scene, count))
            tell(table(rows)[-1])
    if options.scenes:
        large = ['--scene', 'cloud', '--set', 'medium.count=400000', '--set', 'medium.scale=[0.05,0.06]']
        for arguments, name in ((['--scene', 'cloud'], 'cloud'), (['--scene', 'plume'], 'plume'), (['--scene', 'cloud-5000'], 'cloud-5000'),
                                (['--scene', 'cloud-65535'], 'cloud-65535'), (large, 'cloud of 400,000')):
            joins.append(joined(options, arguments, name))
            tell(str(joins[-1]))
    for fault in FAULTS:
        if fault.__name__ not in options.faults.split(','):
            continue
        try:
            seen, compared = fault(options)
            faults.append((fault.__doc__.splitlines()[0].rstrip('.'), seen, compared))
            tell(str(faults[-1]))
        except Failed as failure:
            missed.append(f'{fault.__name__}: {failure}')
            tell(missed[-1])
    if subprocess.run(['which', 'qemu-x86_64'], stdout=subprocess.DEVNULL, check=False).returncode == 0:
        qemu = without_avx2(options)
    missed += late(rows)
    text = report(rows, joins, faults, qemu, missed, options, where)
    print(text)
    if options.out:
        write(options.out, text)
    return 1 if missed else 0


if __name__ == '__main__':
    try:
        sys.exit(main())
    except Failed as failure:
        sys.exit(f'nodes: {failure}')
    except KeyboardInterrupt:
        sys.exit('nodes: interrupted')
