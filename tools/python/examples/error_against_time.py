"""A picture's error against the time that it takes, by samples a pixel: error_against_time.py [SCENE] [OUT.png].

The error is the root of the mean square of the channels' differences from 64 samples a pixel.
"""

import sys
import time

import numpy as np

import thimble


def main(scene="castle", out="error_against_time.png", size=(200, 150)):
    opened = thimble.open(scene)
    view = dict(shade="color", effects="none")
    best = opened.render(*size, samples=64, **view).astype(float)
    points = []
    print("samples  milliseconds  error")
    for samples in (1, 4, 9, 16, 25, 36, 49):
        start = time.perf_counter()
        picture = opened.render(*size, samples=samples, **view)
        seconds = time.perf_counter() - start
        points.append((1000 * seconds, np.sqrt(((picture - best) ** 2).mean())))
        print(f"{samples:7} {points[-1][0]:13.1f} {points[-1][1]:6.2f}")
    try:
        from matplotlib import pyplot
    except ImportError:
        return
    pyplot.plot(*zip(*points), "o-")
    pyplot.xlabel("milliseconds")
    pyplot.ylabel("error, of 255")
    pyplot.title(f"Accuracy against time: {scene}")
    pyplot.savefig(out)


main(*sys.argv[1:])
