#!/usr/bin/env python3
"""Builds scenes/castle.vox: castle.py OUT.vox. A castle on an island, as models that a scene graph places."""
import sys

from voxels import File, Part, colors

COLORS = {}  # name -> shades, as 0xRRGGBB
COLORS["stone"] = [0xB9B2A3, 0xAFA797, 0xC2BBAD, 0xA59D8E]
COLORS["trim"] = [0x8E8677, 0x857D6F]
COLORS["slate"] = [0x34507E, 0x3C5B8E, 0x2D4670]
COLORS["tile"] = [0xB8402F, 0xA83526, 0xC44C38]
COLORS["grass"] = [0x6FA043, 0x78AA4A, 0x66963D, 0x6FA043]
COLORS["earth"] = [0x8A6642, 0x7C5A3A]
COLORS["rock"] = [0x7E7A76, 0x6E6A67, 0x8A8681]
COLORS["water"] = [0x3F8FB8, 0x4A9BC4, 0x3F8FB8]
COLORS["path"] = [0xD2B98A, 0xC7AD7D]
COLORS["wood"] = [0x6B4528, 0x5C3A21]
COLORS["plaster"] = [0xE9DFC8, 0xE2D7BE]
COLORS["leaf"] = [0x4C8A3A, 0x569542, 0x427C33]
COLORS["pine"] = [0x2F6B45, 0x387650, 0x28603D]
COLORS["light"] = [0xFFD36B]
COLORS["dark"] = [0x2C2A2E]
COLORS["red"] = [0xD0312D]
COLORS["gold"] = [0xF2C14E]
colors(COLORS)


def island():
    """A quarter: turned about the origin it makes the whole. The lawn is layer 0; the bottom is left open."""
    part = Part()
    for layer in range(8):
        for x in range(40):
            for y in range(40):
                squared = (x + 0.5) ** 2 + (y + 0.5) ** 2
                ragged = (x * 7 + y * 13 + x * y) % 5 * 0.3 if layer > 4 else 0
                is_moat = 31 ** 2 <= squared <= 35.2 ** 2
                if squared <= (39.4 - layer * 0.1 - ragged) ** 2 and not (is_moat and layer == 0):
                    name = "water" if is_moat and layer == 1 else ("grass", "grass", "earth", "earth")[layer] \
                        if layer < 4 else "rock"
                    part.put(name, x, y, -layer)
    inside = dict(part)
    for x, y in [(x, y) for x in range(-1, 40) for y in range(-1, 40)]:  # hides the bottom and the cuts
        inside[x, y, -8] = 0
    for along in range(-1, 40):
        for layer in range(8):
            inside[along, -1, -layer] = inside[-1, along, -layer] = 0
    shown = Part(inside).visible()
    return {place: color for place, color in part.items() if place in shown}


def tower():
    part = Part()
    for z in range(1, 22):
        part.disc("trim" if z in (1, 17) else "stone", 4.9 if z == 1 else 4.5, z)
    for z in range(18, 21):
        part.disc("stone", 5.4, z)
    for x, y, _ in [place for place in part if place[2] == 20]:
        if (x + y) % 3 == 0 and x * x + y * y > 4.2 ** 2:
            del part[x, y, 20]
    for z in (6, 7, 12, 13):
        for x, y in ((0, -4), (0, 4), (-4, 0), (4, 0)):
            part.put("dark" if z < 10 else "light", x, y, z)
    part.cone("tile", 6.2, 13, 21)
    part.flag("gold", 0, 0, 33)
    return part


def wall():
    """Along x, its outer face towards -y."""
    part = Part()
    part.box("stone", (-13, 13), (-1, 1), (1, 11))
    part.box("trim", (-13, 13), (-2, -2), (1, 1))
    part.box("trim", (-13, 13), (-2, -2), (10, 10))
    for x in range(-13, 14):
        part.put("stone", x, -2, 11)
        if x % 4 != 2:
            part.put("stone", x, -2, 12)
            part.put("stone", x, -2, 13)
    for x in (-8, 0, 8):
        part.box("dark", (x, x), (-1, -1), (5, 7))
    return part


def gate():
    part = wall()
    for x in (-6, 6):
        part.box("stone", (x - 2, x + 2), (-4, 2), (1, 16))
        part.box("trim", (x - 3, x + 3), (-5, 3), (15, 15))
        part.box("stone", (x - 3, x + 3), (-5, 3), (16, 16))
        for corner_x in (x - 3, x - 1, x + 1, x + 3):
            for corner_y in (-5, -3, -1, 1, 3):
                part.box("stone", (corner_x, corner_x), (corner_y, corner_y), (17, 18))
        for row in range(4):
            part.box("tile", (x - 2 + row, x + 2 - row), (-4 + row, 2 - row), (17 + row, 17 + row))
        part.box("light", (x, x), (-4, -4), (11, 12))
        part.box("red", (x - 1, x + 1), (-5, -5), (4, 9))
        part.put("gold", x, -5, 7)
        part.put("gold", x, -5, 6)
        del part[x, -5, 4]
    part.box("trim", (-3, 3), (-3, -2), (1, 9))
    part.box("stone", (-3, 3), (-3, -2), (10, 13))
    for z in range(1, 9):
        half = 2 if z < 7 else 1 if z == 7 else 0
        for x in range(-half, half + 1):
            for y in (-3, -2):
                part.pop((x, y, z), None)
            part.put("wood" if (x + z) % 2 else "dark", x, -1, z)
    return part


def keep():
    part = Part()
    part.box("stone", (-8, 8), (-7, 7), (1, 27))
    for x in (-8, 8):
        for y in (-7, 7):
            part.box("trim", (x - 1, x + 1), (y - 1, y + 1), (1, 27))
    for z in (10, 19, 27):
        part.box("trim", (-9, 9), (-8, 8), (z, z))
    part.box("stone", (-9, 9), (-8, 8), (28, 28))
    for x in range(-9, 10):
        for y in range(-8, 9):
            if (abs(x) == 9 and y % 3 != 0) or (abs(y) == 8 and x % 3 != 1):
                part.box("stone", (x, x), (y, y), (29, 30))
    for z in (4, 13, 22):
        for along in (-4, 0, 4):
            for high in range(4):
                color = "light" if (along + z) % 8 != 0 else "dark"
                for x, y in ((along, -7), (along, 7), (-8, along), (8, along)):
                    part.put(color if high < 3 else "trim", x, y, z + high)
    for row in range(7):
        part.box("slate", (-7 + row, 7 - row), (-6 + row, 6 - row), (29 + 2 * row, 30 + 2 * row))
    for z in range(1, 43):
        part.disc("trim" if z in (34, 38) else "stone", 3.9 if z > 38 else 3.4, z, (8, 7))
    for z in (36, 37):
        for x, y in ((8, 4), (5, 7), (11, 7), (8, 10)):
            part.put("light", x, y, z)
    part.cone("slate", 5.0, 14, 43, (8, 7))
    part.flag("red", 8, 7, 56)
    part.flag("red", 0, 0, 42)
    return part


def house():
    part = Part()
    part.box("plaster", (-4, 4), (-3, 3), (1, 5))
    for x in (-4, 0, 4):
        part.box("wood", (x, x), (-3, -3), (1, 5))
        part.box("wood", (x, x), (3, 3), (1, 5))
    for row in range(5):
        part.box("tile", (-5, 5), (-4 + row, 4 - row), (5 + row, 5 + row))
    part.box("light", (2, 2), (-3, -3), (2, 3))
    part.box("light", (-2, -2), (-3, -3), (2, 3))
    part.box("trim", (3, 3), (1, 1), (6, 11))
    return part


def path():
    part = Part()
    part.box("path", (-2, 2), (-38, -21), (1, 1))
    for x in (-3, 3):
        part.box("wood", (x, x), (-36, -31), (1, 2))
        part.box("wood", (x, x), (-36, -36), (3, 3))
        part.box("wood", (x, x), (-31, -31), (3, 3))
    part.box("path", (-2, 2), (-15, -8), (1, 1))
    return part


def oak():
    part = Part()
    part.box("wood", (0, 0), (0, 0), (1, 3))
    for z, radius in ((3, 2.3), (4, 3.0), (5, 3.2), (6, 3.0), (7, 2.3), (8, 1.2)):
        part.disc("leaf", radius, z)
    return part


def pine():
    part = Part()
    part.box("wood", (0, 0), (0, 0), (1, 2))
    for z, radius in ((3, 2.9), (4, 2.3), (5, 1.5), (6, 2.4), (7, 1.5), (8, 1.0), (9, 1.5), (10, 1.0), (11, 0.5), (12, 0)):
        part.disc("pine", radius, z)
    return part


def main():
    castle = File()
    quarter = castle.model(island())
    corner = castle.model(tower())
    side = castle.model(wall())
    for turns in range(4):
        castle.place(quarter, turns=turns)
    for x in (-18, 18):
        for y in (-18, 18):
            castle.place(corner, (x, y, 0))
    for turns in (1, 2, 3):
        castle.place(side, [(0, -18, 0), (19, 0, 0), (1, 19, 0), (-18, 1, 0)][turns], turns)
    castle.place(castle.model(gate()), (0, -18, 0))
    castle.place(castle.model(keep()), (1, 5, 0))
    castle.place(castle.model(house()), (-11, -9, 0))
    castle.place(castle.model(path()))
    trees = (castle.model(oak()), castle.model(pine()))
    for i, (x, y) in enumerate(((-29, -5), (-28, 3), (28, -7), (29, 2), (27, 9), (-6, -26), (8, -26), (-13, -25),
                                (-27, 10), (11, 27), (3, 28), (-8, 27), (13, -10), (-36, -12), (36, -13))):
        castle.place(trees[(i * 2 + i // 3) % 2], (x, y, 0))
    castle.write(sys.argv[1])


main()
