#!/usr/bin/env python3
"""Builds scenes/lagoon.vox.gz: lagoon.py OUT.vox.gz. Sand, palms, a hut on stilts and coral; lagoon.scene has the water."""
import math
import sys

from voxels import File, Part, colors

colors({
    "sand": [0xF0DDAE, 0xEBD6A3, 0xF4E3B8],
    "wet": [0xD9BF8C, 0xD2B782],
    "deep": [0x9DA98A, 0x8FA087],
    "rock": [0x7D7872, 0x6F6A65, 0x8A857F],
    "grass": [0x74A444, 0x6A9A3D, 0x7FB04D],
    "bush": [0x4B8A3C, 0x559645, 0x427C35],
    "trunk": [0x9A7650, 0x8C6A46],
    "frond": [0x3F8F45, 0x4A9C4E, 0x368040],
    "nut": [0x6B4427],
    "plank": [0xA67C4E, 0x9A7246],
    "post": [0x6F4E31],
    "thatch": [0xC9A35C, 0xBD964F, 0xD3AF69],
    "wall": [0xD8BF8E, 0xCFB583],
    "dark": [0x3B2B20],
    "lamp": [0xFFD98A],
    "boat": [0xC2453A, 0xB73E34],
    "white": [0xF5F1E8],
    "pink": [0xE8708A, 0xDC6480],
    "orange": [0xF0914A, 0xE58640],
    "violet": [0x9A6FC0, 0x8E64B4],
    "yellow": [0xF2CF4E],
    "flower": [0xE8487A],
}, lamp={"_type": "_emit", "_emit": "1", "_flux": "2"})

SIDE = 120
WATER = 14  # the level of lagoon.scene


def wave(x, y, seed):
    """A smooth, small roughness of -1 to 1."""
    return (math.sin(x * 0.11 + seed) * math.cos(y * 0.13 - seed * 1.7) + 0.5 * math.sin(x * 0.23 - y * 0.19 + seed * 3)) / 1.5


def ground(x, y):
    """The height there: a ring of sand round a lagoon, open towards -y, with a hill behind."""
    dx, dy = x - 60, y - 62
    angle = math.atan2(dy, dx)
    far = math.hypot(dx, dy * 1.06)
    ring = 39 + 3.5 * wave(x, y, 1)
    wide = 12 + 5 * math.sin(angle) + 2 * wave(x, y, 2)
    crest = 21 + 3 * math.sin(angle)
    high = crest - ((far - ring) / max(4, wide)) ** 2 * 9
    mouth = math.exp(-((angle + math.pi / 2) / 0.42) ** 2)
    high -= mouth * 13
    hill = 21 * math.exp(-((x - 72) ** 2 + (y - 103) ** 2) / 210) + 13 * math.exp(-((x - 44) ** 2 + (y - 106) ** 2) / 120)
    floor = 4.6 + 0.9 * wave(x, y, 4)
    return max(high + hill, floor, 2)


HEIGHT = [[ground(x, y) for y in range(SIDE)] for x in range(SIDE)]


def land(part):
    for x in range(SIDE):
        for y in range(SIDE):
            top = int(HEIGHT[x][y])
            slope = max(abs(HEIGHT[min(SIDE - 1, x + 1)][y] - HEIGHT[max(0, x - 1)][y]),
                        abs(HEIGHT[x][min(SIDE - 1, y + 1)] - HEIGHT[x][max(0, y - 1)])) / 2
            name = "rock" if slope > 1.15 and top > 18 else "grass" if top > 21 + wave(x, y, 6) else "sand" if top > WATER else \
                "wet" if top > WATER - 4 else "deep"
            around = [int(HEIGHT[a][b]) if 0 <= a < SIDE and 0 <= b < SIDE else 0
                      for a, b in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1))]
            for z in range(max(0, min(around) + 1 if min(around) < top else top), top + 1):
                part.put(name if z > top - 2 else "rock" if name in ("rock", "grass") else name, x, y, z)


def palm(part, x, y, lean, tall):
    """A trunk that bends, and fronds that hang."""
    z0 = int(HEIGHT[x][y])
    for i in range(tall):
        share = (i / tall) ** 2
        tx, ty = round(x + lean[0] * share), round(y + lean[1] * share)
        part.put("trunk", tx, ty, z0 + i)
        if i < tall // 3:
            part.put("trunk", tx + 1, ty, z0 + i)
    tx, ty, tz = x + lean[0], y + lean[1], z0 + tall
    for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        part.put("nut", tx + dx, ty + dy, tz - 1)
    for number in range(9):
        angle = number * math.tau / 9 + x
        length = 9.5 + (number % 3)
        for step in range(int(length * 2)):
            far = step / 2
            z = tz + 2.6 * math.sin(min(1, far / 4.5) * math.pi / 2) - (far / length) ** 2 * 7.5
            cx, cy = tx + math.cos(angle) * far, ty + math.sin(angle) * far
            wide = 1.6 * math.sin(math.pi * min(1, (far + 1) / (length + 1)))
            for side in range(-2, 3):
                if abs(side) <= wide:
                    part.put("frond", round(cx - math.sin(angle) * side), round(cy + math.cos(angle) * side), round(z - abs(side) * 0.6))


def hut(part):
    """On stilts over the lagoon, with a jetty to the beach."""
    x0, x1, y0, y1, floor = 70, 88, 58, 74, WATER + 5
    for x in (x0 + 1, (x0 + x1) // 2, x1 - 1):
        for y in (y0 + 1, y1 - 1):
            part.box("post", (x, x), (y, y), (2, floor))
    part.box("plank", (x0 - 3, x1), (y0 - 3, y1 + 1), (floor, floor))
    for x in range(x0 - 3, x1 + 1, 4):
        part.box("post", (x, x), (y0 - 3, y0 - 3), (floor + 1, floor + 3))
    part.box("post", (x0 - 3, x1), (y0 - 3, y0 - 3), (floor + 3, floor + 3))
    part.box("wall", (x0 + 2, x1 - 1), (y0 + 2, y1 - 1), (floor + 1, floor + 9))
    for x in (x0 + 2, x1 - 1):
        for y in (y0 + 2, y1 - 1):
            part.box("post", (x, x), (y, y), (floor + 1, floor + 10))
    part.box("dark", (x0 + 2, x0 + 2), (y0 + 6, y0 + 9), (floor + 1, floor + 7))
    part.box("lamp", (x0 + 7, x0 + 9), (y0 + 2, y0 + 2), (floor + 4, floor + 7))
    part.box("lamp", (x0 + 13, x0 + 15), (y0 + 2, y0 + 2), (floor + 4, floor + 7))
    part.box("lamp", (x0 + 2, x0 + 2), (y0 + 11, y0 + 12), (floor + 4, floor + 6))
    for row in range(10):
        part.box("thatch", (x0 - 1 + row, x1 + 2 - row), (y0 - 1 + row * 9 // 10, y1 + 2 - row * 9 // 10), (floor + 9 + row, floor + 10 + row))
    for x in range(x1, 102):  # the jetty
        part.box("plank", (x, x), (63, 67), (floor, floor))
        if x % 5 == 0:
            for y in (63, 67):
                part.box("post", (x, x), (y, y), (4, floor + 2))
    part.box("lamp", (x0 - 3, x0 - 3), (y1 + 1, y1 + 1), (floor + 4, floor + 5))
    part.box("post", (x0 - 3, x0 - 3), (y1 + 1, y1 + 1), (floor + 1, floor + 3))
    for step in range(5):  # a ladder into the water
        part.box("post", (x0 - 4, x0 - 4), (66, 68), (floor - 1 - step * 2, floor - 1 - step * 2))


def boat(part, at, length):
    for x in range(-length, length + 1):
        wide = 4.3 * (1 - (x / (length + 1)) ** 2) ** 0.6
        rise = round(abs(x / length) ** 3 * 3)
        for y in range(-5, 6):
            for z in range(0, 5):
                if abs(y) <= wide * (0.55 + 0.11 * z) and (abs(y) > wide * (0.55 + 0.11 * z) - 1 or z == 0):
                    part.put("white" if z == 4 else "boat", at[0] + x, at[1] + y, at[2] + z + rise)
    for x in (-3, 4):
        for y in range(-3, 4):
            part.put("plank", at[0] + x, at[1] + y, at[2] + 3)


def coral(part, x, y, kind):
    z = int(HEIGHT[x][y])
    if kind == 0:
        for dx, dy, tall in ((0, 0, 6), (2, 1, 4), (-2, 0, 5), (1, -2, 3), (-1, 2, 4)):
            part.box("pink", (x + dx, x + dx), (y + dy, y + dy), (z, z + tall))
    elif kind == 1:
        for layer in range(4):
            part.disc("orange", 3.4 - layer * 0.7, z + layer, (x, y))
    else:
        for dx in range(-3, 4):
            for tall in range(0, 6 - abs(dx)):
                if (dx + tall) % 3:
                    part.put("violet", x + dx, y + dx // 2, z + tall)


def bush(part, x, y, size):
    z = int(HEIGHT[x][y])
    for layer in range(size + 1):
        part.disc("bush", (size ** 2 - (layer * 0.9) ** 2) ** 0.5, z + layer, (x, y))
    for dx, dy in ((1, -size + 1), (-size + 1, 0), (0, 1)):
        part.put("flower", x + dx, y + dy, z + size - 1)


def main():
    part = Part()
    land(part)
    for x, y, size in ((30, 96, 4), (88, 98, 5), (58, 104, 4), (22, 60, 3), (99, 60, 3), (80, 92, 3), (40, 92, 4), (25, 80, 3)):
        bush(part, x, y, size)
    for x, y in ((52, 52), (60, 66), (46, 70), (58, 38), (66, 46), (42, 58), (50, 80), (64, 82), (72, 40), (8, 30), (110, 26), (30, 8), (88, 10), (60, 20)):
        coral(part, x, y, (x + y) % 3)
    hut(part)
    boat(part, (46, 47, WATER - 2), 9)
    for x, y, lean, tall in ((21, 54, (5, -3), 25), (26, 72, (6, 2), 29), (18, 68, (-4, 5), 22), (36, 92, (3, -7), 27), (101, 48, (-6, -4), 27),
                             (103, 70, (4, 3), 23), (92, 88, (-5, -6), 28), (60, 99, (-2, -6), 24), (28, 42, (-4, -6), 22), (95, 36, (5, -5), 20)):
        palm(part, x, y, lean, tall)
    scene = File(by_color=True)
    scene.place(scene.model(part))
    scene.write(sys.argv[1])


main()
