"""Thimble traces voxels exactly: the `thimble` command's readers, renderer and instruments on NumPy's arrays.

    import thimble
    scene = thimble.open("castle.vox", depth=8)
    hits = scene.trace(origins, directions)              # hits.hit, hits.voxel, hits.distance, ...
    picture = scene.render(800, 600, eye=(-40, -90, 80)) # uint8, 600 x 800 x 3

World axes are right-handed, z up. A voxel is the half-open unit box [i, i+1) x [j, j+1) x [k, k+1); lengths are in
voxels, a world is 2**depth of them a side. Pictures have row 0 on top.

Keywords that are not listed are options of the command, with `_` for `-`: what `thimble render --size 800x600 --turn 30
--background none` draws is `scene.render(800, 600, turn=30, background="none")`; a flag is `True`, a list of numbers a
tuple. A file or an option that cannot be used is `thimble.Error`, a ValueError whose sentence says why; an array of
another type or shape than a function takes is a TypeError or a ValueError that names what it takes.

Whatever takes long (opening, tracing, drawing, baking, measuring, stepping) runs without Python's lock. A scene does not
change, so several threads may use one; of the other classes one thread may use an object at a time. Ctrl-C is answered when
such a call ends.
"""

import io as _io
import json as _json
import os as _os
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as _np

from . import _thimble
from ._thimble import Error

__all__ = ["BitField", "Balls", "Error", "Hits", "Octree", "Particles", "Scene", "Voxels", "from_points", "from_voxels",
           "open"]
__version__ = _thimble.__version__

_THREADS = min(len(_os.sched_getaffinity(0)), 64)


def _threads(given: Optional[int]) -> int:
    if given is not None and not 1 <= given <= 256:
        raise ValueError(f"threads must be 1 to 256, not {given}")
    return _THREADS if given is None else given


def _side(pixels: Any) -> int:
    """A side of a picture; what no 32 bits hold is as far out of range as what they just hold, and refused as that."""
    return max(-2**31, min(int(pixels), 2**31 - 1))


def _words(options: Dict[str, Any]) -> List[bytes]:
    """Keywords as the words of the command line, in the bytes of the system's paths."""
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if isinstance(value, _np.bool_):
            value = bool(value)
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
            continue
        if isinstance(value, (tuple, list, _np.ndarray)):
            value = ",".join(str(item) for item in _np.asarray(value).reshape(-1).tolist())
        # In one word the value is not taken for the scene where the option takes none.
        words += [f"{option}={value}"] if str(value) else [option, ""]
    return [_os.fsencode(word) for word in words]


def _numbers(name: str, given: Any, what: str) -> _np.ndarray:
    """`given` as an array of numbers; no object, text or complex one."""
    array = _np.asarray(given)
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name} must be {what}; its type is {array.dtype}")
    return array


def _triples(name: str, given: Any) -> _np.ndarray:
    what = "numbers of shape (..., 3)"
    array = _numbers(name, given, what)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name} must be {what}; its shape is {array.shape}")
    return array


def _bytes(name: str, given: Any) -> _np.ndarray:
    array = _numbers(name, given, "integers of 0 to 255")
    if array.size and (array.dtype.kind == "f" or array.min() < 0 or array.max() > 255):
        raise ValueError(f"{name} must be integers of 0 to 255; its type is {array.dtype}, from {array.min()} to "
                         f"{array.max()}")
    return _np.ascontiguousarray(array, _np.uint8)


class Hits(NamedTuple):
    """What rays hit first; rays of shape (..., 3) give arrays of shape (...) and (..., 3).

    hit       bool (...)
    voxel     int32 (..., 3): its lowest corner
    t         float64 (...): origin + t * direction, both as quantised (`Scene.trace`), is where it is entered
    distance  float64 (...): from the origin, in voxels
    axis      int8 (...): of the face entered, 0 to 2; -1 where a ray starts inside
    material  int16 (...): row of `Scene.palette`
    color     uint8 (..., 3): red, green, blue

    A miss has voxel, axis and material -1, t and distance inf, and colour 0.
    """

    hit: _np.ndarray
    voxel: _np.ndarray
    t: _np.ndarray
    distance: _np.ndarray
    axis: _np.ndarray
    material: _np.ndarray
    color: _np.ndarray


class Voxels(NamedTuple):
    """N solid voxels, in the order of the tree.

    position  int32 (N, 3)
    material  uint8 (N,): row of `Scene.palette`
    color     uint8 (N, 3): red, green, blue
    """

    position: _np.ndarray
    material: _np.ndarray
    color: _np.ndarray


class Scene:
    """A scene: voxels with a palette, and how they are to be looked at. Made by `open`, `from_voxels`, `from_points`."""

    def __init__(self, built: "_thimble.Scene"):
        self._built = built

    @property
    def depth(self) -> int:
        """The world is 2**depth voxels a side."""
        return self._built.level()

    @property
    def bounds(self) -> Tuple[Tuple[int, int, int], Tuple[int, int, int]]:
        """The lowest voxel of the box around all that is solid, and one past its highest."""
        return self._built.bounds()

    @property
    def palette(self) -> _np.ndarray:
        """The colours of the materials: uint8, 256 x 3."""
        return self._built.palette()

    @property
    def has_colors(self) -> bool:
        """Whether the file says colours."""
        return self._built.has_colors()

    @property
    def notes(self) -> List[str]:
        """What the file's reader left out or had to decide, a sentence each."""
        return self._built.notes()

    @property
    def tree_bytes(self) -> int:
        """Bytes of the compact tree that is traced."""
        return self._built.tree_bytes()

    def __len__(self) -> int:
        """Solid voxels."""
        return self._built.voxel_count()

    def __repr__(self) -> str:
        voxels = f"{len(self)} voxel" + "s" * (len(self) != 1)
        return f"<thimble.Scene: {self._built.kind()}, depth {self.depth}, {voxels} in {self.tree_bytes} bytes>"

    def _repr_png_(self) -> bytes:
        return self.png(480, 360)

    def trace(self, origins: Any, directions: Any, *, threads: Optional[int] = None) -> Hits:
        """What rays hit first, exactly.

        origins, directions: numbers of shape (..., 3), in voxels; one of shape (3,) stands for all rays. An origin is
        taken to the nearest 1/256 voxel, -4 to 5 world sizes from 0. A direction has any length above 0: whole numbers
        up to 1,048,575 are taken as they are, others scaled so that the largest is that, and rounded.
        threads: 1 to 256; as many as there are processors unless said.

        Errors: ValueError names the first ray that is none.
        """
        from_, along = _triples("origins", origins), _triples("directions", directions)
        try:
            shape = _np.broadcast_shapes(from_.shape, along.shape)
        except ValueError:
            raise ValueError("origins and directions must be as many, or one for all; their shapes are "
                             f"{from_.shape} and {along.shape}") from None
        rows = [_np.ascontiguousarray(_np.broadcast_to(array, shape), _np.float64).reshape(-1, 3)
                for array in (from_, along)]
        hits = self._built.trace(rows[0], rows[1], _threads(threads))
        return Hits(*(array.reshape(shape[:-1] + array.shape[1:]) for array in hits))

    def render(self, width: int = 800, height: int = 600, **options: Any) -> _np.ndarray:
        """The picture that `thimble render SCENE --size WIDTHxHEIGHT` writes: uint8, height x width x 3.

        With background="none" it has a fourth channel, how much is covered. Among the options are view="front", turn,
        tilt, eye=(x, y, z), target, up, fov, projection="orthographic", span, shade="depth" | "normal" | "color" |
        "mono" | "ink", effects="none" | "shadows,sky", samples, background, ground, engine and threads;
        `thimble render --help` has all.
        """
        return self._built.render(_side(width), _side(height), _words(options))

    def png(self, width: int = 800, height: int = 600, **options: Any) -> bytes:
        """The same as the bytes of a PNG."""
        return self._built.render_png(_side(width), _side(height), _words(options))

    def depth_image(self, width: int = 800, height: int = 600, *, threads: Optional[int] = None,
                    **options: Any) -> _np.ndarray:
        """How far each pixel's centre sees: float32, height x width, in voxels along the unit ray; inf for a miss.

        The camera is that of `render` with the same options.
        """
        return self._built.depth_image(_side(width), _side(height), _words(options), _threads(threads))

    def voxels(self) -> Voxels:
        """All that is solid, as arrays."""
        position, material = self._built.voxels()
        return Voxels(position, material, self.palette[material])

    def memory(self, frames: int = 0) -> List[Dict[str, Any]]:
        """What the scene takes at every depth: a dict each, with the names of `thimble memory --csv`.

        Among them are dense_bytes, pool_bytes, compact_bytes and dag_bytes, each with ..._build_bytes and ..._boards.
        frames: drawn to measure times; 0 measures none.
        """
        return [row for row in _json.loads(self._built.memory(int(frames))) if row["row"] == "depth"]

    def bake(self, **options: Any) -> bytes:
        """The bytes of `thimble bake`, for the flash of a board: board="pico", memory="64K", coarsen=True, effects, ...

        Errors: Error says what would fit instead.
        """
        return self._built.bake(_words(options))

    def write(self, path: Union[str, "_os.PathLike[str]"]) -> None:
        """Writes the voxels as .vox, .npy, .ply or .csv, by the path's ending."""
        self._built.write(_os.fsencode(path))


def open(scene: Union[str, "_os.PathLike[str]", bytes], *, name: str = "", **options: Any) -> Scene:
    """Opens a scene: a file, a generator ("points:100000", "spheres"), or one that comes along ("castle").

    scene: a path; or the file's bytes, not packed, whose `name` then says by its ending what they are where they do not
    begin so.
    options: those of `thimble info`: depth, as_voxels, z_up, frame, fit, clip=(x, y, z, x, y, z), ...
    """
    if isinstance(scene, (bytes, bytearray, memoryview)):
        return Scene(_thimble.Scene(bytes(scene), _os.fsencode(name), _words(options)))
    return Scene(_thimble.Scene(_os.fsencode(scene), _words(options)))


def _of_array(array: _np.ndarray, options: Dict[str, Any]) -> Scene:
    """An array as the reader of .npy takes it."""
    file = _io.BytesIO()
    _np.save(file, array, allow_pickle=False)
    return Scene(_thimble.Scene(file.getvalue(), b"array.npy", _words(options)))


def from_voxels(array: Any, **options: Any) -> Scene:
    """A scene of an array of voxels; index i, j, k is the voxel [i, i+1) x [j, j+1) x [k, k+1).

    array: X x Y x Z numbers, solid where they are not 0 (floats: 0.5 and more); or uint8 of X x Y x Z x 3 (colours, black
    is empty) or X x Y x Z x 4 (empty where the fourth is 0). Sides are 1 to 4096.
    options: depth, where the world is to be larger than the least.
    """
    what = "numbers of shape (X, Y, Z), or uint8 of shape (X, Y, Z, 3) or (X, Y, Z, 4)"
    voxels = _numbers("array", array, what)
    if voxels.ndim == 4 and voxels.dtype != _np.uint8:
        raise TypeError(f"array must be {what}; its type is {voxels.dtype}")
    if voxels.ndim != 3 and not (voxels.ndim == 4 and voxels.shape[3] in (3, 4)):
        raise ValueError(f"array must be {what}; its shape is {voxels.shape}")
    return _of_array(voxels, options)


def from_points(array: Any, **options: Any) -> Scene:
    """A scene of points, fitted to the world; those that are not finite are left out.

    array: numbers of shape (N, 3): x, y, z; or (N, 6): and red, green, blue, 0 to 1 or 0 to 255.
    options: depth (default 9), as_voxels=True where they are indices of voxels, fit, clip, colors.
    """
    what = "numbers of shape (N, 3), or (N, 6) with colours"
    points = _numbers("array", array, what)
    if points.ndim != 2 or points.shape[1] not in (3, 6):
        raise ValueError(f"array must be {what}; its shape is {points.shape}")
    colors = points[:, 3:]
    is_color = ((colors >= 0) & (colors <= 255)).all(axis=1)
    if not is_color.all():
        row = int(is_color.argmin())
        raise ValueError(f"colours must be 0 to 1 or 0 to 255; row {row} has {colors[row].tolist()}")
    return _of_array(points, {**options, "as_points": True})


class Octree:
    """The tree that changes: voxels inserted and removed within a pool of nodes of 8 bytes, which never grows.

    depth: the world is 2**depth voxels a side, 1 to 12. nodes: of the pool.
    Out of room is a MemoryError, a place outside the world a ValueError; the tree is then as it was.
    """

    def __init__(self, depth: int, nodes: int = 1 << 20):
        self._tree = _thimble.Octree(depth, nodes)

    def insert(self, x: int, y: int, z: int, material: int = 0) -> None:
        """Makes a voxel solid."""
        self._tree.insert(x, y, z, material)

    def insert_all(self, positions: Any, materials: Any = 0) -> int:
        """Makes voxels solid, best in Morton order, and says how many.

        positions: integers of shape (N, 3). materials: integers 0 to 255, one or of shape (N,). Those before one that
        fails stay.
        """
        rows = _triples("positions", positions)
        if rows.dtype.kind == "f" or rows.ndim != 2:
            raise TypeError(f"positions must be integers of shape (N, 3); they are {rows.dtype} of {rows.shape}")
        kinds = _np.broadcast_to(_bytes("materials", materials), rows.shape[:1])
        return self._tree.insert_all(_np.clip(rows.astype(_np.int64), -1, 1 << 12).astype(_np.int32, "C"),
                                     _np.ascontiguousarray(kinds))

    def insert_box(self, low: Sequence[int], high: Sequence[int], material: int = 0) -> None:
        """Makes all voxels from `low` up to but without `high` solid; what is done when room ends stays."""
        self._tree.insert_box(low, high, material)

    def remove(self, x: int, y: int, z: int) -> None:
        """Makes a voxel empty."""
        self._tree.remove(x, y, z)

    def material(self, x: int, y: int, z: int) -> Optional[int]:
        """Of a voxel; None where nothing is."""
        found = self._tree.material(x, y, z)
        return None if found < 0 else found

    def coarsen_to(self, nodes: int) -> None:
        """Merges blocks, those first that add least solid for the nodes they save, until so many nodes do."""
        self._tree.coarsen_to(nodes)

    def clear(self) -> None:
        """Empties it."""
        self._tree.clear()

    @property
    def depth(self) -> int:
        """The world is 2**depth voxels a side."""
        return self._tree.level()

    @property
    def nodes(self) -> int:
        """Nodes in use, of 8 bytes each."""
        return self._tree.nodes()

    @property
    def capacity(self) -> int:
        """Nodes of the pool."""
        return self._tree.capacity()

    @property
    def solid_added(self) -> int:
        """Voxels that merging blocks has added."""
        return self._tree.solid_added()

    def __len__(self) -> int:
        """Solid voxels."""
        return self._tree.voxel_count()

    def scene(self, palette: Any = ()) -> Scene:
        """A scene of what is solid now. palette: uint8 of shape (N, 3), a colour a material, N up to 256."""
        colors = _bytes("palette", palette)
        if colors.size and (colors.ndim != 2 or colors.shape[1] != 3 or len(colors) > 256):
            raise ValueError(f"palette must be uint8 of shape (N, 3), N up to 256; its shape is {colors.shape}")
        return Scene(_thimble.Scene(self._tree.baked(colors.reshape(-1, 3)), b"octree.oct", []))


class BitField:
    """A picture of one bit a cell, x to the right and y down, in which discs are stamped and looked for.

    What lies outside is clear, and stays so. A box is x0, y0, x1, y1, without the last column and row; a disc is placed
    by the cell of least x and y of the square around it.
    """

    def __init__(self, width: int, height: int):
        self._field = _thimble.BitField(width, height)

    def set_box(self, x0: int, y0: int, x1: int, y1: int) -> None:
        """Sets the cells of a box."""
        self._field.set_box((x0, y0, x1, y1))

    def clear_box(self, x0: int, y0: int, x1: int, y1: int) -> None:
        """Clears the cells of a box."""
        self._field.clear_box((x0, y0, x1, y1))

    def count(self, x0: int = 0, y0: int = 0, x1: int = 1 << 14, y1: int = 1 << 14) -> int:
        """How many cells of a box are set; of all without one."""
        return self._field.count((x0, y0, x1, y1))

    def set_disc(self, diameter: int, x: int, y: int) -> None:
        """Sets the cells of a disc."""
        self._field.set_disc(diameter, x, y)

    def clear_disc(self, diameter: int, x: int, y: int) -> None:
        """Clears the cells of a disc."""
        self._field.clear_disc(diameter, x, y)

    def any_disc(self, diameter: int, x: int, y: int) -> bool:
        """Whether a cell of a disc is set."""
        return self._field.any_disc(diameter, x, y)

    def __getitem__(self, at: Tuple[int, int]) -> bool:
        """Whether the cell x, y is set."""
        return self._field.test(*at)

    def array(self) -> _np.ndarray:
        """All cells: bool, height x width."""
        return self._field.array()

    @property
    def size_bytes(self) -> int:
        """What the cells take."""
        return self._field.size_bytes()


class Balls(NamedTuple):
    """N balls in the order of their numbers; y goes down.

    id        uint32 (N,)
    position  float64 (N, 2): centre, in cells
    velocity  float64 (N, 2): cells a step
    diameter  int32 (N,): cells
    asleep    bool (N,)
    """

    id: _np.ndarray
    position: _np.ndarray
    velocity: _np.ndarray
    diameter: _np.ndarray
    asleep: _np.ndarray


class Particles:
    """The paper's particle world: balls in a bit field, where a collision costs the same however many there are.

    width, height: cells. count: balls, of random `diameters` (least, most), places and velocities up to `speed` cells a
    step on each axis (to 8192). gravity: cells a step a step. bounciness: 0 to 1. What is beyond is an Error. The same
    arguments give the same balls on every machine.
    """

    def __init__(self, width: int = 800, height: int = 600, count: int = 693, *, diameters: Tuple[int, int] = (2, 12),
                 bounciness: float = 0.8, gravity: Tuple[float, float] = (0, 0.1), seed: int = 1, speed: float = 3):
        self._world = _thimble.Particles(width, height, count, diameters, bounciness, gravity, seed, speed)

    def step(self, steps: int = 1) -> None:
        """Moves all balls on by so many units of time."""
        self._world.step(steps)

    def balls(self) -> Balls:
        """Where they are and how they move."""
        return Balls(*self._world.balls())

    def field(self) -> _np.ndarray:
        """The cells that are taken: bool, height x width."""
        return self._world.field()

    def image(self) -> _np.ndarray:
        """A picture of them: uint8, height x width x 3."""
        return self._world.image()

    @property
    def steps(self) -> int:
        """Steps made."""
        return self._world.steps()

    @property
    def crc32(self) -> int:
        """CRC-32 of the state, the same on every machine."""
        return self._world.crc32()

    @property
    def size_bytes(self) -> int:
        """What the world takes."""
        return self._world.size_bytes()
