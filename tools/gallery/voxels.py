"""What the scripts of this folder build their scenes with: colours, parts of voxels, and the .vox file."""
import gzip
import struct

FIRST = {}  # name -> the first palette index of its shades
COUNT = {}
PALETTE = []  # 0xRRGGBB
MATERIALS = {}  # palette index -> properties as a MATL chunk has them
CLEAR = set()  # palette indices that one sees through


def colors(shades, **materials):
    """Adds {name: [0xRRGGBB, ...]}. A material is a name's: glass={"_type": "_glass", ...}."""
    for name, all_of_it in shades.items():
        FIRST[name] = len(PALETTE) + 1
        COUNT[name] = len(all_of_it)
        PALETTE.extend(all_of_it)
    for name, properties in materials.items():
        for index in range(FIRST[name], FIRST[name] + COUNT[name]):
            MATERIALS[index] = properties
            if properties.get("_type") == "_glass":
                CLEAR.add(index)


def shade(name, x, y, z):
    """A palette index: one of the shades of a colour, by place."""
    mixed = (x * 73856093 ^ y * 19349663 ^ z * 83492791) & 0xFFFFFFFF
    return FIRST[name] + (mixed ^ mixed >> 13) % COUNT[name]


class Part(dict):
    """Voxels by place, before they become a model."""

    def put(self, name, x, y, z):
        self[x, y, z] = shade(name, x, y, z)

    def box(self, name, xs, ys, zs):
        for x in range(xs[0], xs[1] + 1):
            for y in range(ys[0], ys[1] + 1):
                for z in range(zs[0], zs[1] + 1):
                    self.put(name, x, y, z)

    def disc(self, name, radius, z, at=(0, 0), hole=-1.0):
        side = int(radius) + 1
        for x in range(-side, side + 1):
            for y in range(-side, side + 1):
                if hole * abs(hole) < x * x + y * y <= radius * radius:
                    self.put(name, at[0] + x, at[1] + y, z)

    def cone(self, name, radius, height, z, at=(0, 0)):
        for layer in range(height):
            self.disc(name, radius * (1 - layer / height) + 0.3, z + layer, at)

    def flag(self, name, x, y, z):
        self.box("wood", (x, x), (y, y), (z, z + 5))
        self.box(name, (x + 1, x + 4), (y, y), (z + 3, z + 5))
        del self[x + 4, y, z + 4]

    def visible(self):
        """What is left when the inside is taken out. Glass stays whole, and what stands behind it."""
        around = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
        return {(x, y, z): color for (x, y, z), color in self.items() if color in CLEAR or
                any(self.get((x + a, y + b, z + c)) in CLEAR | {None} for a, b, c in around)}


def chunk(name, content, children=b""):
    return name + struct.pack("<ii", len(content), len(children)) + content + children


def text(value):
    return struct.pack("<i", len(value)) + value.encode()


def pairs(*values):
    return struct.pack("<i", len(values)) + b"".join(text(key) + text(value) for key, value in values)


class File:
    def __init__(self, by_color=False):
        self.models = []
        self.instances = []  # model, translation, quarter turns
        # Colour by colour a file takes less room when it is compressed.
        self.order = (lambda one: (one[1], one[0][::-1])) if by_color else (lambda one: one[0][::-1])

    def model(self, part):
        """Adds a model and returns its number and middle. Sides are even, so that the middle is a corner of voxels."""
        voxels = Part(part).visible()
        low = [min(place[axis] for place in voxels) for axis in range(3)]
        high = [max(place[axis] for place in voxels) for axis in range(3)]
        size = [(high[axis] - low[axis] + 2) & ~1 for axis in range(3)]
        data = b"".join(struct.pack("4B", x - low[0], y - low[1], z - low[2], color)
                        for (x, y, z), color in sorted(voxels.items(), key=self.order))
        self.models.append(chunk(b"SIZE", struct.pack("<3i", *size)) +
                           chunk(b"XYZI", struct.pack("<i", len(voxels)) + data))
        return len(self.models) - 1, [low[axis] + size[axis] // 2 for axis in range(3)]

    def place(self, model, at=(0, 0, 0), turns=0):
        """Turned by quarters around the origin, from x to y, then moved."""
        number, (x, y, z) = model
        for _ in range(turns):
            x, y = -y, x
        self.instances.append((number, (x + at[0], y + at[1], z + at[2]), turns))

    def write(self, name):
        nodes = chunk(b"nTRN", struct.pack("<i", 0) + pairs() + struct.pack("<4i", 1, -1, 0, 1) + pairs())
        count = len(self.instances)
        nodes += chunk(b"nGRP", struct.pack("<i", 1) + pairs() + struct.pack("<i", count) +
                       b"".join(struct.pack("<i", 2 + 2 * i) for i in range(count)))
        for i, (model, at, turns) in enumerate(self.instances):
            frame = [("_t", "%d %d %d" % at)]
            # Bits 0-1 and 2-3: the column of the first and second row that is not 0; 4-6: the rows' signs.
            frame += [[], [("_r", str(1 | 0 << 2 | 1 << 4))], [("_r", str(0 | 1 << 2 | 3 << 4))],
                      [("_r", str(1 | 0 << 2 | 2 << 4))]][turns]
            nodes += chunk(b"nTRN", struct.pack("<i", 2 + 2 * i) + pairs() +
                           struct.pack("<4i", 3 + 2 * i, -1, 0, 1) + pairs(*frame))
            nodes += chunk(b"nSHP", struct.pack("<i", 3 + 2 * i) + pairs() + struct.pack("<2i", 1, model) + pairs())
        colors = b"".join(struct.pack(">I", color << 8 | 255) for color in PALETTE).ljust(1024, b"\0")
        materials = b"".join(chunk(b"MATL", struct.pack("<i", index) + pairs(*properties.items()))
                             for index, properties in sorted(MATERIALS.items()))
        main = b"".join(self.models) + nodes + chunk(b"RGBA", colors) + materials
        whole = b"VOX " + struct.pack("<i", 150) + chunk(b"MAIN", b"", main)
        with open(name, "wb") as file:
            file.write(gzip.compress(whole, 9, mtime=0) if name.endswith(".gz") else whole)
