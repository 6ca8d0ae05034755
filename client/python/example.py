#!/usr/bin/env python3
"""Five pictures around a cloud, each of the same state: example.py [ADDRESS]"""
import math, sys
import brume

with brume.connect(sys.argv[1] if len(sys.argv) > 1 else 'http://127.0.0.1:8080', size=(800, 450)) as view:
    view.pause()
    for i in range(5):
        view.look(position=(26 * math.sin(i * 1.26), 6, 26 * math.cos(i * 1.26)), target=(0, 0, 0))
        frame = view.frame()
        frame.save(f'turn-{i}.jpg')
        print('tick', frame.tick, 'state', frame.hash, 'error', view.state.error)
    view.resume()
