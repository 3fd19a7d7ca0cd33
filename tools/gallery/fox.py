#!/usr/bin/env python3
"""Builds scenes/fox.vox.gz: fox.py OUT.vox.gz. A fox that sits in a meadow, from rounded shapes that flow into one another."""
import math
import sys

from voxels import File, Part, colors

colors({
    "coat": [0xD9692A, 0xD26226, 0xE0712F],
    "back": [0xBE5420, 0xB84F1D],
    "white": [0xF7EFE2, 0xF1E7D7],
    "sock": [0x3B2A26, 0x443029],
    "nose": [0x221A1C],
    "eye": [0x2A1B12],
    "shine": [0xFFFFFF],
    "inner": [0xE8A98A],
    "grass": [0x6C9F3C, 0x78AC45, 0x649536],
    "blade": [0x86BC4C, 0x5B8C34],
    "earth": [0x84603F, 0x775436],
    "stone": [0x9A9690, 0x8A867F],
    "cap": [0xC9342B, 0xBD2E26],
    "stem": [0xF3E9D6],
    "petal": [0xF6C945],
    "petals": [0xE884B5],
    "bloom": [0xF4F2FF],
})


def ellipsoid(at, radii):
    """A distance, about, to its surface; negative inside."""
    def distance(x, y, z):
        unit = math.sqrt(sum(((value - middle) / radius) ** 2
                             for value, middle, radius in zip((x, y, z), at, radii)))
        return (unit - 1) * min(radii)
    return distance


def capsule(a, b, thick_a, thick_b):
    span = [q - p for p, q in zip(a, b)]
    squared = sum(s * s for s in span)

    def distance(x, y, z):
        part = sum((value - p) * s for value, p, s in zip((x, y, z), a, span)) / squared
        part = min(1, max(0, part))
        gap = math.sqrt(sum((value - p - part * s) ** 2 for value, p, s in zip((x, y, z), a, span)))
        return gap - (thick_a + (thick_b - thick_a) * part)
    return distance


def smooth(values, width):
    """The least of the distances, rounded where two are alike."""
    least = values[0]
    for value in values[1:]:
        share = max(0, min(1, 0.5 + 0.5 * (value - least) / width))
        least = value + (least - value) * share - width * share * (1 - share)
    return least


# It looks towards -y; x is across. The ground is z = 0.
BODY = (ellipsoid((0, 8, 17), (13.5, 14.5, 16)), ellipsoid((0, 1, 29), (10.5, 10, 14)), ellipsoid((0, -1, 39), (7.6, 7.6, 9)),
        ellipsoid((-10.5, 5, 9), (7, 11, 9.4)), ellipsoid((10.5, 5, 9), (7, 11, 9.4)))
HAUNCHES = (capsule((-11, -3, 2.3), (-11, -9, 2), 3, 2.6), capsule((11, -3, 2.3), (11, -9, 2), 3, 2.6))
LEGS = (capsule((-5, -5, 26), (-5, -10, 3), 4.6, 3.1), capsule((5, -5, 26), (5, -10, 3), 4.6, 3.1),
        capsule((-5, -11, 2), (-5, -13.5, 1.8), 3.1, 2.5), capsule((5, -11, 2), (5, -13.5, 1.8), 3.1, 2.5))
HEAD = (ellipsoid((0, -4, 51), (12.6, 10.6, 9.8)), ellipsoid((-7.5, -6, 47.6), (7.4, 6.2, 5.4)),
        ellipsoid((7.5, -6, 47.6), (7.4, 6.2, 5.4)), capsule((0, -9, 48.5), (0, -19, 46.4), 5.4, 2.6))
TAIL = [(14, 16, 6), (23, 12, 6.5), (28, 2, 7), (25, -9, 7), (16, -16, 6.4), (8, -19, 5)]
THICK = [4.4, 6.6, 7.6, 7.4, 5.6, 2.2]


def tail(x, y, z):
    return smooth([capsule(TAIL[i], TAIL[i + 1], THICK[i], THICK[i + 1])(x, y, z) for i in range(len(TAIL) - 1)], 2)


def ear(side):
    """A bent triangle, hollow in front."""
    def inside(x, y, z):
        high = (z - 57) / 13
        middle = side * (8 + 3 * high)
        return 0 <= high <= 1 and abs(x - middle) <= 5.6 * (1 - high) ** 0.8 + 0.3 and \
            abs(y + 2 - high * 1.5) <= 2.8 * (1 - 0.6 * high)
    return inside


EARS = (ear(-1), ear(1))


def coat(x, y, z, what):
    if what == "tail":
        tip = math.dist((x, y, z), TAIL[-1])
        return "white" if tip < 9.5 + (x * 3 + y * 5 + z * 7) % 4 * 0.9 else "coat"
    if what == "legs":
        return "sock" if z < 12 + (x * 5 + y * 3) % 3 else "coat"
    if what == "haunches":
        return "sock" if y < -4 else "coat"
    if what == "head":
        ragged = (x * 3 + z * 5) % 3 * 0.5
        if z < 47.2 + max(0.0, (abs(x) - 4) * 0.42) + (0 if y < -12 else -0.2) + ragged and y < 3:
            return "white"
        return "coat"
    if y < -1 - max(0.0, (z - 30) * 0.06) and abs(x) < 7.2 - abs(z - 34) * 0.16 + (x * 3 + z * 7) % 3 * 0.6 and z > 15:
        return "white"
    return "back" if y > 16 and z > 10 and abs(x) < 5 else "coat"


def fox():
    part = Part()
    parts = (("legs", lambda *p: smooth([f(*p) for f in LEGS], 1.5)), ("haunches", lambda *p: smooth([f(*p) for f in HAUNCHES], 1)),
             ("head", lambda *p: smooth([f(*p) for f in HEAD], 2.6)), ("tail", tail),
             ("body", lambda *p: smooth([f(*p) for f in BODY], 3.5)))
    for x in range(-22, 38):
        for y in range(-28, 26):
            for z in range(0, 62):
                best, name = min((distance(x, y, z), name) for name, distance in parts)
                if best <= 0:
                    part.put(coat(x, y, z, name), x, y, z)
    for side, inside in zip((-1, 1), EARS):
        for x in range(-18, 19):
            for y in range(-8, 5):
                for z in range(55, 72):
                    if inside(x, y, z):
                        part.put("sock" if z > 65 else "coat", x, y, z)
        for x in range(-18, 19):
            for z in range(58, 67):
                high = (z - 57) / 13
                if abs(x - side * (8 + 3 * high)) <= 3.4 * (1 - high):
                    for y in range(-8, 5):
                        if part.pop((x, y, z), None):
                            part.put("inner", x, y + 1, z)
                            break
    for side in (-1, 1):
        for x, z in [(x, z) for x in range(3, 8) for z in range(49, 54) if (x - 5) ** 2 + (z - 51) ** 2 < 7]:
            front = min(y for (a, y, c) in part if a == side * x and c == z)
            lit = (x - 5) * side in (0, 1) and z in (52, 53)
            is_rim = (x - 5) ** 2 + (z - 51) ** 2 > 4
            part.put("shine" if lit else "sock" if is_rim else "eye", side * x, front, z)
    for x in range(-2, 3):
        for z in range(46, 49):
            for y in range(-23, -19):
                if abs(x) + abs(z - 47) < 3 and (y > -23 or abs(x) + abs(z - 47) < 2):
                    part.put("nose", x, y, z)
    return part


def meadow():
    """A round of turf, higher in its middle."""
    part = Part()
    for x in range(-42, 47):
        for y in range(-42, 43):
            from_middle = math.hypot(x - 2, y)
            ragged = (x * 7 + y * 13 + x * y) % 5 * 0.4
            if from_middle > 41:
                continue
            top = -1
            for z in range(-9, top + 1):
                depth = top - z
                if from_middle > 41.4 - depth * depth * 0.16 - (ragged if depth > 2 else 0):
                    continue
                part.put("grass" if depth < 2 else "earth" if depth < 6 else "stone", x, y, z)
            mixed = (x * 2654435761 ^ y * 40503 * 7919) & 0xFFFFFFFF
            if mixed % 23 == 0 and from_middle < 40:
                for z in range(0, 1 + mixed // 23 % 3):
                    part.put("blade", x, y, z)
    return part


def flower(name):
    part = Part()
    part.box("blade", (0, 0), (0, 0), (0, 4))
    for x, y in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
        part.put(name, x, y, 5)
    part.put("petal" if name != "petal" else "stem", 0, 0, 6)
    return part


def mushroom():
    part = Part()
    part.disc("stem", 1.5, 0)
    for z in range(0, 6):
        part.disc("stem", 1.1, z)
    for z, radius in ((5, 4.3), (6, 4.3), (7, 3.6), (8, 2.6), (9, 1.2)):
        part.disc("cap", radius, z)
    for x, y, z in ((3, -2, 7), (-2, -3, 7), (0, 1, 9), (-3, 2, 7), (1, -2, 8), (-4, -1, 6), (1, -4, 6), (4, 1, 6)):
        if (x, y, z) in part:
            part.put("stem", x, y, z)
    return part


def main():
    scene = File(by_color=True)
    ground = meadow()
    ground.update(fox())
    scene.place(scene.model(ground))
    cap = scene.model(mushroom())
    for x, y in ((-29, -11), (-36, 0), (-25, -22)):
        scene.place(cap, (x, y, 0))
    kinds = [scene.model(flower(name)) for name in ("petals", "bloom", "petal")]
    for i, (x, y) in enumerate(((-17, -28), (20, -30), (31, -20), (-34, 6), (-26, 20), (36, 6), (24, 24), (-12, 32), (6, -35), (38, -10),
                                (-8, -33), (-36, -16), (10, 33), (29, -26))):
        scene.place(kinds[i % 3], (x, y, 0))
    scene.write(sys.argv[1])


main()
