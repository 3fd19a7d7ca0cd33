#!/usr/bin/env python3
"""Error and time of pictures with 1, 4 and 9 samples in each pixel and with --samples auto.

    python3 tests/benchmarks/samples.py build/release/thimble DATA_FOLDER [--size WxH] [--rounds N] [--only WORD]

Errors are root mean squares of all channels' differences from the picture of 64 samples, of 255. Times are processor
time of one thread, the least of some runs each, by turns, as ratios of frames: three frames of one sample are what 4
samples take longer than 1, which leaves out reading and building. Node visits are those of all rays, and the same
everywhere.
"""
import argparse
import array
import json
import os
import resource
import subprocess
import tempfile

PLAIN = ["--shade", "color", "--engine", "ray64"]
LIT = ["--effects", "direct-light,shadows,sky,ambient-occlusion"]
MESH = "mesh/dragon_vrip_res2.ply.gz"
SCENES = [
    ("castle", "castle", "plain", PLAIN),
    ("monu10", "vox/ephtracy/monu10.vox", "plain", PLAIN),
    ("nature", "vox/ephtracy/nature.vox", "plain", PLAIN),
    ("dragon 512", MESH, "normals", ["--shade", "normal", "--engine", "ray64", "--depth", "9"]),
    ("spheres", "spheres", "plain", ["--shade", "normal", "--engine", "ray64"]),
    ("castle", "castle", "effects", LIT),
    ("monu10", "vox/ephtracy/monu10.vox", "effects", LIT),
    ("dragon 1024", MESH, "effects", LIT + ["--depth", "10"]),
    ("room", "room", "effects", ["--effects", "auto"]),
    ("glass", "glass", "effects", ["--effects", "auto"]),
    ("castle", "castle", "own look", []),
    ("ship", "ship", "own look", []),
    ("monu10", "vox/ephtracy/monu10.vox", "own look", []),
    ("teapot", "vox/ephtracy/teapot.vox", "own look", []),
    ("dragon 1024", MESH, "own look", ["--depth", "10"]),
    ("armadillo 512", "mesh/armadillo.off", "own look", ["--depth", "9"]),
]
SAMPLES = ["1", "4", "9", "auto"]


def draw(thimble, scene, options, size, samples, folder):
    picture = os.path.join(folder, "p.ppm")
    stats = os.path.join(folder, "s.json")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([thimble, "render", scene, *options, "--size", size, "--samples", samples, "--threads", "1",
                    "--quiet", "-o", picture, "--stats", stats], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    with open(picture, "rb") as file:
        data = file.read()
    start = 0
    for _ in range(3):
        start = data.index(b"\n", start) + 1
    with open(stats, encoding="utf-8") as file:
        return array.array("B", data[start:]), json.load(file)["node_visits"], seconds


def rms(one, other):
    return (sum((a - b) ** 2 for a, b in zip(one, other) if a != b) / len(one)) ** 0.5


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("thimble")
    parser.add_argument("data")
    parser.add_argument("--size", default="800x600")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    print("| scene | drawn as | error of 1 / 4 / 9 | error of auto | time of 9 | time of auto | node visits of auto |")
    print("| --- | --- | --- | ---: | ---: | ---: | ---: |", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, scene, drawn, options in SCENES:
            if arguments.only not in name + " " + drawn:
                continue
            path = os.path.join(arguments.data, scene) if "/" in scene else scene
            reference, _, _ = draw(arguments.thimble, path, options, arguments.size, "64", folder)
            errors, visits, seconds = {}, {}, {samples: [] for samples in SAMPLES}
            for turn in range(arguments.rounds):
                for samples in SAMPLES:
                    picture, visits[samples], took = draw(arguments.thimble, path, options, arguments.size, samples,
                                                          folder)
                    seconds[samples].append(took)
                    if turn == 0:
                        errors[samples] = rms(picture, reference)
            least = {samples: min(seconds[samples]) for samples in SAMPLES}
            time = {samples: 1 + 3 * (least[samples] - least["1"]) / (least["4"] - least["1"]) for samples in SAMPLES}
            print(f"| {name} | {drawn} | {errors['1']:.2f} / {errors['4']:.2f} / {errors['9']:.2f} | "
                  f"{errors['auto']:.2f} | {time['9']:.1f} | {time['auto']:.2f} | "
                  f"{visits['auto'] / visits['1']:.2f} |", flush=True)


if __name__ == "__main__":
    main()
