"""Where src can be changed: operators, comparisons, constants and statements, found in clang's syntax tree.

Clang's own tree (`-ast-dump=json`) says what an operator is and where its operands end, which a tokenizer would have to
guess; clang is there for the fuzzers anyway, and python3-clang, which would be one more package, gives no operators.
"""
import gc
import hashlib
import json
import multiprocessing
import os.path
import pathlib
import re
import subprocess

ROOMS = ("base", "tree", "trace", "picture", "light", "plane", "bake", "c")
COMPARISONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",)}
OPERATORS = {"+": ("-",), "-": ("+",), "*": ("+",), "/": ("*",), "%": ("*",), "&": ("|",), "|": ("&",), "^": ("|",),
             "<<": (">>",), ">>": ("<<",), "&&": ("||",), "||": ("&&",)}
ASSIGNMENTS = {"+=": ("-=",), "-=": ("+=",), "*=": ("+=",), "/=": ("*=",), "%=": ("*=",), "&=": ("|=",), "|=": ("&=",),
               "^=": ("|=",), "<<=": (">>=",), ">>=": ("<<=",)}
STATEMENTS = {"CallExpr", "CXXMemberCallExpr", "CXXOperatorCallExpr", "BinaryOperator", "CompoundAssignOperator",
              "UnaryOperator"}
# What is computed while compiling, or once before a mutant is switched on.
FIXED = {"ConstantExpr", "StaticAssertDecl", "UnaryExprOrTypeTraitExpr", "FieldDecl", "ParmVarDecl", "EnumConstantDecl",
         "AlignedAttr", "TypedefDecl", "TypeAliasDecl", "NonTypeTemplateParmDecl", "CXXCtorInitializer"}


class Mutant:
    """One change. `begin` and `end` are bytes of the file; `alternative` is what stands there instead."""

    def __init__(self, file, function, kind, begin, end, alternative, change, form):
        self.file, self.function, self.kind, self.form = file, function, kind, form
        self.begin, self.end, self.alternative, self.change = begin, end, alternative, change
        self.line, self.text, self.ordinal, self.number = 0, "", 1, 0

    @property
    def room(self):
        return self.file.split("/")[1]

    @property
    def key(self):
        """Survives that lines move: file, function, the line's text, the change, and which of several in it."""
        return (self.file, self.function, self.text, self.change, str(self.ordinal))


class Tree:
    """Reads the syntax tree of one file; collects into `found` (by file, begin, end and change)."""

    def __init__(self, root, sources, found, out):
        self.root, self.sources, self.found, self.out = str(root) + "/", sources, found, out
        self.file = ""

    def place(self, location):
        """Keeps track of the file, which clang only names when it changes. -> bytes of the token, or None in a macro."""
        if "expansionLoc" in location:
            self.place(location["spellingLoc"])
            self.place(location["expansionLoc"])
            return None
        if "file" in location:
            self.file = os.path.normpath(location["file"])
        if "offset" not in location:
            return None
        return location["offset"], location["offset"] + location["tokLen"]

    def visit(self, node, parent, functions, fixed):
        if "loc" in node:
            self.place(node["loc"])
        extent = None
        if "range" in node:
            begin = self.place(node["range"]["begin"])
            file = self.file
            end = self.place(node["range"]["end"])
            if begin and end and file == self.file and file.startswith(self.root + "src/"):
                extent = (file[len(self.root):], begin[0], end[1])
        node["extent"] = extent
        kind = node.get("kind", "")
        if kind in ("FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "CXXConversionDecl"):
            if node.get("name") != "operator()" or not functions:
                functions = functions + (node.get("name", ""),)
        here = fixed or kind in FIXED or node.get("constexpr") or (
            kind == "VarDecl" and (not functions or node.get("storageClass") == "static"))
        children = node.get("inner", [])
        for index, child in enumerate(children):
            condition = kind == "IfStmt" and node.get("isConstexpr") and index == 0
            if child:
                self.visit(child, (node, index), functions, here or condition)
        if extent and functions:
            self.offer(node, kind, parent, functions[-1], here)

    def add(self, node, function, kind, alternative, change, form, fixed):
        file, begin, end = node["extent"]
        if fixed:
            self.out.add((file, begin, end, change))
        else:
            self.found.setdefault((file, begin, end, change), Mutant(file, function, kind, begin, end, alternative,
                                                                    change, form))

    def text(self, node):
        file, begin, end = node["extent"]
        return self.sources[file][begin:end].decode()

    def offer(self, node, kind, parent, function, fixed):
        children = node.get("inner", [])
        if "dependent" in node.get("type", {}).get("qualType", "") and kind not in ("BreakStmt", "ContinueStmt"):
            return  # the instances say what it is
        if kind in ("BinaryOperator", "CompoundAssignOperator"):
            self.binary(node, children, function, fixed)
        elif kind == "UnaryOperator":
            self.unary(node, children, function, fixed)
        elif kind == "IntegerLiteral":
            text = self.text(node)
            if re.fullmatch(r"[0-9][0-9a-fA-FxXuUlLbB']*", text):
                self.add(node, function, "constant", f"{text} + 1", f"{text} to {text} + 1", "value", fixed)
                if int(node.get("value", "0")) > 0:
                    self.add(node, function, "constant", f"{text} - 1", f"{text} to {text} - 1", "value", fixed)
        elif kind == "CXXBoolLiteralExpr":
            text = self.text(node)
            if text in ("true", "false"):
                other = "false" if text == "true" else "true"
                self.add(node, function, "constant", other, f"{text} to {other}", "value", fixed)
        self.statement(node, kind, parent, function, fixed)

    def binary(self, node, children, function, fixed):
        opcode = node.get("opcode")
        group = ("comparison" if opcode in COMPARISONS else "operator")
        others = {**COMPARISONS, **OPERATORS, **ASSIGNMENTS}.get(opcode, ())
        if len(children) != 2 or not all(child.get("extent") for child in children):
            return
        file, begin, end = node["extent"]
        left, right = children[0]["extent"], children[1]["extent"]
        if left[0] != file or right[0] != file or not begin <= left[2] <= right[1] <= end:
            return
        source = self.sources[file]
        gap = source[left[2]:right[1]].decode()
        if gap.count(opcode) != 1:
            return
        for other in others:
            text = source[begin:left[2]].decode() + gap.replace(opcode, other) + source[right[1]:end].decode()
            self.add(node, function, group, text, f"{opcode} to {other}", "value", fixed)

    def unary(self, node, children, function, fixed):
        opcode = node.get("opcode")
        text = self.text(node)
        if opcode in ("-", "~", "!") and text.startswith(opcode):
            self.add(node, function, "operator", text[1:], f"{opcode} dropped", "value", fixed)
        elif opcode in ("++", "--") and text.count(opcode) == 1:
            other = "--" if opcode == "++" else "++"
            self.add(node, function, "operator", text.replace(opcode, other), f"{opcode} to {other}", "value", fixed)

    def statement(self, node, kind, parent, function, fixed):
        within = parent[0].get("kind")
        if kind in ("BreakStmt", "ContinueStmt") and within == "CompoundStmt":
            self.add(node, function, "statement", "", f"{self.text(node)} deleted", "jump", fixed)
        inner = node
        if kind == "ExprWithCleanups" and node.get("inner"):
            inner = node["inner"][0]
        if inner.get("kind") not in STATEMENTS:
            return
        body = within == "CompoundStmt" or (within == "IfStmt" and parent[1] >= 1) or (
            within in ("ForStmt", "WhileStmt", "CXXForRangeStmt") and parent[1] == len(parent[0]["inner"]) - 1)
        if body and not self.text(node).startswith("static_cast<void>"):
            self.add(node, function, "statement", "", "statement deleted", "statement", fixed)


def syntax_tree(root, file):
    done = subprocess.run(["clang++", "-std=c++17", "-ffreestanding", "-w", "-Iinclude", "-fsyntax-only", "-Xclang",
                           "-ast-dump=json", str(pathlib.Path(root, file))], cwd=root, capture_output=True, check=True)
    return json.loads(done.stdout)


def sources_of(root):
    """The bytes of every file of src, by its name from the root; drivers are tested on models, apart from the core."""
    return {str(p.relative_to(root)): p.read_bytes() for p in sorted(root.glob("src/**/*"))
            if p.suffix in (".cpp", ".h") and p.parent.name != "drivers"}


def found_in(work):
    """What one file and the headers of src that it includes hold."""
    root, sources, file = work
    gc.disable()
    found, out = {}, set()
    Tree(root, sources, found, out).visit(syntax_tree(root, file), ({}, 0), (), False)
    return found, out


def find(root, sources, files):
    """-> (all mutants of these files, in order; how many places are out of reach because compilers compute them)"""
    found, out = {}, set()
    with multiprocessing.Pool(2, maxtasksperchild=1) as pool:
        for of_file, out_of_file in pool.imap(found_in, [(root, sources, file) for file in files], chunksize=1):
            found = {**of_file, **found}
            out |= out_of_file
    out -= set(found)
    mutants = sorted(found.values(), key=lambda m: (m.file, m.begin, -m.end, m.change))
    seen = {}
    for mutant in mutants:
        source = sources[mutant.file]
        mutant.line = source.count(b"\n", 0, mutant.begin) + 1
        mutant.last_line = source.count(b"\n", 0, mutant.end) + 1
        first = source.rfind(b"\n", 0, mutant.begin) + 1
        mutant.text = " ".join(source[first:source.find(b"\n", first)].decode().split())
        same = (mutant.file, mutant.function, mutant.text, mutant.change)
        mutant.ordinal = seen[same] = seen.get(same, 0) + 1
    return mutants, len(out)


def digest(*parts):
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def sample(mutants, one_in, seed):
    """One in so many of every file and kind; which ones stays the same while lines move and other places change."""
    strata = {}
    for mutant in mutants:
        strata.setdefault((mutant.file, mutant.kind), []).append(mutant)
    chosen = []
    for stratum in strata.values():
        wanted = -(-len(stratum) // one_in)
        chosen += sorted(stratum, key=lambda m: digest(str(seed), *m.key))[:wanted]
    return chosen

