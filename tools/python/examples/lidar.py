"""A lidar's sweep of a million rays from the middle of a scene, back as a scene of points: lidar.py [SCENE] [OUT.png]."""

import sys
import time

import numpy as np

import thimble


def main(scene="castle", out="lidar.png", rays=1_000_000):
    opened = thimble.open(scene)
    low, high = map(np.asarray, opened.bounds)
    eye = (low + high) / 2 + (0.3, 0.2, 0.6 * (high - low)[2])  # above the middle
    turn = np.linspace(0, 200 * np.pi, rays)  # 100 rings, from straight down to the horizon
    drop = np.linspace(-np.pi / 2, 0, rays)
    directions = np.stack([np.cos(drop) * np.cos(turn), np.cos(drop) * np.sin(turn), np.sin(drop)], axis=1)
    start = time.perf_counter()
    hits = opened.trace(eye, directions)
    seconds = time.perf_counter() - start
    print(f"{rays} rays in {seconds:.3f} s, {rays / seconds / 1e6:.1f} million a second; {hits.hit.mean():.0%} hit, "
          f"{hits.distance[hits.hit].mean():.2f} voxels away")
    points = eye + hits.distance[hits.hit, None] * directions[hits.hit]
    cloud = thimble.from_points(np.concatenate([points, hits.color[hits.hit]], axis=1), depth=9)
    with open(out, "wb") as file:
        file.write(cloud.png(800, 600))


main(*sys.argv[1:])
