"""The source archive for CMake (FetchContent, CPM, or by itself) and Meson, and a wrap that names it."""

import tree


def files(_):
    names = ["CMakeLists.txt", "src/CMakeLists.txt", "src/thimble.pc.in", "meson.build", "tools/packages/list_sources.py",
             "platform/examples/ball/main.cpp"]
    made = {**tree.core(), **{name: tree.read(name) for name in names}, **tree.common("source")}
    return {"thimble-{version}.tar.gz": tree.below(f"thimble-{tree.version()}", made)}
