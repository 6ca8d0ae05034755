"""Splats: the lit medium of one tick as a file of 3D Gaussian splatting, for programs that show such files. Needs
NumPy."""
from __future__ import annotations

import math
import os
from typing import Union

import numpy

from brume.kinds import Array
from brume.particles import Particles

HARMONIC = 0.28209479177387814  # of order 0: 1 / (2 √π)
LEAST, MOST = 1e-6, 1 - 1 / 512  # of opacities: their logits are finite, and 1 is not reached
FIELDS = ('x', 'y', 'z', 'nx', 'ny', 'nz', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity', 'scale_0', 'scale_1', 'scale_2',
          'rot_0', 'rot_1', 'rot_2', 'rot_3')


def _srgb(light: Array) -> Array:
    colour: Array = numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light.clip(0.0031308) ** (1 / 2.4) - 0.055)
    return colour


def colours(particles: Particles) -> Array:
    """What each particle shows of its light, as a screen has it: n x 3 numbers, 0 ... 1. The same from all sides: the
    phase function counts on average."""
    light = particles.light_at()
    if particles.fluence is not None:
        light = light ** numpy.asarray(particles.straight, numpy.float32) + particles.fluence.T
    soot = numpy.maximum(1 - particles.albedos / numpy.asarray(particles.cold_albedo), 0)
    seen = particles.albedos * (light * particles.irradiance / (4 * math.pi) + particles.ambient)
    seen = (seen + soot * particles.emission) * particles.exposure
    if particles.filmic:  # Narkowicz's fit of the ACES curve
        seen = seen * (2.51 * seen + 0.03) / (seen * (2.43 * seen + 0.59) + 0.14)
    return _srgb(seen.clip(0, 1))


def save(path: Union[str, os.PathLike[str]], particles: Particles) -> None:
    """Writes a binary PLY of splats: round ones, whose opacity is what a ray through the centre loses. Colours of the
    extinction are averaged."""
    deviations = particles.deviations.clip(1e-9)
    depths = particles.extinctions * particles.extinction_colour.mean() * deviations * math.sqrt(2 * math.pi)
    opacities = (-numpy.expm1(-depths)).clip(LEAST, MOST)
    rows = numpy.zeros(len(particles), [(name, '<f4') for name in FIELDS])
    for axis, name in enumerate('xyz'):
        rows[name] = particles.places[:, axis]
    for channel, colour in enumerate(colours(particles).T):
        rows[f'f_dc_{channel}'] = (colour - 0.5) / HARMONIC
    rows['opacity'] = numpy.log(opacities / (1 - opacities))
    for axis in range(3):
        rows[f'scale_{axis}'] = numpy.log(deviations)
    rows['rot_0'] = 1
    head = ['ply', 'format binary_little_endian 1.0', f'comment brume, tick {particles.tick}, state {particles.hash}',
            f'element vertex {len(particles)}', *(f'property float {name}' for name in FIELDS), 'end_header', '']
    with open(path, 'wb') as file:
        file.write('\n'.join(head).encode('ascii'))
        file.write(rows.tobytes())
