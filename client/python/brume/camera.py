"""Where a camera looks."""
from __future__ import annotations

import math
from typing import Sequence

from brume.error import BrumeError
from brume.kinds import Quat


def look_at(position: Sequence[float], target: Sequence[float]) -> Quat:
    """The orientation (world from view, a quaternion) of a camera that looks from `position` to `target`, upright; both
    in m."""
    x, y, z = (b - a for a, b in zip(position, target))
    length = math.sqrt(x * x + y * y + z * z)
    if not length > 0:
        raise BrumeError('position and target are the same place', 'out_of_range')
    yaw, pitch = math.atan2(-x, -z), math.asin(max(-1.0, min(1.0, y / length)))
    cy, sy, cp, sp = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    return (cy * sp, sy * cp, -sy * sp, cy * cp)
