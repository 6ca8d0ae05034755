#!/usr/bin/env python3
"""What one viewer gets before, during and after others do what harms: docs/results/data/fairness.md. Front door: ./dev fairness.

The viewer watches a scene that moves. The others come once so that all shaders are compiled, and go. Then it counts: they come,
each a process of its own, go on for some seconds, and go.
"""
import argparse
import contextlib
import multiprocessing
import pathlib
import random
import sys
import time
import urllib.error
import urllib.request

from programs import Failed, Server, machine, tell, write

SIZE = (640, 360)
SETTLE = 4.0  # s after the others came, before it counts
REST = 2.0  # s after they went
MEMORY_REST = 60.0  # s: the server gives back what a minute did not need


def watch(url, begin, seconds):
    """Times (s) of the viewer's frames from `begin` on."""
    import brume
    times = []
    with brume.connect(url, size=SIZE) as view:
        while time.monotonic() < begin + seconds:
            view.frame()
            times.append(time.monotonic() - begin)
    return [one for one in times if one >= 0]


def rate_and_gap(times, begin, seconds):
    """(frames a second, ms: 95th percentile of the time between two frames) of that window."""
    inside = [one for one in times if begin <= one < begin + seconds]
    gaps = sorted(1000 * (b - a) for a, b in zip(inside, inside[1:]))
    return len(inside) / seconds, gaps[int(0.95 * len(gaps))] if gaps else float('inf')


# ---- what the others do; each runs until it is killed ----

def elsewhere():
    """A camera that nobody else has: pictures of one camera are drawn once for all who have it."""
    return {'position': (random.uniform(-9, 9), random.uniform(5, 9), 24), 'target': (0, 5, 0)}


def steady(url, size=SIZE):
    import brume
    with brume.connect(url, size=size) as view:
        view.look(**elsewhere())
        for frame in view.frames():
            pass


def giant(url):
    steady(url, (1920, 1080))


def churn(url):
    import brume
    while True:
        with brume.connect(url, size=SIZE, reconnect=0) as view:
            view.look(**elsewhere())
            view.frame()


def snapshots(url):
    rng = random.Random()
    while True:
        try:
            with urllib.request.urlopen(f'{url}/snapshot.jpg?position={rng.uniform(-20, 20):.3f},6,24', timeout=60) as answer:
                answer.read()
        except urllib.error.HTTPError:
            time.sleep(0.01)


def stream(url):
    with urllib.request.urlopen(f'{url}/stream.mjpg?w=1920&h=1080', timeout=60) as answer:
        while answer.read(1 << 16):
            pass


def sizes(url):
    import brume
    rng = random.Random()
    with brume.connect(url, size=SIZE) as view:
        while True:
            view.look(size=rng.choice([(320, 180), (480, 270), (640, 360), (960, 540), (540, 960)]), **elsewhere())
            view.frame()


def jumper(url):
    import brume
    with brume.connect(url, size=SIZE) as view:
        while True:
            for z in (26, 2):
                view.look(position=(0, 3, z), target=(0.5, 3, 0))
                end = time.monotonic() + 0.5
                while time.monotonic() < end:
                    view.frame()


def hello_only(url):
    import brume
    views = []
    while True:
        try:
            views.append(brume.connect(url, size=(1920, 1080), reconnect=0))
        except (brume.BrumeError, TimeoutError):
            time.sleep(0.2)


def ask(view, changes):
    """Faster than set(), which waits for the state."""
    import brume
    brume.steps.run(view._link, view._link.order([brume.messages.change(changes)], 5))


def settings(url):
    """An operator's program that changes everything in turn: other methods, light that scatters otherwise, other extinction."""
    import brume
    changes = [{'render.method': 'sphere'}, {'render.scattering': 'propagation'}, {'render.method': 'auto'}, {'medium.extinction': 9},
               {'render.scattering': 'single'}, {'medium.extinction': 6}, {'light.to_light': (0.3, 0.8, 0.4)}, {'render.error': 0.02}]
    with brume.connect(url, size=(64, 36)) as view:
        while True:
            for change in changes:
                with contextlib.suppress(brume.BrumeError):
                    ask(view, change)
                time.sleep(0.05)


def sliders(url):
    """An operator who moves sliders of the medium: no other way to render is asked for."""
    import brume
    with brume.connect(url, size=(64, 36)) as view:
        while True:
            for n in range(8):
                with contextlib.suppress(brume.BrumeError):
                    ask(view, {'medium.anisotropy': 0.1 + 0.1 * n, 'medium.falloff': 1.2 + 0.05 * n})
                time.sleep(0.05)


def spin():
    while True:
        pass


# Name, who, how many of them, and the parts of the device that they may have beside the viewer's one: snapshots of one
# address have one together, and who only says hello has none.
CASES = [
    ('four who stay', [(steady, 4)], 4),
    ('four who leave after each frame and come again', [(churn, 4)], 4),
    ('four loops of snapshots', [(snapshots, 4)], 1),
    ('four streams of 1920x1080', [(stream, 4)], 4),
    ('four that change their size', [(sizes, 4)], 4),
    ('two that jump into the medium and out', [(jumper, 2)], 2),
    ('hellos alone', [(hello_only, 1)], 0),
    ('four pictures of 1920x1080', [(giant, 4)], 4),
    ('one who changes settings twenty times a second', [(settings, 1)], 0),
    ('one who moves sliders', [(sliders, 1)], 0),
    ('two who churn, two loops of snapshots, two of 1920x1080', [(churn, 2), (snapshots, 2), (giant, 2)], 5),
]


def memory(server):
    """MiB: (in RAM, on the device)."""
    status = dict(line.split(':', 1) for line in pathlib.Path(f'/proc/{server.pid}/status').read_text().splitlines())
    return int(status['VmRSS'].split()[0]) / 1024, server.metrics()['brume_device_memory_bytes'] / 2**20


@contextlib.contextmanager
def running(others, *arguments):
    started = [multiprocessing.Process(target=what, args=arguments, daemon=True) for what, count in others for _ in range(count)]
    try:
        for one in started:
            one.start()
        yield
    finally:
        for one in started:
            one.kill()
            one.join()


def until(moment):
    time.sleep(max(moment - time.monotonic(), 0))


def measure(name, others, parts, options):
    arguments = ['--scene', options.scene, *options.start.split(), '--frame-budget', f'{options.frame_budget:g}']
    server = Server(options.programs, arguments)
    try:
        url, window, rest = f'http://127.0.0.1:{server.port}', options.seconds, options.memory_rest
        begin = time.monotonic() + 2 + 2 * SETTLE + REST + rest  # s
        with multiprocessing.Pool(1) as pool, running([(spin, options.busy)]):
            watching = pool.apply_async(watch, (url, begin, 3 * window + SETTLE + REST + rest))
            time.sleep(2)
            with running(others, url):
                time.sleep(SETTLE)
            until(begin + window)
            before = memory(server)
            with running(others, url):
                until(begin + window + SETTLE)
                until(begin + 2 * window + SETTLE)
                most = memory(server)
            until(begin + 3 * window + SETTLE + REST + rest - 1)  # the viewer still watches
            after = memory(server)
            times = watching.get()
        rates, gaps = zip(*(rate_and_gap(times, start, window) for start in (0, window + SETTLE, 2 * window + SETTLE + REST)))
        share, bound = rates[1] / (rates[0] / (1 + parts)), gaps[1] * rates[1] / 1000
        back = [f'{a / b:.2f}' if rest else '' for a, b in zip(after, before)]
        tell(f'{name}: {rates[0]:.1f} -> {rates[1]:.1f} -> {rates[2]:.1f} frames/s, {share:.2f} of its share, p95 of the gap '
             f'{bound:.1f} of its mean' + (f', memory {back[0]} and {back[1]} of before' if rest else ''))
        cells = [name, *(f'{one:.1f}' for one in rates), f'{share:.2f}', *(f'{one:.0f}' for one in gaps), f'{bound:.1f}',
                 f'{before[0]:.0f}', f'{most[0]:.0f}', ' / '.join(back) if rest else '-']
        return f"| {' | '.join(cells)} |"
    finally:
        server.stop()


def main():
    about = argparse.ArgumentParser(description=__doc__)
    about.add_argument('--programs', type=pathlib.Path, default=pathlib.Path('build/release/bin'))
    about.add_argument('--out', type=pathlib.Path, help='the page; without it the rows go to the terminal')
    about.add_argument('--scene', default='plume')
    about.add_argument('--start', default='--ahead off', help='more arguments of the server')
    about.add_argument('--seconds', type=float, default=10, help='of each measurement')
    about.add_argument('--frame-budget', type=float, default=50, help='ms, of the server')
    about.add_argument('--memory-rest', type=float, help='s until memory is compared, 0: it is not; 60 where all cases are run')
    about.add_argument('--busy', type=int, default=0, help='processes that take a core each beside all this, from the start to the end')
    about.add_argument('--only', help='cases whose name has this in it')
    options = about.parse_args()
    if options.memory_rest is None:
        options.memory_rest = 0 if options.only else MEMORY_REST
    sys.path.insert(0, str(options.programs.resolve().parent / 'python'))
    began = machine()
    rows = [measure(*case, options) for case in CASES if not options.only or options.only in case[0]]
    text = '\n'.join([
        '# Who takes what is another\'s', '',
        'One viewer of 640x360 watches a scene that moves; then others come, go on, and go. Made by `./dev fairness`.', '',
        f'Scene `{options.scene}`; {began}; {options.busy} processes take a core each besides. Everything runs on this machine:',
        'the others\' programs take their part of its cores, too. *Share*: frames during, over what the viewer had before,',
        'divided by the parts that the device is shared in: one for each that watches, one for all snapshots of an',
        'address. The four streams have one camera, so they are drawn once. At least 0.8 is promised. *p95/mean*: of the',
        'gaps between two frames during; at most 2 is promised.',
        *([f'*Back*: memory {options.memory_rest:.0f} s after that, over the memory before, in RAM and on the device; at most 1.1 is '
           'promised.'] if options.memory_rest else []), '',
        '| the others | before, 1/s | during | after | share | gap p95 before, ms | during | after | p95/mean | MiB before | during '
        '| back |',
        '|---|---|---|---|---|---|---|---|---|---|---|---|', *rows, ''])
    if options.out:
        write(options.out, text)
    else:
        print(text)


if __name__ == '__main__':
    multiprocessing.set_start_method('spawn')
    try:
        main()
    except Failed as failed:
        sys.exit(f'fairness: {failed}')
