"""The ESP-IDF component: a folder `thimble` to lie in `components`."""

import tree


def files(_):
    names = ["CMakeLists.txt", "idf_component.yml", "src/CMakeLists.txt", "tools/packages/esp-idf/component.cmake"]
    made = {**tree.core(), **{name: tree.read(name) for name in names}, **tree.common("esp-idf")}
    return {"thimble-esp-idf-{version}.tar.gz": tree.below("thimble", made)}
