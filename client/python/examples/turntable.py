#!/usr/bin/env python3
"""A turntable of one state of the cloud as a NumPy array, and how far its pictures are from the truth:
turntable.py [ADDRESS [FILE.npy]]"""
from __future__ import annotations

import math
import sys

import numpy
import brume

VIEWS, AWAY, UP = 12, 26.0, 6.0  # m
MOST = 600  # pictures, in which the server must have measured


def main(address: str = 'http://127.0.0.1:8080', file: str = 'turntable.npy') -> None:
    with brume.connect(address, size=(320, 180), keep_size=True) as view:
        view.pause()  # all show the same state
        try:
            pictures = []
            for angle in numpy.arange(VIEWS) * 2 * math.pi / VIEWS:
                view.look(position=(AWAY * math.sin(angle), UP, AWAY * math.cos(angle)), target=(0, 0, 0))
                frame = view.frame()
                pictures.append(frame.array())
                print(f'{math.degrees(angle):3.0f} degrees: state {frame.hash}, mean {pictures[-1].mean():.1f} of 255')
        finally:
            view.resume()
        numpy.save(file, numpy.stack(pictures))  # views x height x width x 3
        print(f'error predicted: {view.state.error or math.nan:.2%}')
        # The server traces a few pixels of what it sends anew, and knows after some seconds.
        measured = next((frame.measured for frame in view.frames(MOST) if frame.measured), None)
        print(f'error measured: {measured.error:.2%}, {measured.low:.2%} to {measured.high:.2%} with 95 % certainty'
              if measured else 'error measured: not known (--measure-error of the server)')


if __name__ == '__main__':
    main(*sys.argv[1:])
