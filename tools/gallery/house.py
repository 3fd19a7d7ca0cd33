#!/usr/bin/env python3
"""Builds scenes/house.vox.gz: house.py OUT.vox.gz. A house cut open at its front: four rooms, a lamp in each of two."""
import sys

import voxels
from voxels import COUNT, FIRST, File, colors

colors({
    "plaster": [0xE8DCC4, 0xE4D7BD],
    "brick": [0xA8553F, 0x9C4C38, 0xB25D46],
    "beam": [0x5E4029, 0x553923],
    "floor": [0x9A6A3E, 0x8F6138, 0xA37244],
    "stone": [0x8D8A86, 0x7F7C79, 0x999692],
    "roof": [0x3E5A73, 0x37516A, 0x46637D],
    "grass": [0x5F8F3B, 0x699A43, 0x578535],
    "earth": [0x7A5A3C, 0x6F5135],
    "path": [0xC2B59B, 0xB5A88E],
    "green": [0x4F7F5B, 0x477553],
    "red": [0xA93B3B, 0x9E3535],
    "cream": [0xF2E8D2],
    "blue": [0x4A6FA5, 0x42659A],
    "white": [0xF4F1EA],
    "iron": [0x3A3A40, 0x333338],
    "book": [0x8C3A3A, 0x3A5F8C, 0xC08A3A, 0x4F7A4A, 0x6A4A7C],
    "leaf": [0x4E8C46, 0x5A9A50, 0x437D3D],
    "pot": [0xB9683F],
    "gold": [0xD9A441],
    "ember": [0xFF7A2A],
    "lamp": [0xFFE2A8],
    "pane": [0xBFE0EA],
    "wallpaper": [0xB7C7B0, 0xAFC0A8],
    "rose": [0xD8A7A0, 0xD29F98],
},
    lamp={"_type": "_emit", "_emit": "0.9", "_flux": "2"},
    ember={"_type": "_emit", "_emit": "0.8", "_flux": "1"},
    pane={"_type": "_glass", "_trans": "0.8", "_ri": "1.3", "_ior": "0.3"})


class Part(voxels.Part):
    """Planks, courses of brick and slates in place of shades by chance."""

    def put(self, name, x, y, z):
        if name in ("floor", "roof", "brick", "book"):
            course = (x - 1) // 4 + y // 13 * 2 if name == "floor" else y // 4 * 2 + z // 2 if name == "roof" else \
                (x // 4 + y // 4 if z // 2 % 2 else (x + 2) // 4 + (y + 2) // 4) + z // 2
            self[x, y, z] = FIRST[name] + course % COUNT[name]
        elif name in ("plaster", "wallpaper", "rose", "earth", "beam"):
            self[x, y, z] = FIRST[name] + (x // 3 % 2 if name == "wallpaper" else 0)
        else:
            super().put(name, x, y, z)


# The front is towards -y. Inside: x 0 to 71, y 0 to 43; two floors of 30 with 3 between them.
LOW, HIGH, SPLIT = 0, 33, 36


def shell():
    part = Part()
    part.box("stone", (-3, 74), (-6, 46), (-5, -2))
    part.box("floor", (0, 71), (-3, 43), (-1, -1))
    part.box("floor", (0, 71), (-3, 43), (HIGH - 3, HIGH - 1))
    part.box("beam", (0, 71), (-3, -3), (HIGH - 3, HIGH - 2))
    part.box("beam", (0, 71), (-3, -3), (-1, -1))
    for x in (-3, 72):  # side walls of brick, papered inside
        part.box("brick", (x, x + 2), (-3, 46), (-1, 62))
    part.box("brick", (-3, 74), (44, 46), (-1, 62))
    for level, papers in ((LOW, ("plaster", "wallpaper")), (HIGH, ("rose", "plaster"))):
        part.box(papers[0], (0, SPLIT - 2), (43, 43), (level, level + 29))
        part.box(papers[1], (SPLIT + 1, 71), (43, 43), (level, level + 29))
        part.box(papers[0], (0, 0), (-3, 43), (level, level + 29))
        part.box(papers[1], (71, 71), (-3, 43), (level, level + 29))
        part.box("cream", (0, 71), (42, 42), (level, level + 1))
        part.box("beam", (SPLIT - 1, SPLIT), (-3, 43), (level, level + 29))
        for y in range(14, 27):  # a way through
            for z in range(level, level + 21):
                for x in (SPLIT - 1, SPLIT):
                    part.pop((x, y, z), None)
    for x in range(4, 72, 9):
        part.box("beam", (x, x + 1), (-2, 42), (HIGH - 4, HIGH - 4))
    # Windows in the back wall and the sides.
    for x, z in ((12, 10), (50, 10), (12, 43), (50, 43)):
        window(part, (x, x + 11), (43, 46), (z, z + 13), 0)
    for z in (10, 43):
        window(part, (-3, 0), (16, 25), (z, z + 13), 1)
        window(part, (71, 74), (16, 25), (z, z + 13), 1)
    # The roof: its front is cut off, and one sees the attic's gable.
    for row in range(29):
        for x in range(-6 + row * 39 // 26, -3 + row * 39 // 26):
            for along in (x, 71 - x):
                if x <= 36:
                    part.box("roof", (along, along), (-5, 48), (61 + row, 61 + row))
    part.box("beam", (34, 37), (-6, 48), (89, 89))
    for row in range(26):
        left, right = -3 + row * 39 // 26, 74 - row * 39 // 26
        if left <= right:
            part.box("brick", (left, right), (44, 46), (62 + row, 62 + row))
    part.box("floor", (0, 71), (-3, 43), (62, 63))
    part.box("beam", (0, 71), (-4, -4), (62, 63))
    for x in (11, 12, 59, 60):
        part.box("beam", (x, x), (-2, 43), (64, 68))
    window(part, (30, 41), (43, 46), (68, 78), 0)
    # A chimney.
    part.box("brick", (56, 63), (30, 38), (64, 98))
    part.box("stone", (55, 64), (29, 39), (97, 99))
    part.box("iron", (58, 61), (32, 36), (99, 99))
    return part


def window(part, xs, ys, zs, axis):
    for x in range(xs[0], xs[1] + 1):
        for y in range(ys[0], ys[1] + 1):
            for z in range(zs[0], zs[1] + 1):
                part.pop((x, y, z), None)
    along = (xs, ys)[axis]
    deep = (ys, xs)[axis]
    middle = (deep[0] + deep[1] + 1) // 2
    for a in range(along[0], along[1] + 1):
        for z in range(zs[0], zs[1] + 1):
            edge = a in along or z in zs or z == (zs[0] + zs[1]) // 2 or a in ((along[0] + along[1]) // 2,)
            place = (a, middle, z) if axis == 0 else (middle, a, z)
            part.put("white" if edge else "pane", *place)
    # A sill.
    low = along[0] - 1, along[1] + 1
    out = deep[1] + 1 if deep[1] > 40 and (axis == 0 or deep[1] > 60) else deep[0] - 1
    inner = deep[0] - 1 if out > deep[1] else deep[1] + 1
    for d in (out, inner):
        for a in range(low[0], low[1] + 1):
            part.put("white", *((a, d, zs[0] - 1) if axis == 0 else (d, a, zs[0] - 1)))


def lamp(part, x, y, z, ceiling):
    """A shade of light that hangs."""
    part.box("iron", (x, x), (y, y), (z + 3, ceiling))
    for layer, radius in ((0, 3.4), (1, 3.0), (2, 2.2), (3, 1.2)):
        part.disc("gold" if layer == 3 else "lamp", radius, z + layer, (x, y))


def living_room(part):
    part.box("red", (6, 30), (6, 30), (0, 0))
    part.box("cream", (8, 28), (8, 28), (0, 0))
    part.box("red", (9, 27), (9, 27), (0, 0))
    # A sofa along the back wall.
    part.box("green", (7, 27), (33, 41), (2, 5))
    part.box("green", (7, 27), (39, 41), (6, 11))
    for x in (5, 28):
        part.box("green", (x, x + 1), (33, 41), (1, 8))
    part.box("gold", (9, 13), (37, 38), (6, 9))
    part.box("cream", (22, 25), (37, 38), (6, 9))
    # A low table with a cup and a book.
    part.box("floor", (11, 22), (17, 23), (6, 6))
    for x in (11, 22):
        for y in (17, 23):
            part.box("beam", (x, x), (y, y), (1, 5))
    part.box("white", (13, 14), (19, 20), (7, 8))
    part.box("book", (18, 20), (19, 21), (7, 7))
    # Books from floor to ceiling in the corner, and a picture.
    shelf(part, 1, 3, (0, 14), 0)
    part.box("gold", (28, 34), (42, 42), (14, 21))
    part.box("blue", (29, 33), (42, 42), (15, 20))
    part.box("leaf", (29, 33), (42, 42), (15, 16))
    part.put("cream", 31, 42, 18)
    lamp(part, 17, 18, 20, HIGH - 4)


def shelf(part, x0, x1, ys, z0):
    for level in range(4):
        z = z0 + level * 6
        part.box("beam", (x0, x1), ys, (z, z))
        for y in range(ys[0] + 1, ys[1]):
            high = 3 + (y * 7 + level * 5) % 3
            if (y + level * 3) % 6:
                color = "book"
                for zz in range(z + 1, z + 1 + high):
                    for x in range(x0, x1):
                        part[x, y, zz] = BOOKS[(y * 5 + level * 3) % len(BOOKS)]
    part.box("beam", (x0, x1), ys, (z0 + 24, z0 + 24))
    for y in ys:
        part.box("beam", (x0, x1), (y, y), (z0, z0 + 24))


def kitchen(part):
    # A hearth with embers and a chimney breast.
    part.box("brick", (53, 67), (36, 43), (0, 29))
    for x in range(56, 65):
        for y in range(36, 41):
            for z in range(1, 10 - max(0, abs(x - 60) - 2)):
                part.pop((x, y, z), None)
    part.box("stone", (51, 69), (35, 35), (13, 14))
    part.box("stone", (52, 68), (33, 35), (0, 0))
    part.box("beam", (57, 63), (37, 39), (1, 1))
    part.box("ember", (58, 62), (38, 39), (2, 2))
    part.box("ember", (59, 61), (38, 38), (3, 4))
    part.put("ember", 60, 38, 5)
    part.box("gold", (55, 56), (35, 35), (15, 18))
    part.box("blue", (64, 66), (35, 35), (15, 17))
    # A counter along the wall on the right.
    part.box("blue", (64, 70), (2, 26), (0, 8))
    part.box("cream", (63, 70), (2, 26), (9, 9))
    for y in (7, 13, 19):
        part.box("white", (63, 63), (y, y), (3, 6))
    part.box("iron", (65, 69), (4, 9), (10, 10))
    part.box("gold", (66, 68), (5, 8), (11, 13))
    part.box("pot", (66, 67), (22, 23), (10, 11))
    part.box("leaf", (65, 68), (21, 24), (12, 14))
    # A round table with stools and a bowl.
    part.disc("floor", 6.5, 8, (48, 17))
    part.box("beam", (47, 48), (16, 17), (0, 7))
    part.disc("beam", 2.6, 0, (48, 17))
    part.disc("white", 2.3, 9, (48, 17))
    part.box("red", (47, 48), (17, 18), (10, 10))
    part.box("leaf", (49, 49), (16, 16), (10, 10))
    for x, y in ((39, 14), (56, 19), (47, 27)):
        part.disc("red", 2.6, 5, (x, y))
        part.disc("beam", 1.2, 0, (x, y))
        part.box("beam", (x, x), (y, y), (1, 4))


def bedroom(part):
    z = HIGH
    part.box("beam", (5, 21), (14, 41), (z, z + 3))
    part.box("white", (6, 20), (15, 40), (z + 4, z + 6))
    part.box("blue", (5, 21), (14, 31), (z + 6, z + 7))
    part.box("cream", (5, 21), (29, 31), (z + 7, z + 7))
    part.box("white", (8, 18), (35, 39), (z + 7, z + 8))
    part.box("beam", (4, 22), (41, 42), (z, z + 13))
    part.box("beam", (4, 22), (13, 13), (z, z + 7))
    # A bedside table with a lamp of its own, unlit, and a rug.
    part.box("floor", (24, 29), (37, 42), (z, z + 6))
    part.box("gold", (26, 27), (39, 40), (z + 7, z + 9))
    part.box("cream", (25, 28), (38, 41), (z + 10, z + 12))
    part.box("rose", (23, 33), (14, 30), (z, z))
    part.box("cream", (24, 32), (15, 29), (z, z))
    part.box("rose", (25, 31), (16, 28), (z, z))
    # A chest.
    part.box("floor", (5, 20), (3, 9), (z, z + 5))
    part.box("beam", (5, 20), (3, 9), (z + 6, z + 6))
    part.box("gold", (12, 13), (2, 2), (z + 3, z + 5))


def study(part):
    z = HIGH
    shelf(part, 68, 70, (28, 42), z)
    # A desk under the window, a chair, a globe.
    part.box("floor", (46, 64), (34, 41), (z + 10, z + 10))
    part.box("beam", (46, 50), (34, 41), (z, z + 9))
    part.box("beam", (63, 64), (34, 41), (z, z + 9))
    part.box("cream", (53, 57), (35, 38), (z + 11, z + 11))
    part.box("book", (60, 62), (37, 40), (z + 11, z + 13))
    part.disc("blue", 1.5, z + 12, (48, 38))
    part.disc("blue", 2.3, z + 13, (48, 38))
    part.disc("leaf", 2.3, z + 14, (48, 38))
    part.disc("blue", 1.5, z + 15, (48, 38))
    part.box("gold", (48, 48), (38, 38), (z + 11, z + 11))
    part.box("red", (53, 58), (26, 31), (z + 6, z + 6))
    part.box("red", (53, 58), (25, 25), (z + 7, z + 13))
    for x in (53, 58):
        for y in (25, 31):
            part.box("beam", (x, x), (y, y), (z, z + 5))
    # A plant in the corner and a carpet.
    part.disc("blue", 11.4, z, (54, 15))
    part.disc("cream", 9.4, z, (54, 15))
    part.disc("blue", 8.4, z, (54, 15))
    part.box("pot", (40, 43), (36, 39), (z, z + 4))
    for dz, radius in ((7, 1.2), (8, 2.8), (9, 3.4), (10, 3.2), (11, 3.6), (12, 3.0), (13, 2.2), (14, 1.0)):
        part.disc("leaf", radius, z + dz, (41, 37))
    part.box("beam", (41, 41), (37, 37), (z + 5, z + 8))
    lamp(part, 53, 16, z + 20, 61)


def attic(part):
    for x, y, size in ((16, 34, 7), (24, 37, 5), (17, 35, 5), (46, 36, 6)):
        z = 71 if (x, y) == (17, 35) else 64
        part.box("floor", (x, x + size), (y, y + size - 1), (z, z + size - 1))
        part.box("beam", (x, x + size), (y + size // 2, y + size // 2), (z + size - 1, z + size - 1))


def garden():
    part = Part()
    for x in range(-18, 90):
        for y in range(-27, 60):
            corner = max(0, abs(x - 35.5) - 44) ** 2 + max(0, abs(y - 16) - 33) ** 2
            if corner > 90:
                continue
            is_path = 50 <= x <= 58 and y < -4
            for z in range(-9, -4):
                inside = -3 <= x <= 74 and -6 <= y <= 46 and z > -6
                if not inside and (z == -5 or corner > 40) and corner <= 96 - (z + 9) * 2 + 2 * (z + 9):
                    name = "earth" if z < -6 else "grass"  # the bottom is left open
                    part.put("path" if is_path and z == -5 and (x * 3 + y * 5) % 11 else name, x, y, z)
            mixed = (x * 2654435761 ^ y * 40503 * 7919) & 0xFFFFFFFF
            if mixed % 31 == 0 and not is_path and not (-5 <= x <= 76 and -8 <= y <= 48):
                part.put("leaf", x, y, -4)
    return part


def bush(part, x, y, size):
    for layer in range(size + 2):
        part.disc("leaf", (size ** 2 - (layer - size / 3) ** 2) ** 0.5 if abs(layer - size / 3) < size else 0, -4 + layer, (x, y))


def tree(part, x, y):
    part.box("beam", (x, x + 1), (y, y + 1), (-4, 12))
    for layer in range(20):
        high = layer / 19 * 2 - 1
        part.disc("leaf", 9.5 * max(0, 1 - high * high) ** 0.5 * (1 - 0.25 * high), 8 + layer, (x, y))


def main():
    BOOKS.extend(range(FIRST["book"], FIRST["book"] + COUNT["book"]))
    part = garden()
    for x, y, size in ((-9, -8, 5), (-11, 4, 4), (82, -12, 5), (81, 2, 4), (66, -17, 3), (2, -17, 4), (84, 40, 5), (34, -20, 3)):
        bush(part, x, y, size)
    tree(part, -10, 34)
    part.update(shell())
    for furnish in (living_room, kitchen, bedroom, study, attic):
        furnish(part)
    scene = File(by_color=True)
    scene.place(scene.model(part))
    scene.write(sys.argv[1])


BOOKS = []
main()
