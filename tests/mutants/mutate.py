"""Writes a copy of src in which some places can be changed by number, as files that compile as one part each.

    mutate.py ROOT OUT --count 2000 --seed 1     a sample of every file and kind
    mutate.py ROOT OUT --quick                   one in ten of every file and kind of the rooms QUICK
    mutate.py ROOT OUT ... --faults faults.csv   besides these, the faults that the file's rows describe

OUT/mutants.json says what was chosen; OUT/part_0.cpp and so on are the core that has it: the whole of it, since a
function of a header is compiled into what includes it, in whichever room that stands.
"""
import argparse
import csv
import json
import pathlib
import re
import subprocess

import sites

PARTS = 4
FLAT = "src/light/flat/"  # one template for all its sets of effects: a part of its own
ONE_IN = 10  # of --quick
QUICK = ("base", "bake", "c", "trace")  # rooms whose tests are quick


def code_only(text):
    """In one line and without comments, since it stands beside other code."""
    return " ".join(re.sub(r"//[^\n]*", "", text).split())


def rendered(source, chosen):
    """The file's bytes with every chosen mutant in it, line for line."""
    groups = {}
    for mutant in chosen:
        groups.setdefault((mutant.begin, -mutant.end), []).append(mutant)
    order = sorted(groups)

    def between(begin, end, inner):
        text, at = "", begin
        while inner:
            first, last = inner[0][0], -inner[0][1]
            nested = [g for g in inner if g[0] < last]
            text += source[at:first].decode() + changed(nested)
            inner, at = inner[len(nested):], last
        return text + source[at:end].decode()

    def changed(nested):
        begin, end = nested[0][0], -nested[0][1]
        text = between(begin, end, nested[1:])
        for mutant in sorted(groups[nested[0]], key=lambda m: m.form == "statement"):
            on = f"THIMBLE_MUTANT({mutant.number})"
            if mutant.form == "value":
                text = f"({on} ? ({code_only(mutant.alternative)}) : {text})"
            elif mutant.form == "statement":
                text = f"({on} ? static_cast<void>(0) : static_cast<void>({text}))"
            elif mutant.form == "fault":
                text = f"if ({on}) {{ {mutant.alternative} }} else {{ {text} }}"
            else:
                text = f"if (!{on}) {text}"
        return text

    return between(0, len(source), order)


def write(path, text):
    """Only what differs, so that only that is compiled."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)


def write_tree(out, sources, parts, chosen):
    by_file = {}
    for mutant in chosen:
        by_file.setdefault(mutant.file, []).append(mutant)
    texts = {file: rendered(source, by_file[file]) if file in by_file else source.decode()
             for file, source in sources.items()}
    for file, text in texts.items():
        write(out / file, text)
    # A build tool knows the parts alone: they change with what they include.
    state = sites.digest(*texts.values())
    files = [file for file in sources if file.endswith(".cpp")]
    flat = [file for file in files if file.startswith(FLAT)]
    others = [file for file in files if file not in flat]
    for number, part in enumerate(parts):
        held = others[number::PARTS] if number < PARTS else flat
        write(out / part, f"// {state}\n" + "".join(f'#include "{out / f}"\n' for f in held))


def refused(root, out, parts, chosen):
    """Mutants on lines at which the compiler refuses the copy: constants that it needs, say."""
    drop = set()
    for file in parts:
        done = subprocess.run(["clang++", "-std=c++17", "-ffreestanding", "-w", "-Wno-c++11-narrowing", "-ferror-limit=0",
                               "-I" + str(root / "include"), "-include", str(root / "tests/mutants/mutant.h"),
                               "-fsyntax-only", str(out / file)], capture_output=True, text=True)
        for path, line in re.findall(r"^(\S+?):(\d+):\d+: (?:error|note)", done.stderr, re.M):
            name = str(pathlib.Path(path).resolve())
            drop |= {m for m in chosen if name == str(out / m.file) and m.line <= int(line) <= m.last_line}
        if done.returncode != 0 and not drop:
            raise SystemExit(f"mutate: {file}: {done.stderr}")
    return drop


def pattern_of(code):
    """Finds code however its lines are broken and indented."""
    tokens = re.findall(r"\w+|\S", code)
    edges = [r"\b" if re.match(r"\w", token) else "" for token in (tokens[0], tokens[-1])]
    return re.compile(edges[0] + r"\s*".join(map(re.escape, tokens)) + edges[1])


def faults(sources, path):
    """The places that the rows of a file describe; and what is to be said of rows that describe no place, or several."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))[1:]
    texts = {file: source.decode("latin-1") for file, source in sources.items()}  # a character a byte
    chosen, missing = [], []
    for number, (code, faulty, what) in enumerate(rows, 2):
        places = [(file, m) for file, text in texts.items() for m in pattern_of(code).finditer(text)]
        if len(places) != 1:
            where = "".join(f", {file}:{texts[file].count(chr(10), 0, m.start()) + 1}" for file, m in places)
            missing.append(f"{path.name}:{number}: this code stands {len(places)} times in src{where}, not once: {code} "
                           f"-- describe where it is possible today that {what}")
            continue
        file, m = places[0]
        form = "fault" if code.endswith((";", "}")) else "value"
        mutant = sites.Mutant(file, what, "fault", m.start(), m.end(), faulty, f"to {faulty or 'nothing'}", form)
        mutant.text = " ".join(code.split())
        mutant.line = texts[file].count("\n", 0, m.start()) + 1
        mutant.last_line = texts[file].count("\n", 0, m.end()) + 1
        chosen.append(mutant)
    return chosen, missing


def main():
    options = argparse.ArgumentParser()
    options.add_argument("root")
    options.add_argument("out")
    options.add_argument("--count", type=int, default=2000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--quick", action="store_true")
    options.add_argument("--faults", type=pathlib.Path)
    given = options.parse_args()
    root, out = pathlib.Path(given.root).resolve(), pathlib.Path(given.out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    sources = sites.sources_of(root)
    files = [f for f in sources if f.endswith(".cpp")]
    if given.quick:
        files = [f for f in files if f.split("/")[1] in QUICK]
    mutants, fixed = sites.find(root, sources, files)
    mutants = [m for m in mutants if not given.quick or m.room in QUICK]
    total = len(mutants)
    chosen = sites.sample(mutants, ONE_IN if given.quick else max(1, total // given.count), given.seed)
    seeded, missing = faults(sources, given.faults) if given.faults else ([], [])
    chosen = seeded + chosen
    for number, mutant in enumerate(chosen, 1):
        mutant.number = number
    parts = [f"part_{part}.cpp" for part in (*range(PARTS), "flat")]
    dropped = 0
    while True:
        write_tree(out, sources, parts, chosen)
        drop = refused(root, out, parts, chosen)
        if not drop:
            break
        dropped += len(drop)
        chosen = [m for m in chosen if m not in drop]
    missing += [f"{given.faults.name}: the compiler refuses {m.key}" for m in seeded if m not in chosen]
    (out / "mutants.json").write_text(json.dumps({
        "places": total, "compiled_away": fixed, "refused": dropped, "seed": given.seed, "missing": missing,
        "mutants": [{"number": m.number, "room": m.room, "kind": m.kind, "line": m.line, "key": m.key,
                     "is_fault": m in seeded} for m in chosen]}))


main()
