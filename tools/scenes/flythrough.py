#!/usr/bin/env python3
"""Makes scene flythrough: six places of a small town in fog, after the fly-through of seed 004.

python3 tools/scenes/flythrough.py > server/scenes/flythrough.toml     a test compares the two
"""
import math
import random

# Metres: x to the right, y up. The sun stands low over -z, so that one looks toward it along the way.
TO_SUN = (-0.35, 0.5, -1)
WARM, AMBER, COLD = (110, 78, 42), (150, 84, 30), (50, 78, 110)
STONE, PALE, BRICK, DARK = (0.42, 0.39, 0.35), (0.55, 0.52, 0.47), (0.42, 0.24, 0.17), (0.16, 0.15, 0.15)
BARK, LEAVES = (0.16, 0.11, 0.08), [(0.1, 0.2, 0.06), (0.14, 0.24, 0.07), (0.2, 0.25, 0.08), (0.26, 0.22, 0.07)]


def number(x):
    return f"{round(x, 3) + 0.0:g}"


def vector(v):
    return f"[{', '.join(number(x) for x in v)}]"


def table(**values):
    def text(value):
        return f'"{value}"' if isinstance(value, str) else vector(value) if isinstance(value, tuple) else number(value)
    return "{ " + ", ".join(f"{key} = {text(value)}" for key, value in values.items()) + " }"


def times(colour, factor):
    return tuple(round(factor * x) for x in colour)


class Town:
    def __init__(self):
        self.lists = {"light": [], "box": [], "sphere": []}

    def comment(self, name, text):
        self.lists[name].append(f"# {text}")

    def box(self, x, y, z, size, albedo, yaw=0):
        """A box that stands on height y."""
        values = {"centre": (x, y + size[1] / 2, z), "size": size, "albedo": albedo}
        self.lists["box"].append(table(**values, **({"yaw": yaw} if yaw else {})))

    def ball(self, x, y, z, radius, albedo):
        self.lists["sphere"].append(table(centre=(x, y, z), radius=radius, albedo=albedo))

    def lamp(self, x, y, z, intensity, reach):
        self.lists["light"].append(table(type="point", position=(x, y, z), intensity=intensity, range=reach))

    def spot(self, x, y, z, intensity, reach, outer, axis=None):
        values = {"type": "spot", "position": (x, y, z), "intensity": intensity, "inner": outer * 0.6}
        values |= {"outer": outer, "range": reach}
        self.lists["light"].append(table(**values, **({"axis": axis} if axis else {})))

    def names(self, text):
        for name in self.lists:
            self.comment(name, text)


def balls(town):
    """LocalPM: a square with two balls of fog, one around a lamp."""
    town.names("LocalPM")
    town.box(0, 0, 0, (7, 0.5, 7), PALE, 0.4)
    town.box(0, 0.5, 0, (1, 2.2, 1), STONE, 0.4)
    town.ball(0, 3.3, 0, 0.6, PALE)
    town.lamp(2.6, 2.1, 1.4, times(AMBER, 0.5), 9)
    town.lamp(9.4, 1.4, 1.2, times(COLD, 0.5), 8)
    for x, z in ((-6, -6), (6, -6), (-6, 7)):
        town.spot(x, 5, z, WARM, 12, 1.2)


def alley(town):
    """Close: between two walls, with crates."""
    town.names("Close")
    town.box(25, 0, 5, (8, 9, 18), BRICK)
    town.box(35.4, 0, 5, (8, 8, 18), STONE)
    town.box(30.2, 0, -4.2, (2.4, 5, 0.5), DARK)
    town.box(29.7, 0, -1.5, (1.1, 1.1, 1.1), BARK, 0.3)
    town.box(29.8, 1.1, -1.5, (0.8, 0.8, 0.8), BARK, 0.8)
    town.box(30.8, 0, -2.9, (0.9, 0.9, 0.9), BARK, -0.2)
    town.lamp(29.4, 3.1, -1.9, times(WARM, 0.2), 8)
    town.lamp(31, 3.1, 3.2, times(WARM, 0.12), 8)
    town.spot(30.2, 4.6, -3.6, times(AMBER, 0.6), 9, 0.8)


def street(town):
    """LocalLights: a street in the shadow of the town's wall, with lamps on both sides."""
    town.names("LocalLights")
    town.box(85, 0, -44, (150, 20, 4), STONE)
    for x in (10, 60, 110, 160):
        town.box(x, 0, -43, (9, 27, 9), PALE, 0.25)
    rng = random.Random(4)
    for i in range(8):
        x, height = 52 + 15 * i, 7 + 5 * rng.random()
        town.box(x, 0, -15, (11.5, height, 10), (BRICK, STONE, PALE)[i % 3])
    for i in range(18):
        x = 16 + 8 * i
        colour = (WARM, AMBER, WARM, COLD, WARM, AMBER)[i % 6]
        town.spot(x, 5.2, -36.5, times(colour, 1.2), 15, 1.25)
        town.spot(x + 4, 5.2, -24, times(colour, 1.2), 15, 1.25)


def tree(town):
    """Sun: a tree before the sun."""
    town.names("Sun")
    x, z = -25, -10
    town.box(x, 0, z, (1, 7, 1), BARK, 0.5)
    town.box(x + 1.3, 5, z + 0.4, (0.5, 3.5, 0.5), BARK)
    town.box(x - 1.2, 5.5, z - 0.3, (0.45, 3, 0.45), BARK)
    rng = random.Random(5)
    for i in range(58):
        # Evenly about the crown, with holes between the leaves.
        up = 1 - 2 * (i + 0.5) / 58
        turn = i * math.pi * (3 - math.sqrt(5))
        part = 0.3 + 0.7 * rng.random() ** 0.6
        across = 6 * part * math.sqrt(1 - up * up)
        place = (x + across * math.cos(turn), 10.4 + 4.4 * part * up, z + across * math.sin(turn))
        town.ball(*place, 0.4 + 0.6 * rng.random(), rng.choice(LEAVES))
    town.lamp(x + 4, 2.2, z + 7, times(AMBER, 0.3), 7)


def spikes(town):
    """Depth: spikes below a tower, that one looks down from."""
    town.names("Depth")
    x, z = -70, -35
    town.box(x, 0, z, (6, 38, 6), STONE)
    town.box(x, 38, z, (8, 1.2, 8), PALE)
    rng = random.Random(7)
    for i in range(13):
        turn, away = 3 + 0.29 * i, 7 + 17 * ((i * 5) % 13) / 12
        height = 36 - 1.1 * away + 9 * rng.random()
        place = (x + away * math.cos(turn), 0, z + away * math.sin(turn))
        town.box(*place, (0.9, height, 0.9), (DARK, BRICK, PALE)[i % 3], turn)
    for i in range(7):
        turn, away = 3.2 + 0.5 * i, 8 + 5 * (i % 3)
        town.lamp(x + away * math.cos(turn), 3, z + away * math.sin(turn), times((AMBER, COLD)[i % 2], 2), 14)


def roofs(town):
    """Balance: roofs in the sun and lamps below them, in thick fog."""
    town.names("Balance")
    houses = ((58, 28, 12, 9, 6), (74, 22, 10, 12, 8), (60, 45, 14, 8, 7), (80, 42, 11, 11, 5))
    for x, z, width, depth, height in houses:
        town.box(x, 0, z, (width, height, depth), BRICK)
        town.box(x, height, z, (width + 1, 0.5, depth + 1), DARK)
        town.box(x + width / 4, height, z, (1.1, 2.6, 1.1), STONE)
    for x, z in ((67, 30), (68, 38), (50, 36), (71, 49)):
        town.spot(x, 5, z, times(WARM, 2.5), 15, 1.2)
    town.lamp(66, 2.5, 16, times(AMBER, 2), 13)
    town.lamp(88, 3, 31, times(COLD, 2), 13)


HEAD = """# Six places of a town in fog, after the fly-through of seed 004: docs/gallery.md has a view of each. Made by
# tools/scenes/flythrough.py.
name = "flythrough"
"""
TAIL = """
[medium]
layout = "none"

# Over everything, thinner with height.
[[fog]]
extinction = 0.016
falloff = 0.055
albedo = [0.97, 0.97, 0.97]
phase = "double"
anisotropy = 0.65
asymmetry = 0.65
second_asymmetry = -0.1

# LocalPM: white fog, and smoke.
[[fog]]
extinction = 0.7
centre = [2.8, 2.6, 1.2]
radius = 2.4
albedo = [0.97, 0.97, 0.97]
anisotropy = 0.5
asymmetry = 0.5

[[fog]]
extinction = 1.1
centre = [9.2, 1.9, 1]
radius = 1.7
albedo = [0.62, 0.6, 0.6]

# Balance.
[[fog]]
extinction = 0.03
centre = [66, 2, 33]
radius = 26
albedo = [0.97, 0.96, 0.95]
anisotropy = 0.6
asymmetry = 0.5

[[plane]]
albedo = [0.17, 0.165, 0.15]

[sky]
zenith = [0.08, 0.13, 0.26]
horizon = [0.34, 0.3, 0.28]
ambient = [0.035, 0.042, 0.055]

[camera]
position = [-4, 2.6, 15]
target = [4.5, 3, 0]
fov_y = 0.85

[render]
exposure = 0.85
rate = 4 # rims of the balls of fog change within a few pixels
opaque_shadow_size = 4096
"""


def main():
    town = Town()
    for place in (balls, alley, street, tree, spikes, roofs):
        place(town)
    print(HEAD)
    sun = f"{{ to_light = {vector(TO_SUN)}, irradiance = [8, 5.7, 3.6] }}"
    town.lists["light"].insert(0, sun)
    for name, lines in town.lists.items():
        print(f"{name} = [")
        for line, following in zip(lines, [*lines[1:], "#"]):
            if not line.startswith("#"):
                print(f"    {line},")
            elif not following.startswith("#"):  # a place that has some
                print(f"    {line}")
        print("]\n" if name != "sphere" else "]")
    print(TAIL, end="")


main()
