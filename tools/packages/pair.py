"""The pair: all public headers as thimble.h, all of src as thimble.cpp; a C face and drivers stay files of their own."""

import posixpath
import re

import tree

# The first line of a function of a namespace, as clang-format leaves it.
_FUNCTION = re.compile(
    r"^(?!namespace|using|typedef|struct|class|enum|union|static_assert|template|return|extern)"
    r"(?:\[\[[^]]*\]\] )*[A-Za-z_][\w:<>,\[\] *&()]*?[ *&](\w+)\("
)


def is_c(name):
    """A header that C can read cannot go into one that it cannot."""
    return name.endswith("_c.h")


def is_driver(name):
    """A panel's driver would be code in each program: what is one object the linker takes as a whole."""
    return "/drivers/" in name


def _resolve(of, path):
    """The file that an include in `of` means."""
    if path.startswith("thimble/"):
        return "include/" + path
    return posixpath.normpath(posixpath.join(posixpath.dirname(of), path))


class _Text:
    """Files one after the other, each once, what they include before them."""

    def __init__(self, done=()):
        self.parts = []
        self.done = set(done)

    def add(self, name):
        if name in self.done:
            return
        self.done.add(name)
        wanted = []

        def drop(_, path):
            target = _resolve(name, path)
            if is_c(target):
                return b'#include "' + posixpath.basename(target).encode() + b'"'
            wanted.append(target)
            return b""

        data = tree.each_include(tree.read(name), drop)
        for target in wanted:
            self.add(target)
        self.parts.append(f"// ---- {name}\n".encode() + data.replace(b"#pragma once\n", b"").strip() + b"\n")


def _own_functions(text):
    """Functions of unnamed namespaces, with the names of the namespaces around them."""
    around = []
    for line in text.split("\n"):
        opened = re.match(r"^namespace ?([\w:]*) ?{$", line)
        if opened:
            around.append(opened.group(1))
        elif line.startswith("}  // namespace"):
            around.pop()
        elif "" in around:
            function = _FUNCTION.match(line)
            if function:
                yield "::".join(each for each in around if each), function.group(1)


def refuse_equal_names(sources):
    """Ends with a sentence where two files keep a function of one name to themselves. In one translation unit these are
    one function, or, as long as their types differ, two: then what is one type on some target decides."""
    seen = {}
    for name, data in sources.items():
        for function in _own_functions(data.decode()):
            other = seen.setdefault(function, name)
            if other != name:
                raise SystemExit(f"packages: {other} and {name} both have a function {function[1]}; rename one of them")


def _driver(name):
    """Headers and sources of drivers in one folder; what they include of the core is in thimble.h."""

    def to(prefix, path):
        target = _resolve(name, path)
        if is_driver(target):
            return prefix + b'"' + posixpath.basename(target).encode() + b'"'
        return prefix + (b'"../' + posixpath.basename(target).encode() + b'"' if is_c(target) else b'"../thimble.h"')

    return tree.each_include(tree.read(name), to)


def _opening(what, version):
    return (
        f"// Thimble {version}: {what} Written by `make packages` from the tree; change that, not this.\n"
        "// MIT licence, see LICENSE.\n"
    ).encode()


def files(_):
    version = tree.version()
    refuse_equal_names({name: tree.read(name) for name in tree.sources() if not is_driver(name)})
    header = _Text()
    # The tour of the first page goes first.
    for name in ["include/thimble/thimble.h"] + tree.headers():
        if not is_c(name) and not is_driver(name):
            header.add(name)
    source = _Text(header.done)
    for name in tree.sources():
        if name.endswith(".cpp") and not is_driver(name):
            source.add(name)
    made = {
        "thimble.h": _opening("the public headers, all in one.", version) + b"\n#pragma once\n\n"
        + b"\n".join(header.parts),
        "thimble.cpp": _opening("the core, to be compiled as C++17 beside your own files.", version)
        + b'\n#include "thimble.h"\n\n' + b"\n".join(source.parts),
        **tree.common("pair"),
    }
    for name in tree.headers() + tree.sources():
        if is_driver(name):
            made["drivers/" + posixpath.basename(name)] = _driver(name)
        elif is_c(name):
            made[posixpath.basename(name)] = tree.read(name)
    # Below a folder of its name, so that "thimble/thimble.h" is what it is elsewhere.
    return {"thimble-pair-{version}.zip": tree.below("thimble", made)}
