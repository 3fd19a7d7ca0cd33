"""The PlatformIO package: the manifest of the root, at the archive's root, as `pio pkg pack` has it."""

import tree


def files(_):
    return {"thimble-platformio-{version}.tar.gz": {**tree.core(), "library.json": tree.read("library.json"),
                                                     **tree.common("platformio")}}
