"""What may happen to a cluster. Each fault returns what was seen, in a few words, and what compare() says of the recordings.

The first line of each one's text is its name in the report. Failed: what must not happen did.
"""
import contextlib
import pathlib
import signal
import subprocess
import tempfile
import time

from cluster_parts import Engine, Node, Way, compare, stop, ticker, until
from programs import Failed, Load

SCENE = ['--scene', 'cloud', '--cluster-snapshot', '2']
MOST_WAIT_S = 0.3  # that ticks may stand when the one that makes them dies
MOST_AWAY_S = 1.0  # that a killed server's viewers may be away
PUSH = ['--push', '5', '--width', '160', '--height', '96', '--timeout', '60', '--warm-up', '1', '--reconnect']


@contextlib.contextmanager
def cluster(options, count=3, engine=None, ways=(), arguments=(), environment=None):
    """An engine and so many nodes. `ways`: nodes by number, whose way to the engine can be cut."""
    engine = engine or Engine()
    nodes = []
    try:
        for i in range(count):
            way = Way(engine.ports[0]) if i in ways else None
            nodes.append(Node(options.programs, engine, [*SCENE, *arguments], url=f'nats://127.0.0.1:{way.port}' if way else None,
                              environment=environment))
            nodes[-1].way = way
            nodes[-1].ready()
        until('all nodes know of each other', lambda: all(node.cluster('nodes') == count for node in nodes))
        yield engine, nodes
    finally:
        stop(*nodes, engine)


def viewers(options, nodes, seconds, count=6):
    return Load(options.programs, ','.join(f'ws://127.0.0.1:{node.port}/ws' for node in nodes), count, seconds, *PUSH)


def ticks_go_on(nodes, more=130):
    before = max(node.cluster('tick') for node in nodes)
    until('ticks go on', lambda: min(node.cluster('tick') for node in nodes) > before + more)


def same(nodes):
    if any(node.process.poll() is None and node.cluster('divergences_total') for node in nodes):
        raise Failed('a node said that it differs')
    return compare(nodes)


def killed(options, which):
    with cluster(options) as (_, nodes):
        load = viewers(options, nodes, 12)
        until('viewers are in', lambda: sum(node.metrics()['brume_viewers'] for node in nodes) == 6, 60)
        time.sleep(3)
        one = ticker(nodes)
        victim = one if which == 'ticker' else next(node for node in nodes if node is not one)
        left = [node for node in nodes if node is not victim]
        victim.process.kill()
        ticks_go_on(left)
        waits = [node.cluster('longest_wait_seconds') for node in left]
        run = load.result()
        away = run['away_ms']
        ticks_go_on(left, 70)
        if max(waits) > MOST_WAIT_S and which == 'ticker':
            late = f' (aim {MOST_WAIT_S * 1000:.0f})'
        else:
            late = ''
        if away['most'] > MOST_AWAY_S * 1000:
            late += f'; viewers were away for too long'
        return (f'ticks stood for {max(waits) * 1000:.0f} ms{late}; {len(run["returns_us"])} viewers away for {away["p50"]:.0f} ms (median), '
                f'{away["most"]:.0f} ms (most); {run["agreement"]["ticks_equal"]} of {run["agreement"]["ticks_compared"]} ticks equal for viewers'), same(nodes)


def kill_ticker(options):
    """SIGKILL of the server that makes the ticks."""
    return killed(options, 'ticker')


def kill_follower(options):
    """SIGKILL of another server."""
    return killed(options, 'other')


def stop_ticker(options):
    """SIGSTOP of the server that makes the ticks, for 5 s."""
    with cluster(options) as (_, nodes):
        load = viewers(options, nodes, 14)
        time.sleep(3)
        one = ticker(nodes)
        one.process.send_signal(signal.SIGSTOP)
        time.sleep(5)
        others = [node for node in nodes if node is not one]
        second = ticker(others)
        one.process.send_signal(signal.SIGCONT)
        awake = time.monotonic()
        until('it has caught up', lambda: abs(one.cluster('tick') - second.cluster('tick')) < 30)
        took = time.monotonic() - awake
        load.result()
        ticks_go_on(nodes)
        return f'another made the ticks; the stopped one had caught up {took:.1f} s after it woke', same(nodes)


def kill_engine(options):
    """SIGKILL of nats-server, started again after 3 s with its store."""
    with cluster(options) as (engine, nodes):
        load = viewers(options, nodes, 16)
        time.sleep(4)
        engine.kill()
        time.sleep(3)
        tick = nodes[0].cluster('tick')
        frames = nodes[0].metrics()['brume_frames_total{fate="sent"}']
        time.sleep(1)
        drawn = nodes[0].metrics()['brume_frames_total{fate="sent"}'] - frames
        if nodes[0].cluster('tick') != tick:
            raise Failed('ticks go on without the log')
        if drawn == 0:
            raise Failed('cameras do not go on')
        engine.start()
        back = time.monotonic()
        until('ticks go on', lambda: nodes[0].cluster('tick') > tick)
        took = time.monotonic() - back
        refused = sum(server['inputs_refused'] for server in load.result()['servers'])
        ticks_go_on(nodes)
        return f'ticks stood, {drawn:.0f} frames in 1 s meanwhile, {refused} pushes answered busy; ticks came {took:.1f} s after it was back', same(nodes)


def empty_engine(options):
    """SIGKILL of nats-server, started again with an empty store."""
    with cluster(options) as (engine, nodes):
        time.sleep(3)
        compared = same(nodes)
        engine.kill()
        engine.forget()
        engine.start()
        until('all servers end', lambda: all(node.process.poll() is not None for node in nodes), 60)
        line = nodes[0].said().strip().splitlines()[-1]
        if 'cannot be followed' not in line:
            raise Failed('it ended with: ' + line)
        return 'every server ended with one line that says so', compared


def cut_off(options):
    """One server's way to nats-server passes nothing for 6 s."""
    with cluster(options, ways=(2,)) as (_, nodes):
        load = viewers(options, nodes, 18)
        time.sleep(4)
        nodes[2].way.cut.set()
        time.sleep(6)
        behind = nodes[0].cluster('tick') - nodes[2].cluster('tick')
        nodes[2].way.cut.clear()
        back = time.monotonic()
        until('it has caught up', lambda: abs(nodes[0].cluster('tick') - nodes[2].cluster('tick')) < 30)
        took = time.monotonic() - back
        run = load.result()
        ticks_go_on(nodes)
        resent = nodes[2].cluster('resent_total')
        return (f'it stood {behind:.0f} ticks behind and had caught up {took:.1f} s after its way was back; {resent:.0f} commands sent again; '
                f'{run["agreement"]["ticks_equal"]} of {run["agreement"]["ticks_compared"]} ticks equal for viewers'), same(nodes)


def clock_back(options):
    """The servers' clock is set back by an hour (libfaketime)."""
    library = next(iter(pathlib.Path('/usr/lib').glob('*/faketime/libfaketime.so.1')), None)
    if not library:
        raise Failed('there is no libfaketime: install faketime')
    with tempfile.NamedTemporaryFile('w', suffix='.time') as clock:
        clock.write('+0')
        clock.flush()
        environment = {'LD_PRELOAD': str(library), 'FAKETIME_TIMESTAMP_FILE': clock.name, 'FAKETIME_NO_CACHE': '1',
                       'DONT_FAKE_MONOTONIC': '1', 'FAKETIME_DONT_RESET': '1'}
        with cluster(options, 2, environment=environment) as (_, nodes):
            load = viewers(options, nodes, 8, 2)
            time.sleep(4)
            clock.seek(0)
            clock.write('-3600')
            clock.flush()
            load.result()
            stamps = [line[1:20] for line in nodes[0].said().splitlines() if line.startswith('[20')]
            if stamps[-1] >= stamps[0]:  # the viewers' leaving is the last line
                raise Failed('the clock was not set back: libfaketime did nothing')
            ticks_go_on(nodes)
            wait = max(node.cluster('longest_wait_seconds') for node in nodes)
            return f'nothing: the longest time between two ticks was {wait * 1000:.0f} ms', same(nodes)


def lose_leader(options):
    """Three nats-servers that keep three copies; the leader of the log is killed and comes back."""
    engine = Engine(3)
    time.sleep(3)  # they choose a leader
    with cluster(options, 2, engine=engine, arguments=['--cluster-replicas', '3']) as (_, nodes):
        load = viewers(options, nodes, 30, 4)
        time.sleep(3)
        waits = []
        for victim in range(3):  # one of them leads
            before = [node.cluster('standstill_seconds_total') for node in nodes]
            engine.kill(victim)
            time.sleep(1)
            until('ticks go on', lambda: all(not node_stands(node) for node in nodes), 60)
            ticks_go_on(nodes, 60)
            waits.append(max(node.cluster('standstill_seconds_total') - b for node, b in zip(nodes, before)))
            engine.start(victim)
            time.sleep(4)
        run = load.result()
        ticks_go_on(nodes)
        return (f'ticks stood for {", ".join(f"{w:.1f}" for w in waits)} s when each of the three was killed in turn; '
                f'{run["agreement"]["ticks_equal"]} of {run["agreement"]["ticks_compared"]} ticks equal for viewers'), same(nodes)


def node_stands(node):
    tick = node.cluster('tick')
    time.sleep(0.3)
    return node.cluster('tick') == tick


def another_scene(options):
    """A server of the same log with another --set."""
    with cluster(options, 1) as (engine, nodes):
        other = Node(options.programs, engine, [*SCENE, '--set', 'medium.seed=9'], wait=False)
        try:
            other.process.wait(timeout=60)
        except subprocess.TimeoutExpired:
            raise Failed('it runs') from None
        finally:
            stop(other)
        line = other.said().strip().splitlines()[-1]
        if other.process.returncode == 0 or 'other --set' not in line:
            raise Failed('it ended with: ' + line)
        ticks_go_on(nodes)
        return 'refused in one line', same(nodes)


FAULTS = [kill_ticker, kill_follower, stop_ticker, kill_engine, empty_engine, cut_off, clock_back, lose_leader, another_scene]
