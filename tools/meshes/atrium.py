#!/usr/bin/env python3
"""Makes the mesh of scene atrium-mesh: a hall with columns, arches, stairs and a vault that is open to the sky.

python3 tools/meshes/atrium.py > server/scenes/atrium-mesh.glb     a test compares the two
"""
import json
import math
import struct
import sys

# Metres. x: along the hall, y: up, z: across.
LENGTH, WIDTH, BAY = 30, 16, 5
NAVE = 9  # width between the rows of columns
SPRING, WALL = 5.5, 9  # heights where arches begin, and where walls end
COLUMN_HEIGHT = SPRING
STONE, DARK, PLASTER, BRONZE = range(4)
COLOURS = [(0.62, 0.56, 0.47), (0.24, 0.22, 0.21), (0.68, 0.63, 0.56), (0.58, 0.36, 0.16)]


class Mesh:
    """Triangles by material; vertices at the same place are one."""

    def __init__(self):
        self.vertices = [{} for _ in COLOURS]
        self.indices = [[] for _ in COLOURS]

    def triangle(self, material, *corners):
        places = [tuple(round(x, 4) + 0.0 for x in corner) for corner in corners]
        if len(set(places)) < 3:
            return
        vertices = self.vertices[material]
        self.indices[material] += [vertices.setdefault(place, len(vertices)) for place in places]

    def quad(self, material, a, b, c, d):
        self.triangle(material, a, b, c)
        self.triangle(material, a, c, d)

    def box(self, material, lo, hi):
        x, y, z = zip(lo, hi)
        for i in (0, 1):
            self.quad(material, (x[i], y[0], z[0]), (x[i], y[1], z[0]), (x[i], y[1], z[1]), (x[i], y[0], z[1]))
            self.quad(material, (x[0], y[i], z[0]), (x[1], y[i], z[0]), (x[1], y[i], z[1]), (x[0], y[i], z[1]))
            self.quad(material, (x[0], y[0], z[i]), (x[1], y[0], z[i]), (x[1], y[1], z[i]), (x[0], y[1], z[i]))

    def turned(self, material, profile, sides):
        """A profile of (radius, height) turned about the vertical."""
        for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
            for i in range(sides):
                (c0, s0), (c1, s1) = (turn(2 * math.pi * (i + n) / sides) for n in (0, 1))
                self.quad(material, (r0 * c0, y0, r0 * s0), (r0 * c1, y0, r0 * s1), (r1 * c1, y1, r1 * s1),
                          (r1 * c0, y1, r1 * s0))

    def opening(self, material, frame, outline, place, depth):
        """A wall with an opening. frame: x0, y0, x1, y1 of the wall; outline: of the opening, from its lower left end
        over its arch to its lower right one; place(x, y, out): a point of the wall, or `out` metres outside."""
        x0, y0, x1, y1 = frame
        left, right, sill = outline[0][0], outline[-1][0], outline[0][1]
        def flat(*corners):
            self.quad(material, *(place(x, y, 0) for x, y in corners))
        flat((x0, y0), (x1, y0), (x1, sill), (x0, sill))
        flat((x0, sill), (left, sill), (left, y1), (x0, y1))
        flat((right, sill), (x1, sill), (x1, y1), (right, y1))
        for (ax, ay), (bx, by) in zip(outline, outline[1:]):
            if ax != bx:
                flat((ax, ay), (bx, by), (bx, y1), (ax, y1))
        for (ax, ay), (bx, by) in zip(outline, outline[1:] + outline[:1]):
            self.quad(material, place(ax, ay, 0), place(bx, by, 0), place(bx, by, depth), place(ax, ay, depth))


def turn(angle):
    return math.cos(angle), math.sin(angle)


def arch(middle, half, lowest, spring, steps):
    """Outline of an opening with a round arch."""
    points = [(middle - half, lowest)]
    for i in range(steps + 1):
        c, s = turn(math.pi * (1 - i / steps))
        points.append((middle + half * c, spring + half * s))
    return points + [(middle + half, lowest)]


def bays():
    return range(-LENGTH // 2, LENGTH // 2, BAY)


def hall():
    mesh = Mesh()
    for i in range(LENGTH // 2):  # tiles of 2 m
        for k in range(WIDTH // 2):
            x, z = 2 * i - LENGTH / 2, 2 * k - WIDTH / 2
            mesh.quad(DARK if (i + k) % 2 else STONE, (x, 0, z), (x + 2, 0, z), (x + 2, 0, z + 2), (x, 0, z + 2))
    for side in (-1, 1):
        for x in bays():
            # An outer wall with a window, and the arcade before it, which is half a metre thick.
            window = arch(x + BAY / 2, 1.1, 2.2, 5.4, 12)
            mesh.opening(PLASTER, (x, 0, x + BAY, WALL), window,
                         lambda u, v, out: (u, v, side * (WIDTH / 2 + out)), 0.5)
            span = arch(x + BAY / 2, BAY / 2 - 0.45, SPRING, SPRING, 16)
            for face in (-0.25, 0.25):
                mesh.opening(STONE, (x, SPRING, x + BAY, WALL), span,
                             lambda u, v, out: (u, v, side * (NAVE / 2 + face + out)), 0.5 if face < 0 else 0)
        inner, outer = side * NAVE / 2, side * WIDTH / 2
        mesh.quad(PLASTER, (-LENGTH / 2, WALL, inner), (LENGTH / 2, WALL, inner), (LENGTH / 2, WALL, outer),
                  (-LENGTH / 2, WALL, outer))
    vault(mesh)
    for end in (-LENGTH / 2, LENGTH / 2):
        mesh.quad(PLASTER, (end, 0, -WIDTH / 2), (end, 0, WIDTH / 2), (end, WALL, WIDTH / 2), (end, WALL, -WIDTH / 2))
        for i in range(24):  # what the vault leaves open
            (c0, s0), (c1, s1) = (turn(math.pi * (i + n) / 24) for n in (0, 1))
            mesh.triangle(PLASTER, (end, WALL, 0), (end, WALL + NAVE / 2 * s0, NAVE / 2 * c0),
                          (end, WALL + NAVE / 2 * s1, NAVE / 2 * c1))
    stairs(mesh)
    return mesh


def vault(mesh):
    """Half a cylinder over the nave, with openings at its top between ribs."""
    radius, steps, thick = NAVE / 2, 24, 0.35
    for x in bays():
        for i in range(steps):
            (c0, s0), (c1, s1) = (turn(math.pi * (i + n) / steps) for n in (0, 1))
            is_open = steps * 0.3 <= i < steps * 0.7
            for a, b in [(x, x + 0.5), (x + 4.5, x + 5)] if is_open else [(x, x + BAY)]:
                for r in (radius, radius + thick):
                    mesh.quad(PLASTER, (a, WALL + r * s0, r * c0), (b, WALL + r * s0, r * c0),
                              (b, WALL + r * s1, r * c1), (a, WALL + r * s1, r * c1))
            if is_open:
                for end in (x + 0.5, x + 4.5):
                    outer = radius + thick
                    mesh.quad(STONE, (end, WALL + radius * s0, radius * c0), (end, WALL + radius * s1, radius * c1),
                              (end, WALL + outer * s1, outer * c1), (end, WALL + outer * s0, outer * c0))
    for angle in (0.4, 0.6):  # bars of bronze along the hall
        c, s = turn(math.pi * angle)
        y, z = WALL + (radius + 0.1) * s, (radius + 0.1) * c
        mesh.box(BRONZE, (-LENGTH / 2, y - 0.1, z - 0.1), (LENGTH / 2, y + 0.1, z + 0.1))


def stairs(mesh):
    """Twelve steps to a landing at the far end, between two cheeks."""
    rise, tread, half = 0.17, 0.38, 3.2
    front = -LENGTH / 2 + 2.6 + 12 * tread
    for i in range(12):
        x, y = front - i * tread, i * rise
        mesh.quad(STONE, (x, y, -half), (x, y + rise, -half), (x, y + rise, half), (x, y, half))
        mesh.quad(STONE, (x, y + rise, -half), (x - tread, y + rise, -half), (x - tread, y + rise, half),
                  (x, y + rise, half))
    top = 12 * rise
    mesh.quad(STONE, (-LENGTH / 2, top, -half), (-LENGTH / 2 + 2.6, top, -half), (-LENGTH / 2 + 2.6, top, half),
              (-LENGTH / 2, top, half))
    for side in (-1, 1):
        z0, z1 = sorted((side * half, side * (half + 0.5)))
        for z in (z0, z1):
            mesh.quad(STONE, (front + 0.4, 0, z), (front + 0.4, 0.6, z), (-LENGTH / 2 + 2.6, top + 0.6, z),
                      (-LENGTH / 2 + 2.6, 0, z))
        mesh.quad(STONE, (front + 0.4, 0.6, z0), (-LENGTH / 2 + 2.6, top + 0.6, z0),
                  (-LENGTH / 2 + 2.6, top + 0.6, z1), (front + 0.4, 0.6, z1))
        mesh.quad(STONE, (front + 0.4, 0, z0), (front + 0.4, 0.6, z0), (front + 0.4, 0.6, z1), (front + 0.4, 0, z1))
        mesh.box(STONE, (-LENGTH / 2, 0, z0), (-LENGTH / 2 + 2.6, top + 0.6, z1))
    # A gate of bronze behind the landing.
    for bar in range(-6, 7):
        mesh.box(BRONZE, (-LENGTH / 2 + 0.3, top, 0.25 * bar - 0.03),
                 (-LENGTH / 2 + 0.36, top + 3.2 - 0.012 * bar * bar, 0.25 * bar + 0.03))
    mesh.box(DARK, (-LENGTH / 2, top, -1.7), (-LENGTH / 2 + 0.02, top + 3.4, 1.7))


def column():
    mesh = Mesh()
    mesh.box(STONE, (-0.55, 0, -0.55), (0.55, 0.25, 0.55))
    mesh.turned(STONE, [(0.5, 0.25), (0.54, 0.33), (0.5, 0.42), (0.42, 0.5), (0.4, 2.2), (0.355, 4.7), (0.42, 4.78),
                        (0.38, 4.86), (0.4, 5.0), (0.54, 5.22)], 20)
    mesh.box(STONE, (-0.6, 5.22, -0.6), (0.6, COLUMN_HEIGHT, 0.6))
    return mesh


def sculpture():
    """A knot on a pedestal."""
    mesh = Mesh()
    mesh.turned(DARK, [(1.5, 0), (1.5, 0.25), (1.2, 0.25), (1.2, 0.5), (0.5, 0.6), (0.4, 1.2), (0, 1.2)], 24)

    def middle(t):
        r = 0.75 + 0.3 * math.cos(3 * t)
        return (r * math.cos(2 * t), 2.3 + 0.95 * r * math.sin(2 * t), 0.42 * math.sin(3 * t))

    rings, sides = 132, 10
    tube = []
    for i in range(rings):
        t = 2 * math.pi * i / rings
        here, ahead = middle(t), middle(t + 1e-3)
        along = unit(tuple(b - a for a, b in zip(here, ahead)))
        across = unit(cross(along, (0.1, 0.2, 1)))
        other = cross(along, across)
        tube.append([tuple(h + 0.15 * (c * a + s * o) for h, a, o in zip(here, across, other))
                     for c, s in (turn(2 * math.pi * k / sides) for k in range(sides))])
    for i in range(rings):
        a, b = tube[i], tube[(i + 1) % rings]
        for k in range(sides):
            n = (k + 1) % sides
            mesh.quad(BRONZE, a[k], a[n], b[n], b[k])
    return mesh


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def glb(meshes, nodes):
    """The bytes of a .glb file. nodes: pairs of a mesh's index and a place."""
    data, views, accessors, out = b"", [], [], []
    for mesh in meshes:
        primitives = []
        for material, (vertices, indices) in enumerate(zip(mesh.vertices, mesh.indices)):
            if not indices:
                continue
            places = list(vertices)
            primitives.append({"attributes": {"POSITION": len(accessors)}, "indices": len(accessors) + 1,
                               "material": material})
            columns = list(zip(*places))
            accessors.append({"bufferView": len(views), "componentType": 5126, "count": len(places), "type": "VEC3",
                              "min": [min(c) for c in columns], "max": [max(c) for c in columns]})
            accessors.append({"bufferView": len(views) + 1, "componentType": 5123, "count": len(indices),
                              "type": "SCALAR"})
            for block in (struct.pack(f"<{3 * len(places)}f", *(x for place in places for x in place)),
                          struct.pack(f"<{len(indices)}H", *indices)):
                views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(block)})
                data += block + bytes(-len(block) % 4)
        out.append({"primitives": primitives})
    document = {
        "asset": {"version": "2.0", "generator": "tools/meshes/atrium.py"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": [{"mesh": mesh, "translation": place} for mesh, place in nodes],
        "meshes": out,
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0},
                       "doubleSided": True} for colour in COLOURS],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data


def main():
    columns = [(1, [x, 0, side * NAVE / 2]) for side in (-1, 1) for x in range(-LENGTH // 2 + BAY, LENGTH // 2, BAY)]
    sys.stdout.buffer.write(glb([hall(), column(), sculpture()], [(0, [0, 0, 0]), *columns, (2, [1.5, 0, 0])]))


main()
