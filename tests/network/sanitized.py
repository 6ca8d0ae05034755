#!/usr/bin/env python3
"""The server and its viewers, built with a sanitizer, under load. Front door: ./dev test asan, ./dev test tsan.

Viewers come and go as in soak.py, the settings are read anew under them, and the server is told to stop while some watch. Fails with
whatever a sanitizer reports of the server or of any viewer, and when the server does not end with 0.
"""
import argparse
import os
import pathlib
import random
import signal
import sys
import tempfile
import urllib.error

import soak
from programs import Failed, Load, Server, tell

HERE = pathlib.Path(__file__).resolve().parent


def watched(options, reports):
    # Files, since viewers that are cut off take their standard error with them.
    for name in ('ASAN', 'UBSAN', 'TSAN'):
        os.environ[f'{name}_OPTIONS'] = f'log_path={reports}/report:print_stacktrace=1'
    os.environ['TSAN_OPTIONS'] += f':suppressions={HERE}/tsan.supp'
    server = Server(options.programs, [*options.start.split(), '--record', f'{reports}.record'])
    came = sent = 0
    try:
        for _ in range(options.rounds):
            came += soak.busy(server, options, random.Random(came))[0]
            server.process.send_signal(signal.SIGHUP)
            sent = soak.quiet(server)['sent']
        last = Load(options.programs, soak.url(server), 3, 60, '--paths', 'orbit,still,stereo', '--width', '240', '--height', '135')
        soak.until('three more see something', lambda: server.metrics()['brume_frames_total{fate="sent"}'] > sent + 30, 60)
    finally:
        code = server.stop()
    last.process.wait(timeout=60)  # with the server's goodbye
    if code != 0:
        raise Failed(f'the server exits with {code}: ' + server.said()[-2000:])
    return came + 3, sent + 30


def main():
    about = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    about.add_argument('--programs', type=pathlib.Path, required=True, help='folder of brume-server and brume-load')
    about.add_argument('--rounds', type=int, default=1, help=f'of {soak.ROUND_S} s')
    about.add_argument('--start', default='--scene cloud --device llvmpipe --most-frame-time 60000', help='arguments of the server')
    options = about.parse_args()
    options.programs = options.programs.resolve()
    with tempfile.TemporaryDirectory(prefix='brume-') as folder:
        reports = pathlib.Path(folder) / 'reports'
        reports.mkdir()
        try:
            came, sent = watched(options, reports)
        finally:
            found = sorted(reports.iterdir())
            for report in found:
                tell(report.read_text(errors='replace'))
    if found:
        raise Failed(f'{len(found)} programs have the reports above')
    tell(f'{came} viewers came, {sent:.0f} frames: nothing to report')


if __name__ == '__main__':
    try:
        main()
    except (Failed, urllib.error.URLError, KeyboardInterrupt) as error:
        sys.exit(f'sanitized: {error or "interrupted"}')
