"""The Zephyr module: its folder may lie anywhere that a manifest or ZEPHYR_EXTRA_MODULES names."""

import tree


def files(_):
    made = {**tree.core(), **tree.common("zephyr")}
    for path in sorted((tree.ROOT / "zephyr").rglob("*")):
        if path.is_file():
            made[path.relative_to(tree.ROOT).as_posix()] = path.read_bytes()
    return {"thimble-zephyr-{version}.tar.gz": tree.below("thimble", made)}
