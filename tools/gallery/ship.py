#!/usr/bin/env python3
"""Builds scenes/ship.vox.gz: ship.py OUT.vox.gz. A galleon of three masts under full sail, her lanterns lit."""
import math
import sys

from voxels import File, Part, colors

colors({
    "tar": [0x4A3222, 0x432C1E],
    "hull": [0x7A4A2A, 0x734526],
    "wale": [0x9E6A3A, 0x96632F],
    "band": [0x2F5D73, 0x2A5568],
    "gold": [0xE0B04A, 0xD6A640],
    "deck": [0xC79B63, 0xBE925B],
    "rail": [0x6B3F24],
    "mast": [0x8A5E36, 0x80562F],
    "sail": [0xF3E9D2, 0xEEE2C8, 0xF6EEDA],
    "cross": [0xB3392F, 0xAA332A],
    "rope": [0x5A4634],
    "gun": [0x2B2A2E],
    "port": [0x1E1A18],
    "pane": [0xFFD98A],
    "lantern": [0xFFE9A8],
    "red": [0xC2342C],
    "white": [0xF4F0E6],
    "crate": [0xA8763F, 0x9C6C38],
    "rock": [0x77777C, 0x6B6B70],
}, pane={"_type": "_emit", "_emit": "0.5", "_flux": "1"}, lantern={"_type": "_emit", "_emit": "1", "_flux": "2"},
    gold={"_type": "_metal", "_metal": "0.7", "_rough": "0.2", "_sp": "0.6"})

# She lies along x, her bow towards +x; the water line is z = 0.
STERN, BOW = -46, 44
MASTS = ((-24, 62), (3, 74), (28, 60))  # place, height


def sheer(x):
    """How high the hull's side rises there."""
    t = (x - STERN) / (BOW - STERN)
    castle = 10 if x < -28 else 5 if x < -12 else 0
    fore = 5 if x > 24 else 0
    return round(9 + 7 * (2 * t - 1) ** 2 + castle + fore)


def deck(x):
    return sheer(x) - 3


def half(x, z):
    """Half the hull's width there; 0 where there is none."""
    t = (x - STERN) / (BOW - STERN)
    rake = max(0, z) * 0.35
    if x > BOW + rake - max(0, -z) * 1.1 or x < STERN - max(0, z - 8) * 0.18:
        return 0
    plan = 12.5 * (1 - max(0, (t - 0.52) / (0.48 + rake / 90)) ** 2.3) if t > 0.52 else \
        12.5 * (1 - 0.32 * ((0.52 - t) / 0.52) ** 2.2)
    depth = -8
    section = math.sqrt(max(0, 1 - (min(0, z - 2) / (depth - 3)) ** 2)) if z < 2 else 1 - max(0, z - 5) * 0.016
    run = 1 if z > 3 else 1 - max(0, 0.3 - t) * (3 - z) * 0.14
    return max(0, plan * section * run)


def hull(part):
    for x in range(STERN - 6, BOW + 14):
        top = sheer(min(BOW, max(STERN, x)))
        for z in range(-8, top + 1):
            wide = half(x, z)
            if wide <= 0.4:
                continue
            for y in range(-int(wide), int(wide) + 1):
                on_deck = z > deck(min(BOW, max(STERN, x))) and abs(y) < int(wide) and \
                    half(x - 1, z) > abs(y) + 0.5 and half(x + 1, z) > abs(y) + 0.5
                is_break = z > deck(min(BOW, x + 1)) and deck(min(BOW, x + 1)) < deck(min(BOW, x)) and z <= deck(x)
                if on_deck and not is_break:
                    continue
                below = top - z
                name = "deck" if z == deck(min(BOW, max(STERN, x))) and abs(y) < int(wide) else \
                    "tar" if z < 0 else "rail" if below == 0 else "gold" if below == 2 else "band" if below < 6 and x < -10 else \
                    "wale" if z in (3, 8) else "hull"
                part.put(name, x, y, z)
    # Gun ports, their lids up, and guns.
    for x in range(-20, 26, 8):
        for side in (-1, 1):
            y = side * int(half(x, 5))
            for dx in range(0, 3):
                for z in range(5, 7):
                    part.put("port", x + dx, side * int(half(x + dx, z)), z)
                part.put("wale", x + dx, side * (int(half(x + dx, 7)) + 1), 7)
            for out in range(0, 3):
                part.put("gun", x + 1, y + side * out, 5)
    # The beak, its figurehead, and the bowsprit.
    for i in range(16):
        for y in (-1, 0, 1):
            if i < 13 or y == 0:
                for z in range(9 + i // 3, 12 + i // 2):
                    part.put("gold" if i > 12 or z == 11 + i // 2 else "hull", BOW - 1 + i, y, z)
    for i in range(30):
        part.box("mast", (BOW - 6 + i, BOW - 6 + i), (0, 0), (19 + i * 5 // 8, 20 + i * 5 // 8))


def stern(part):
    """Windows across the stern, a gallery of gold, and three lanterns."""
    for z in range(9, 24):
        back = min((x for x in range(STERN - 8, STERN + 6) if half(x, z) > 3), default=STERN)
        wide = int(half(back, z)) - 1
        for y in range(-wide, wide + 1):
            part.put("band", back - 1, y, z)
            if z in (9, 15, 22):
                part.put("gold", back - 2, y, z)
            elif (10 <= z <= 13 or 17 <= z <= 20) and (y + 30) % 4 in (1, 2):
                part.put("pane", back - 1, y, z)
        for side in (-1, 1):
            for x in range(back + 2, back + 13, 4):
                if 17 <= z <= 19:
                    for dx in (0, 1):
                        part.put("pane", x + dx, side * int(half(x + dx, z)), z)
    back = STERN - 4
    top = sheer(STERN)
    for y, high in ((-7, 2), (0, 5), (7, 2)):
        part.box("gold", (back, back), (y, y), (top, top + high))
        part.box("lantern", (back - 1, back + 1), (y - 1, y + 1), (top + high + 1, top + high + 3))
        part.box("gold", (back, back), (y, y), (top + high + 4, top + high + 4))


def sail(part, x, low, high, wide_low, wide_high, deep, emblem=False):
    """A square sail that the wind has filled, hung from a yard."""
    part.box("mast", (x, x), (-wide_high - 2, wide_high + 2), (high + 1, high + 1))
    for z in range(low, high + 1):
        share = (z - low) / (high - low)
        wide = wide_low + (wide_high - wide_low) * share
        for y in range(-int(wide), int(wide) + 1):
            across = y / (wide + 1)
            foot = low + 2.5 * (1 - across * across) ** 0.8
            if z < foot - 0.5:
                continue
            belly = deep * (1 - across ** 2 * 0.55) * math.sin(math.pi * (0.12 + 0.88 * (1 - share)) * 0.94) ** 0.8
            front = x + 1 + round(belly)
            middle = (low + high) / 2 + 0.5
            arm = emblem and (abs(y) <= 1 and abs(z - middle) <= 7 or abs(z - middle) <= 1 and abs(y) <= 7 or
                              abs(abs(y) - 7) < 1 and abs(z - middle) <= 2.4 or abs(abs(z - middle) - 7) < 1 and abs(y) <= 2)
            seam = (y + 50) % 7 == 0
            name = "cross" if arm else "sail"
            part.put(name, front, y, z)
            if seam and not arm:
                part[front, y, z] = part[front, y, z] - part[front, y, z] + SEAM
            before = x + 1 + round(deep * (1 - across ** 2 * 0.55) * math.sin(math.pi * (0.12 + 0.88 * (1 - min(1, share + 1 / (high - low)))) * 0.94) ** 0.8)
            for between in range(min(front, before), max(front, before)):
                part.put(name, between, y, z)


def line(part, name, a, b):
    steps = max(abs(q - p) for p, q in zip(a, b))
    for i in range(steps + 1):
        place = tuple(round(p + (q - p) * i / steps) for p, q in zip(a, b))
        if place not in part:
            part.put(name, *place)


def rigging(part):
    for number, (x, high) in enumerate(MASTS):
        base = deck(x)
        for z in range(base, high + 1):
            part.disc("mast", 1.6 if z < base + 22 else 1.1 if z < high - 14 else 0.4, z, (x, 0))
        # The top.
        part.disc("rail", 4.2, base + 31, (x, 0))
        part.disc("rail", 4.6, base + 32, (x, 0), 3.4)
        # A flag at the truck, and shrouds with their rungs.
        for i in range(12):
            wave = round(1.3 * math.sin(i * 0.8))
            part.box(("red", "white", "red")[number] if i % 2 or number != 1 else "red", (x + 1 + i, x + 1 + i), (wave, wave),
                     (high - 2 + i // 5, high + 2 - i // 5))
        for side in (-1, 1):
            rail = int(half(x, sheer(x)))
            for foot in (-5, -2, 1):
                line(part, "rope", (x + foot - 3, side * rail, sheer(x)), (x - 1, side * 2, base + 30))
            for z in range(sheer(x) + 3, base + 28, 3):
                share = (z - sheer(x)) / (base + 30 - sheer(x))
                y = round(rail + (2 - rail) * share)
                line(part, "rope", (round(x - 8 + 7 * share), side * y, z), (round(x - 2 + share), side * y, z))
    tip = (BOW + 22, 0, 37)
    line(part, "rope", tip, (28, 0, 58))
    line(part, "rope", tip, (28, 0, 45))
    line(part, "rope", (28, 0, 58), (3, 0, 72))
    line(part, "rope", (3, 0, 70), (-24, 0, 58))


def sails(part):
    for (x, high), scale in zip(MASTS, (0.84, 1.0, 0.9)):
        base = deck(x)
        sail(part, x, base + 6, base + 25, int(21 * scale), int(18 * scale), 6 * scale, x == 3)
        sail(part, x, base + 28, base + 42, int(18 * scale), int(13 * scale), 5 * scale)
        if high - 4 > base + 52:
            sail(part, x, base + 45, base + 53, int(12 * scale), int(9 * scale), 3 * scale)
    # A jib between foremast and bowsprit.
    for z in range(26, 52):
        left = 31 + (z - 26) * 0.06
        right = 60 - (z - 26) * 1.08
        for x in range(round(left), round(right)):
            part.put("sail", x, round(2.2 * math.sin((x - left) / max(1, right - left) * math.pi)), z)


def fittings(part):
    base = deck(-2)
    for x, y in ((-6, -5), (-6, 4), (12, 4), (16, -6)):
        part.box("crate", (x, x + 3), (y, y + 3), (base + 1, base + 4))
        part.box("rail", (x, x + 3), (y + 1, y + 1), (base + 4, base + 4))
    part.box("rail", (7, 12), (-3, 3), (base + 1, base + 1))  # a hatch
    part.box("port", (8, 11), (-2, 2), (base + 1, base + 1))
    # A boat amidships, and the wheel.
    for x in range(-4, 11):
        wide = 2.6 * (1 - ((x - 3) / 8) ** 2) ** 0.5
        for y in range(-3, 4):
            if abs(y) <= wide:
                part.put("white" if abs(y) >= wide - 1 else "hull", x - 4, y, base + 3)
                if abs(y) >= wide - 1:
                    part.put("white", x - 4, y, base + 4)
    top = deck(-32)
    for a in range(-3, 4):
        for b in range(-3, 4):
            if 5 <= a * a + b * b <= 10 or a * b == 0:
                part.put("wale", -32, a, top + 4 + b)
    # Doors under the quarterdeck.
    for y in (-4, 3):
        part.box("rail", (-11, -11), (y, y + 1), (base + 1, base + 4))


def main():
    part = Part()
    hull(part)
    stern(part)
    fittings(part)
    rigging(part)
    sails(part)
    ship = File(by_color=True)
    ship.place(ship.model(part))
    ship.write(sys.argv[1])


SEAM = 0
if __name__ == "__main__":
    from voxels import FIRST
    SEAM = FIRST["sail"] + 1
    main()
