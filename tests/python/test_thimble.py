"""The Python package against NumPy's own answers, and against the command where THIMBLE_COMMAND names it."""

import io
import json
import os
import pydoc
import re
import subprocess
import tempfile
import threading
import unittest

import numpy as np

import thimble

COMMAND = os.environ.get("THIMBLE_COMMAND")
RANDOM = np.random.default_rng(40)


def written(*words, ending):
    """What the command writes into a file of that ending."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "out" + ending)
        subprocess.run([COMMAND, *words, path], check=True, capture_output=True)
        with open(path, "rb") as file:
            return file.read()


def cube(side=32, share=0.1):
    """Random voxels of materials, and a scene of them."""
    colors = np.zeros((side, side, side, 4), np.uint8)
    colors[..., :3] = RANDOM.integers(1, 4, (side, side, side, 3)) * 60
    colors[..., 3] = RANDOM.random((side, side, side)) < share
    return colors, thimble.from_voxels(colors)


class Tracing(unittest.TestCase):
    def test_rays_down_the_columns_hit_the_highest_voxel_of_each(self):
        colors, scene = cube()
        solid = colors[..., 3] != 0
        x, y = np.meshgrid(np.arange(32), np.arange(32), indexing="ij")
        origins = np.stack([x + 0.5, y + 0.5, np.full(x.shape, 40.0)], axis=-1)
        hits = scene.trace(origins, (0, 0, -1))
        highest = np.where(solid.any(axis=2), 31 - solid[:, :, ::-1].argmax(axis=2), -1)
        self.assertEqual(hits.hit.shape, (32, 32))
        np.testing.assert_array_equal(hits.hit, highest >= 0)
        np.testing.assert_array_equal(hits.voxel[..., 2], highest)
        np.testing.assert_array_equal(hits.distance[hits.hit], 39.0 - highest[hits.hit])
        np.testing.assert_array_equal(hits.t[hits.hit], hits.distance[hits.hit])
        self.assertTrue((hits.axis[hits.hit] == 2).all())
        seen = colors[x, y, highest][..., :3]
        np.testing.assert_array_equal(hits.color[hits.hit], seen[hits.hit])
        np.testing.assert_array_equal(scene.palette[hits.material[hits.hit]], seen[hits.hit])

    def test_a_miss_is_said_in_every_array(self):
        hits = cube()[1].trace((0, 0, 50), [(0, 0, 1)])
        self.assertEqual([array.tolist() for array in hits],
                         [[False], [[-1, -1, -1]], [np.inf], [np.inf], [-1], [-1], [[0, 0, 0]]])

    def test_few_rays_and_many_have_the_same_answers_on_any_number_of_threads(self):
        scene = thimble.open("castle")
        origins = RANDOM.uniform(-60, 180, (20000, 3))
        directions = RANDOM.normal(size=(20000, 3))
        many = scene.trace(origins, directions, threads=3)
        one = scene.trace(origins, directions, threads=1)
        few = [scene.trace(origins[i:i + 500], directions[i:i + 500]) for i in range(0, 20000, 500)]
        self.assertGreater(many.hit.sum(), 100)
        for i, array in enumerate(many):
            np.testing.assert_array_equal(array, one[i])
            np.testing.assert_array_equal(array, np.concatenate([part[i] for part in few]))

    def test_hits_lie_on_faces_of_solid_voxels(self):
        scene = thimble.open("castle")
        origins = RANDOM.integers(-60, 180, (5000, 3)).astype(float)
        directions = RANDOM.integers(-1000, 1000, (5000, 3)).astype(float)
        directions[(directions == 0).all(axis=1)] = 1
        hits = scene.trace(origins, directions)
        solid = set(map(tuple, scene.voxels().position))
        entered = hits.hit & (hits.axis >= 0)
        self.assertGreater(entered.sum(), 50)
        points = origins + np.where(hits.hit, hits.t, 0)[:, None] * directions
        for voxel, point, axis in zip(hits.voxel[entered], points[entered], hits.axis[entered]):
            self.assertIn(tuple(voxel), solid)
            self.assertTrue((point >= voxel - 1e-6).all() and (point <= voxel + 1 + 1e-6).all())
            self.assertAlmostEqual(point[axis], round(point[axis]), places=6)

    def test_what_is_no_ray_is_named(self):
        scene = cube()[1]
        for origins, directions, sentence in (
                (np.zeros((4, 2)), (0, 0, 1), r"origins must be numbers of shape \(\.\.\., 3\); its shape is \(4, 2\)"),
                (np.zeros((4, 3)), np.zeros((5, 3)), r"origins and directions must be as many.*\(4, 3\) and \(5, 3\)"),
                (np.zeros((4, 3)), (0, 0, 0), "ray 0: the direction is zero"),
                ([(0, 0, 0), (0, 1e9, 0)], (0, 0, 1), "ray 1: the origin's 1e\\+09 is outside"),
                ((0, 0, np.nan), (0, 0, 1), "ray 0: a ray has a coordinate that is not a finite number")):
            with self.assertRaisesRegex(ValueError, sentence):
                scene.trace(origins, directions)
        with self.assertRaisesRegex(TypeError, "directions must be numbers of shape .*; its type is <U1"):
            scene.trace((0, 0, 0), ["a", "b", "c"])

    def test_other_threads_run_while_rays_are_traced(self):
        scene = thimble.open("castle")
        rays = RANDOM.uniform(-60, 180, (1_000_000, 3))
        done = threading.Event()

        def trace():
            scene.trace(rays, (1, 1, -1), threads=1)
            done.set()

        thread = threading.Thread(target=trace)
        turns = 0
        thread.start()
        while not done.is_set():
            turns += 1
        thread.join()
        self.assertGreater(turns, 1000)


class Pictures(unittest.TestCase):
    def test_a_picture_has_rows_columns_and_channels(self):
        scene = thimble.open("castle")
        picture = scene.render(64, 48)
        self.assertEqual((picture.shape, picture.dtype), ((48, 64, 3), np.uint8))
        covered = scene.render(64, 48, background="none", ground="off")[..., 3]
        self.assertEqual((covered.min(), covered.max()), (0, 255))
        self.assertEqual(scene._repr_png_()[:8], b"\x89PNG\r\n\x1a\n")

    def test_a_depth_image_is_as_far_as_rays_say(self):
        scene = thimble.from_voxels(np.ones((8, 8, 8)))
        view = dict(eye=(4, -20, 4), target=(4, 4, 4), fov=40)
        depths = scene.depth_image(33, 33, **view)
        self.assertEqual((depths.shape, depths.dtype), ((33, 33), np.float32))
        self.assertAlmostEqual(float(depths[16, 16]), 20, places=3)
        self.assertEqual(depths[0, 0], np.inf)
        drawn = scene.render(33, 33, shade="mono", **view)[..., 0] != 0
        np.testing.assert_array_equal(drawn, np.isfinite(depths))

    def test_a_wrong_option_is_said_as_the_command_says_it(self):
        scene = cube()[1]
        for options, sentence in (({"tilt_": 3}, '"--tilt-=3" is not an option of thimble render .did you mean --tilt'),
                                  ({"fov": 300}, "--fov: "),
                                  ({"depth": 4}, "--depth: says how a scene is opened, and this one is open"),
                                  ({"help": True}, '"--help" is not an option'),
                                  ({"shade": "co\0lor"}, "has a zero byte"),
                                  ({"shade": "\udcff"}, r'--shade: "\\xff" is not'),
                                  ({"rows": "0:3"}, "only the command writes")):
            with self.assertRaisesRegex(thimble.Error, sentence):
                scene.render(32, 32, **options)
        with self.assertRaisesRegex(thimble.Error, "--size"):
            scene.render(2**31, 1)
        with self.assertRaisesRegex(thimble.Error, "--z-up takes no value"):
            thimble.open("castle", z_up=1)
        with self.assertRaisesRegex(thimble.Error, "only the command writes"):
            scene.bake(stats="s.json")
        self.assertEqual(scene.render(8, 8, quiet=np.bool_(True), verbose=np.bool_(False)).shape, (8, 8, 3))
        for threads in (0, -1, 257):
            with self.assertRaisesRegex(ValueError, "threads must be 1 to 256"):
                scene.trace((0, 0, 0), (1, 1, 1), threads=threads)
            with self.assertRaisesRegex(ValueError, "threads must be 1 to 256"):
                scene.depth_image(8, 8, threads=threads)

    @unittest.skipUnless(COMMAND, "THIMBLE_COMMAND names no command")
    def test_pictures_are_the_command_s_byte_for_byte(self):
        scene = thimble.open("castle")
        for options in ({}, {"shade": "depth"}, {"view": "front", "tilt": 10, "samples": 1, "background": "102030"},
                        {"eye": (-40, -90, 80.5), "fov": 40, "effects": "shadows,sky"}):
            words = []
            for name, value in options.items():
                words += ["--" + name, ",".join(map(str, value)) if isinstance(value, tuple) else str(value)]
            file = written("render", "castle", "--size", "80x60", "--quiet", *words, "-o", ending=".ppm")
            self.assertEqual(file, b"P6\n80 60\n255\n" + scene.render(80, 60, **options).tobytes(), options)

    @unittest.skipUnless(COMMAND, "THIMBLE_COMMAND names no command")
    def test_depths_are_the_command_s(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "depth.pfm")
            subprocess.run([COMMAND, "render", "fox", "--size", "40x30", "--quiet", "-o", os.path.join(folder, "f.png"),
                            "--depth-image", path], check=True)
            with open(path, "rb") as opened:
                file = opened.read()
        rows = np.frombuffer(file[-4 * 40 * 30:], "<f4").reshape(30, 40)[::-1]
        np.testing.assert_array_equal(thimble.open("fox").depth_image(40, 30), rows)


class Arrays(unittest.TestCase):
    def test_voxels_come_back_as_they_were_given(self):
        colors, scene = cube(20)
        voxels = scene.voxels()
        self.assertEqual(len(scene), len(voxels.position))
        self.assertEqual(sorted(map(tuple, voxels.position)), list(map(tuple, np.argwhere(colors[..., 3]))))
        x, y, z = voxels.position.T
        np.testing.assert_array_equal(voxels.color, colors[x, y, z, :3])
        low, high = scene.bounds
        self.assertEqual((low, high), (tuple(voxels.position.min(axis=0)), tuple(voxels.position.max(axis=0) + 1)))

    def test_points_with_colors(self):
        points = np.concatenate([RANDOM.uniform(0, 1, (500, 3)), RANDOM.integers(0, 2, (500, 3))], axis=1)
        scene = thimble.from_points(points, depth=6)
        self.assertEqual((scene.depth, scene.has_colors), (6, True))
        self.assertEqual(len(scene), len(set(map(tuple, scene.voxels().position))))
        placed = thimble.from_points(RANDOM.integers(0, 16, (30, 3)), as_voxels=True)
        self.assertEqual(placed.depth, 4)

    def test_what_an_array_must_be_is_said(self):
        for make, array, kind, sentence in (
                (thimble.from_voxels, np.ones((4, 4)), ValueError, r"numbers of shape \(X, Y, Z\).*its shape is \(4, 4\)"),
                (thimble.from_voxels, np.ones((4, 4, 4, 3)), TypeError, "or uint8 of shape .*its type is float64"),
                (thimble.from_voxels, np.ones((4, 4, 4), complex), TypeError, "its type is complex128"),
                (thimble.from_voxels, np.zeros((4, 4, 4)), thimble.Error, "the array holds nothing solid"),
                (thimble.from_points, np.ones((4, 2)), ValueError, r"numbers of shape \(N, 3\).*its shape is \(4, 2\)")):
            with self.assertRaisesRegex(kind, sentence):
                make(array)

    def test_bytes_are_a_file(self):
        file = io.BytesIO()
        np.save(file, np.ones((3, 4, 5), np.uint8))
        self.assertEqual(len(thimble.open(file.getvalue(), name="box.npy")), 60)
        self.assertEqual(len(thimble.open(b"0 0 0\n5 5 5\n", name="p.xyz", as_voxels=True)), 2)
        with self.assertRaisesRegex(thimble.Error, "no such file"):
            thimble.open("castel")

    def test_written_voxels_are_read_again(self):
        colors, scene = cube(9, 0.5)
        with tempfile.TemporaryDirectory() as folder:
            for ending in (".vox", ".npy"):
                path = os.path.join(folder, "out" + ending)
                scene.write(path)
                again = thimble.open(path).voxels()
                np.testing.assert_array_equal(again.position, scene.voxels().position)
                np.testing.assert_array_equal(again.color, scene.voxels().color)
            with self.assertRaisesRegex(thimble.Error, "does not end in .vox"):
                scene.write(os.path.join(folder, "out.xyz"))
            with self.assertRaisesRegex(thimble.Error, "has a zero byte"):
                scene.write(os.path.join(folder, "out\0.npy"))
            self.assertEqual(len(os.listdir(folder)), 2)
            with self.assertRaisesRegex(thimble.Error, "has a zero byte"):
                thimble.open(os.path.join(folder, "out.vox") + "\0")

    def test_a_path_may_hold_any_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "\udcff\udcfe.obj")
            with open(path, "w") as file:
                file.write("mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 1\nusemtl no\nf 1 2 3\n")
            scene = thimble.open(path, depth=3)
            self.assertIn("\\xff\\xfe.obj: the materials of", scene.notes[0])
            scene.write(path + ".npy")
            self.assertEqual(len(thimble.open(path + ".npy")), len(scene))
            with self.assertRaisesRegex(thimble.Error, r"\\xff\\xfe.obj does not end in .vox"):
                scene.write(path)


class Budgets(unittest.TestCase):
    def test_a_row_for_each_depth(self):
        scene = thimble.from_voxels(np.ones((16, 16, 16)))
        rows = scene.memory()
        self.assertEqual([row["depth"] for row in rows], [1, 2, 3, 4])
        self.assertEqual(rows[-1]["voxels"], 4096)
        self.assertGreater(rows[-1]["dense_bytes"], rows[-1]["compact_bytes"])

    def test_a_baked_scene_opens_again(self):
        scene = thimble.open("castle")
        baked = scene.bake(board="pico")
        again = thimble.open(baked, name="castle.oct")
        np.testing.assert_array_equal(again.voxels().position, scene.voxels().position)
        with self.assertRaisesRegex(thimble.Error, "--coarsen makes the finest tree that fits"):
            scene.bake(memory="2K")

    def test_smaller_depths_that_would_fit_are_those_of_the_bytes_that_were_given(self):
        cloud = "\n".join(f"{x} {y} {z}" for x, y, z in RANDOM.uniform(0, 1, (300, 3))).encode()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "cloud.xyz")
            with open(path, "wb") as file:
                file.write(cloud)
            for options in ({}, {"clip": (0, 0, 0, 1, 1, 0.9)}):
                with self.assertRaises(thimble.Error) as caught:
                    thimble.open(path, depth=6, **options).bake(memory="900", effects="none")
                depth, size = re.search(r"--depth (\d) fits with (\d+) bytes", str(caught.exception)).groups()
                self.assertEqual(len(thimble.open(path, depth=depth, **options).bake(effects="none")), int(size))
            with self.assertRaises(thimble.Error) as caught:
                thimble.open(cloud, name=path, depth=6).bake(memory="900", effects="none")
            self.assertNotIn("fits with", str(caught.exception))

    @unittest.skipUnless(COMMAND, "THIMBLE_COMMAND names no command")
    def test_bytes_and_rows_are_the_command_s(self):
        scene = thimble.open("castle")
        self.assertEqual(written("bake", "castle", "--board", "pico", "--quiet", "-o", ending=".oct"),
                         scene.bake(board="pico"))
        rows = json.loads(written("memory", "castle", "--frames", "0", "--quiet", "--json", ending=".json"))
        self.assertEqual([row for row in rows if row["row"] == "depth"], scene.memory())


class Structures(unittest.TestCase):
    def test_an_octree_is_edited_within_its_pool(self):
        tree = thimble.Octree(5, nodes=2000)
        places = RANDOM.integers(0, 32, (100, 3))
        self.assertEqual(tree.insert_all(places, np.arange(100)), 100)
        tree.insert_box((0, 0, 0), (2, 2, 2), 7)
        tree.remove(1, 1, 1)
        self.assertEqual((tree.material(0, 0, 0), tree.material(1, 1, 1)), (7, None))
        expected = (set(map(tuple, places)) | {(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)}) - {(1, 1, 1)}
        scene = tree.scene(palette=RANDOM.integers(0, 256, (101, 3)))
        self.assertEqual({tuple(place) for place in scene.voxels().position.tolist()}, expected)
        nodes = tree.nodes
        tree.coarsen_to(nodes // 2)
        self.assertLessEqual(tree.nodes, nodes // 2)
        self.assertGreater(tree.solid_added, 0)

    def test_out_of_room_and_outside_are_said(self):
        tree = thimble.Octree(5, nodes=8)
        with self.assertRaises(MemoryError):
            tree.insert_all(RANDOM.integers(0, 32, (100, 3)))
        with self.assertRaisesRegex(ValueError, "out of range"):
            tree.insert(32, 0, 0)
        with self.assertRaisesRegex(ValueError, "out of range"):
            tree.insert_all([(2**32, 0, 0)])
        with self.assertRaisesRegex(TypeError, "positions must be integers"):
            tree.insert_all(np.zeros((3, 3)))
        with self.assertRaisesRegex(ValueError, "materials must be integers of 0 to 255"):
            tree.insert_all([(1, 1, 1)], 256)
        with self.assertRaisesRegex(ValueError, "palette must be integers of 0 to 255"):
            tree.scene(palette=[(0.5, 0.5, 0.5)])
        for shape in ((257, 3), (6,), (3, 4)):
            with self.assertRaisesRegex(ValueError, r"palette must be uint8 of shape \(N, 3\), N up to 256"):
                tree.scene(palette=np.zeros(shape, np.uint8))

    def test_a_field_of_bits(self):
        field = thimble.BitField(70, 40)
        field.set_box(60, 30, 75, 50)
        field.set_disc(3, 10, 5)
        cells = np.zeros((40, 70), bool)
        cells[30:, 60:] = True
        cells[5:8, 10:13] = True
        np.testing.assert_array_equal(field.array(), cells)
        self.assertEqual((field.count(), field.count(0, 0, 60, 40)), (cells.sum(), 9))
        self.assertTrue(field.any_disc(5, 6, 5) and field[11, 6] and not field[9, 6])
        field.clear_disc(3, 10, 5)
        self.assertFalse(field.any_disc(5, 8, 4))

    def test_particles_are_the_same_everywhere(self):
        world = thimble.Particles(count=200, seed=3)
        world.step(300)
        balls = world.balls()
        self.assertEqual((world.steps, len(balls.id), world.field().shape), (300, 200, (600, 800)))
        self.assertTrue(((balls.position > 0) & (balls.position < (800, 600))).all())
        self.assertEqual(world.image().shape, (600, 800, 3))
        again = thimble.Particles(count=200, seed=3)
        again.step(300)
        self.assertEqual(world.crc32, again.crc32)
        self.assertNotEqual(world.crc32, thimble.Particles(count=200, seed=4).crc32)
        for options in ({"gravity": (np.nan, 0)}, {"gravity": (0, -65536.5)}, {"bounciness": np.nan}, {"bounciness": 65536.5},
                        {"speed": np.inf}, {"speed": -1}):
            with self.assertRaisesRegex(thimble.Error, "beyond its limits"):
                thimble.Particles(count=1, **options)


class Misuse(unittest.TestCase):
    ODD = [None, "", "7", -1, 0, 1, 3, 2**31, 2**63, 1e300, float("nan"), float("inf"), (), (1, 2, 3), [[1, 2, 3]], b"vox",
           np.zeros((0, 3)), np.zeros((2, 3)), np.ones((2, 2, 2)), np.full((3, 3), np.nan), np.ones(3, "M8[s]"), object(), {}]

    def test_odd_arguments_are_errors_or_answers(self):
        scene = thimble.from_voxels(np.ones((4, 4, 4)))
        tree, field = thimble.Octree(3, 100), thimble.BitField(20, 10)
        calls = [scene.trace, lambda a, b: scene.render(a, b), lambda a, b: scene.render(8, 6, eye=a, fov=b),
                 lambda a, b: scene.depth_image(8, 6, target=a, span=b), lambda a, b: scene.bake(board=a, memory=b),
                 lambda a, b: thimble.from_voxels(a, depth=b), lambda a, b: thimble.from_points(a, depth=b),
                 lambda a, b: thimble.open(a if isinstance(a, bytes) else str(a) + "?", depth=b),
                 tree.insert_all, tree.insert_box, lambda a, b: tree.insert(a, b, a), lambda a, b: tree.material(a, b, b),
                 lambda a, b: tree.remove(a, b, a), lambda a, b: tree.scene(a), lambda a, b: tree.coarsen_to(a),
                 lambda a, b: field.set_box(a, b, a, b), lambda a, b: field.set_disc(a, b, a), lambda a, b: field[a, b],
                 lambda a, b: thimble._thimble.Octree(3, 9).insert_all(a, b), lambda a, b: scene._built.trace(a, b, 2),
                 lambda a, b: tree._tree.baked(a), thimble.BitField, thimble.Octree]
        answers = 0
        for call in calls:
            for _ in range(40):
                a, b = (self.ODD[i] for i in RANDOM.integers(0, len(self.ODD), 2))
                try:
                    call(a, b)
                    answers += 1
                except (TypeError, ValueError, MemoryError, OverflowError):
                    pass
        self.assertGreater(answers, 10)


class Documentation(unittest.TestCase):
    def test_all_that_is_public_says_what_it_is(self):
        for name in thimble.__all__:
            thing = getattr(thimble, name)
            self.assertTrue(name == "Error" or thing.__doc__, name)
            for member, method in vars(thing).items() if isinstance(thing, type) else ():
                if not member.startswith("_") and callable(method):
                    self.assertTrue(method.__doc__, f"{name}.{member}")
        text = pydoc.render_doc(thimble, renderer=pydoc.plaintext)
        self.assertIn("trace(self, origins: Any, directions: Any", text)


if __name__ == "__main__":
    unittest.main()
