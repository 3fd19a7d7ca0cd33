"""Seconds against points, as the paper's Tables I and II: seconds_against_points.py [GENERATOR] [OUT.png].

GENERATOR is points or cluster; another scene is timed as it is.
"""

import sys
import time

import thimble


def seconds(run):
    start = time.perf_counter()
    result = run()
    return time.perf_counter() - start, result


def main(generator="cluster", out="seconds_against_points.png"):
    counts = (10_000, 30_000, 100_000, 300_000) if generator in ("points", "cluster") else (None,)
    rows = []
    print("points  seconds to build  seconds a picture of 800 x 600")
    for count in counts:
        build, scene = seconds(lambda: thimble.open(generator if count is None else f"{generator}:{count}"))
        draw, _ = seconds(lambda: scene.render(800, 600, shade="depth"))
        rows.append((count or len(scene), build, draw))
        print(f"{rows[-1][0]:8} {build:.3f} {draw:.3f}")
    try:
        from matplotlib import pyplot
    except ImportError:
        return
    points, builds, draws = zip(*rows)
    pyplot.loglog(points, builds, "o-", label="build")
    pyplot.loglog(points, draws, "o-", label="picture")
    pyplot.xlabel("points")
    pyplot.ylabel("seconds")
    pyplot.legend()
    pyplot.savefig(out)


main(*sys.argv[1:])
