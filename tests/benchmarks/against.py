#!/usr/bin/env python3
"""What two versions take for the same pictures, by turns: processor time of one thread, the least of the turns.

    against.py BEFORE AFTER [--turns N] [solid|views|lit|threads ...]

BEFORE, AFTER: folders of builds with `thimble` and `thimble_engine_table`, in `build/release` of their checkouts.
BEFORE need not know AFTER's worlds: it gets them as files. THIMBLE_DATA names the folder of the models.

    solid    worlds that are solid through, and crowded points beside uniform ones; 800 x 600, greys
    views    every view of `thimble_engine_table --most 1000000` that BEFORE has
    lit      800 x 600 in light: what a picture takes more than one of 2 x 2 pixels, its file read in both
    threads  AFTER's lit pictures with one thread and with two, by the clock; wants a machine that does nothing else
"""
import argparse
import atexit
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile

DATA = os.environ.get("THIMBLE_DATA", "")
WORK = tempfile.mkdtemp()
atexit.register(shutil.rmtree, WORK)
SIX = ["outside", "near", "grazing", "along", "parallel", "parallel oblique"]
DRAGON = DATA + "/mesh/dragon_vrip_res2.ply.gz"
SOLID = ["terrain:10", "globe:9", "city:10", "city:9"]
LIGHT = "sun toward -3 -5 6\nsky\nocclusion rays 4\n"
LIT = {
    "dragon 1024": f"depth 10\nmodel {DRAGON} depth 10\n{LIGHT}",
    "dragon 2048": f"depth 11\nmodel {DRAGON} depth 11\n{LIGHT}",
    "monu10": f"model {DATA}/vox/ephtracy/monu10.vox\n{LIGHT}",
    "city 1024": f"depth 10\nmodel {WORK}/city:10.oct\n{LIGHT}",
    "terrain 1024": f"depth 10\nmodel {WORK}/terrain:10.oct\n{LIGHT}",
    "room.scene": None,
    "lagoon.scene": None,
    "glass.scene": None,
}


def run(*words):
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(" ".join(words) + ":\n" + done.stdout[-2000:])


def processor_seconds(*words):
    null = os.open(os.devnull, os.O_WRONLY)
    child = os.fork()
    if child == 0:
        os.dup2(null, 1)
        os.execv(words[0], words)
    _, status, usage = os.wait4(child, 0)
    os.close(null)
    if status != 0:
        sys.exit(" ".join(words) + f": status {status}")
    return usage.ru_utime + usage.ru_stime


def world_file(after, world):
    """The world as a file that both versions read."""
    name = world.split("/")[-1].split("@")[0].split(".")[0] if "/" in world else world
    path = f"{WORK}/{name}.oct"
    if not os.path.exists(path):
        run(after + "/thimble_engine_table", "--world", world, "--save", path)
    return path


def engine_rows(build, worlds, more=()):
    """Milliseconds and whether the picture is the core's, by world and camera."""
    path = WORK + "/rows.csv"
    run(build + "/thimble_engine_table", "--frames", "1", "--csv", path, *more, "--world", *worlds)
    with open(path, encoding="utf-8") as file:
        return {(row["world"], row["camera"]): (float(row["auto_ms"]), row["equal"] == "1") for row in csv.DictReader(file)}


def least_of(turns, programs, rows_of):
    """By turns: of each program the least milliseconds of each row, and the rows with another picture."""
    least = [{} for _ in programs]
    wrong = set()
    for turn in range(turns):
        for number, program in enumerate(programs):
            print(f"turn {turn + 1} of {turns}: {program}", file=sys.stderr, flush=True)
            for key, (milliseconds, equal) in rows_of(program).items():
                least[number][key] = min(milliseconds, least[number].get(key, milliseconds))
                if not equal:
                    wrong.add(key)
    return least, wrong


def print_solid(before, after, turns):
    print("\nsolid worlds, ms: before, after, after / before")
    for world in SOLID:
        path = world_file(after, world)
        name = os.path.basename(path)
        (old, new), wrong = least_of(turns, [before, after], lambda build: engine_rows(build, [path]))
        for view in SIX:
            key = (name, view)
            if key in old:
                print(f"{name:28} {view:18} {old[key]:8.2f} {new[key]:8.2f} {new[key] / old[key]:6.2f}", flush=True)
        print(f"{name}: {len(wrong)} of {len(new)} pictures differ from the core's", flush=True)
    crowded, uniform = "cluster:20000000", "points:20000000"
    path = world_file(after, crowded)
    (times,), wrong = least_of(turns, [after], lambda build: engine_rows(build, [path, uniform]))
    print(f"\n{crowded} over {uniform}, ms, {len(wrong)} pictures differ")
    for view in SIX:
        one, other = times[os.path.basename(path), view], times[uniform, view]
        print(f"{view:18} {one:8.2f} {other:8.2f} {one / other:6.2f}", flush=True)


def data_files():
    return {name: os.path.join(folder, name) for folder, _, names in os.walk(DATA) for name in names}


def print_views(before, after, turns):
    files = data_files()
    path = WORK + "/list.csv"
    run(before + "/thimble_engine_table", "--frames", "1", "--most", "1000000", "--csv", path)
    with open(path, encoding="utf-8") as file:
        short = list(dict.fromkeys(row["world"] for row in csv.DictReader(file)))
    worlds = [files[name.split("@")[0]] + name[len(name.split("@")[0]):] if name.split("@")[0] in files else name for name in short]
    (old, new), wrong = least_of(turns, [before, after], lambda build: engine_rows(build, worlds))
    both = [key for key in old if key in new]
    ratios = sorted(((new[key] / old[key], key) for key in both), reverse=True)
    slower = [row for row in ratios if row[0] > 1.1]
    print(f"\n{len(both)} views, {len(wrong)} pictures differ; {len(slower)} above 1.1 times before")
    print(f"all together {sum(new[key] for key in both) / sum(old[key] for key in both):.2f} of the time")
    for ratio, key in slower:
        print(f"{key[0]:30} {key[1]:18} {old[key]:8.3f} {new[key]:8.3f} {ratio:6.2f}")


def lit_files(before, after):
    for world in ("city:10", "terrain:10"):
        world_file(after, world)
    paths = {}
    for name, text in LIT.items():
        scene = f"{before}/../../tools/gallery/scenes/{name}"
        effects = "auto"
        if text is not None:
            scene = f"{WORK}/{name.replace(' ', '-')}.scene"
            effects = "direct-light,shadows,ambient-occlusion,sky"
            with open(scene, "w", encoding="utf-8") as file:
                file.write(text)
        paths[name] = f"{WORK}/{name.replace(' ', '-')}.oct"
        run(before + "/thimble", "bake", scene, "-o", paths[name], "--effects", effects, "--quiet")
    return paths


def lit_words(build, path, size, threads):
    return [build + "/thimble", "render", path, "--effects", "auto", "--samples", "1", "--size", size, "--threads", str(threads),
            "--quiet", "-o", WORK + "/picture.ppm", "--stats", WORK + "/stats.json"]


def stats():
    with open(WORK + "/stats.json", encoding="utf-8") as file:
        return json.load(file)


def print_lit(before, after, turns):
    print("\nin light, ms: before, after, after / before; pictures")
    for name, path in lit_files(before, after).items():
        least = [[9e9, 9e9], [9e9, 9e9]]
        crcs = set()
        for _ in range(turns):
            for number, build in enumerate((before, after)):
                for part, size in enumerate(("2x2", "800x600")):
                    took = processor_seconds(*lit_words(build, path, size, 1))
                    least[number][part] = min(took, least[number][part])
                crcs.add(stats()["frame_crc32"])
        old, new = (1e3 * (whole - small) for small, whole in least)
        print(f"{name:14} {old:8.1f} {new:8.1f} {new / old:6.2f} {'same' if len(crcs) == 1 else 'DIFFERENT'}", flush=True)


def print_threads(before, after, turns):
    print("\nin light, ms by the clock: one thread, two, one / two")
    for name, path in lit_files(before, after).items():
        least = {1: 9e9, 2: 9e9}
        for _ in range(turns):
            for threads in least:
                run(*lit_words(after, path, "800x600", threads))
                least[threads] = min(1e3 * stats()["frame_seconds"], least[threads])
        print(f"{name:14} {least[1]:8.1f} {least[2]:8.1f} {least[1] / least[2]:6.2f}", flush=True)


def main():
    tables = {"solid": print_solid, "views": print_views, "lit": print_lit, "threads": print_threads}
    parser = argparse.ArgumentParser()
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("tables", nargs="*", default=[], metavar="|".join(tables))
    parser.add_argument("--turns", type=int, default=5)
    wish = parser.parse_intermixed_args()
    for name in wish.tables or ["solid", "views", "lit"]:
        tables[name](os.path.abspath(wish.before), os.path.abspath(wish.after), wish.turns)


main()
