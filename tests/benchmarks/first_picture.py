#!/usr/bin/env python3
"""From the start of the command to the picture in a file: processor time, time on the clock and peak memory.

    first_picture.py BEFORE AFTER [RUNS]        BEFORE, AFTER: two programs `thimble`

Both draw every row by turns; the medians count. Scenes that are not there are left out.
"""
import os
import statistics
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
CASTLE = os.path.join(HERE, "../../tools/gallery/scenes/castle.vox")
DATA = os.environ.get("THIMBLE_DATA", "")
PICTURE = os.path.join(tempfile.mkdtemp(), "picture.png")
ROWS = [
    ["points:1000000"],
    ["points:1000000", "--shade", "depth"],
    ["points:1000", "--shade", "depth"],
    ["cluster:300000"],
    [CASTLE],
    [CASTLE, "--shade", "color"],
    [DATA + "/vox/ephtracy/monu10.vox"],
    [DATA + "/vox/ephtracy/monu10.vox", "--shade", "color"],
    [DATA + "/vox/ephtracy/nature.vox", "--shade", "color"],
]


def run(program, words):
    """Processor seconds, seconds on the clock, peak kilobytes."""
    null = os.open(os.devnull, os.O_WRONLY)
    start = time.monotonic()
    child = os.fork()
    if child == 0:
        os.dup2(null, 1)
        os.dup2(null, 2)
        os.execv(program, [program, "render", *words, "-o", PICTURE, "--quiet"])
    _, status, usage = os.wait4(child, 0)
    took = time.monotonic() - start
    os.close(null)
    if status != 0:
        raise SystemExit(f"{program} render {' '.join(words)}: status {status}")
    return usage.ru_utime + usage.ru_stime, took, usage.ru_maxrss


def main():
    programs = sys.argv[1:3]
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 9
    print(f"{'scene':44} {'processor, s':>16} {'ratio':>6} {'clock, s':>14} {'peak, MB':>14}")
    for words in ROWS:
        if words[0].startswith("/") and not os.path.exists(words[0]):
            continue
        found = [[], []]
        for _ in range(runs):
            for program, results in zip(programs, found):
                results.append(run(program, words))
        before, after = ([statistics.median(column) for column in zip(*results)] for results in found)
        name = " ".join([os.path.basename(words[0]), *words[1:]])
        print(
            f"{name:44} {before[0]:8.3f}{after[0]:8.3f} {after[0] / before[0]:6.2f} "
            f"{before[1]:7.2f}{after[1]:7.2f} {before[2] / 1e3:7.1f}{after[2] / 1e3:7.1f}",
            flush=True,
        )


main()
