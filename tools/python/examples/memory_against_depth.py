"""Bytes against depth in each structure, as `thimble memory SCENE --plot`: memory_against_depth.py [SCENE] [OUT.png]."""

import sys

import thimble

STRUCTURES = {"dense": "dense grid, a bit a unit", "pool": "pool, 8 bytes a node", "compact": "compact tree",
              "dag": "DAG, equal subtrees once"}


def main(scene="points:200000", out="memory_against_depth.png"):
    rows = thimble.open(scene).memory()
    print("depth  voxels  " + "  ".join(STRUCTURES))
    for row in rows:
        print(row["depth"], row["voxels"], *(row[f"{name}_bytes"] for name in STRUCTURES))
    try:
        from matplotlib import pyplot
    except ImportError:
        return
    for name, label in STRUCTURES.items():
        pyplot.semilogy([row["depth"] for row in rows], [row[f"{name}_bytes"] or None for row in rows], "o-", label=label)
    pyplot.xlabel("depth (a world of 2^depth voxels a side)")
    pyplot.ylabel("bytes")
    pyplot.title(f"Memory against depth: {scene}")
    pyplot.legend()
    pyplot.savefig(out)


main(*sys.argv[1:])
