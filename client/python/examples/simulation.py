#!/usr/bin/env python3
"""A simulation of one's own, seen by everybody: particles that a ring of vortices carries. The server's scene has
[medium] layout = "live". simulation.py [ADDRESS [SECONDS]]"""
from __future__ import annotations

import sys
import time
from typing import Any

import numpy
import brume

COUNT, STEP = 800, 0.1  # particles; s between two calls, in which the server moves them smoothly
RING, CORE, SPEED = 4.0, 1.2, 6.0  # m, m, m/s


def velocity(places: Any) -> Any:
    """Around the ring's core: up through its middle, and down outside; m/s."""
    out = numpy.hypot(places[:, 0], places[:, 2]).clip(1e-6)
    across, up = out - RING, places[:, 1]
    spin = SPEED * CORE / (CORE ** 2 + across ** 2 + up ** 2)
    radial = spin * up / out
    return numpy.stack([radial * places[:, 0], -spin * across, radial * places[:, 2]], axis=1)


def main(address: str = 'http://127.0.0.1:8080', seconds: str = 'inf') -> None:
    places = numpy.random.default_rng(1).normal(0, (3.0, 1.0, 3.0), (COUNT, 3))
    with brume.connect(address) as view:
        begin = due = time.monotonic()
        while due - begin < float(seconds):
            places += STEP * velocity(places + STEP / 2 * velocity(places))  # a midpoint step
            view.set_particles(places, scales=4, extinctions=0.3, seconds=STEP)
            due += STEP
            time.sleep(max(0.0, due - time.monotonic()))
        print(f'{view.state.particles} particles at tick {view.state.tick}')


if __name__ == '__main__':
    main(*sys.argv[1:])
