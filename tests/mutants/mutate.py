"""Writes a copy of src in which some places can be changed by number, as files that compile as one part each.

    mutate.py ROOT OUT --count 2000 --seed 1     a sample of every file and kind
    mutate.py ROOT OUT --thirty                  thirty of that sample's rooms JUDGED, by a hash of the bytes of src
    mutate.py ROOT OUT --thirty --draw TEXT      the thirty that src would have if its hash were TEXT
    mutate.py ROOT OUT --judged                  all of the sample of which the thirty are
    mutate.py ROOT OUT ... --faults faults.csv   besides these, the faults that the file's rows name

OUT/mutants.json says what was chosen; OUT/part_0.cpp and so on are the core that has it: the whole of it, since a
function of a header is compiled into what includes it, in whichever room that stands.
"""
import argparse
import csv
import json
import os.path
import pathlib
import re
import subprocess

import sites

PARTS = 4
SEED = 1
ONE_IN = 10  # the sample of which --thirty takes thirty
JUDGED = ("base", "bake", "c", "trace")  # rooms of which every survivor was looked at


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
    for number, part in enumerate(parts):
        write(out / part, f"// {state}\n" + "".join(f'#include "{out / f}"\n' for f in files[number::PARTS]))


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


def included(sources, file):
    """The files of src that a file includes, itself among them."""
    found, waiting = set(), [file]
    while waiting:
        name = waiting.pop()
        if name in sources and name not in found:
            found.add(name)
            waiting += [os.path.normpath(os.path.join(os.path.dirname(name), other))
                        for other in re.findall(r'^#include "(.+)"', sources[name].decode(), re.M)]
    return found


def faults(root, sources, path, known):
    """The places that the rows of a file name, in their order; and what is to be said of rows that name none."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))[1:]
    wanted = {row[0] for row in rows} - {m.file for m in known}
    whole = {file: included(sources, file) for file in sources if file.endswith(".cpp")}
    parsed = {next((source for source in whole if file in whole[source]), None) for file in wanted} - {None}
    places = {m.key: m for m in sites.find(root, sources, sorted(parsed))[0] + known}
    chosen, missing = [], []
    for number, row in enumerate(rows, 2):
        if tuple(row[:5]) in places:
            chosen.append(places[tuple(row[:5])])
        else:
            missing.append(f"{path.name}:{number}: {row[0]}: {row[1]} has no such place any more: {row[3]} in {row[2]}")
    return chosen, missing


def main():
    options = argparse.ArgumentParser()
    options.add_argument("root")
    options.add_argument("out")
    options.add_argument("--count", type=int, default=2000)
    options.add_argument("--seed", type=int, default=SEED)
    options.add_argument("--thirty", action="store_true")
    options.add_argument("--judged", action="store_true")
    options.add_argument("--draw", default="")
    options.add_argument("--faults", type=pathlib.Path)
    given = options.parse_args()
    root, out = pathlib.Path(given.root).resolve(), pathlib.Path(given.out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    sources = sites.sources_of(root)
    files = [f for f in sources if f.endswith(".cpp")]
    if given.thirty or given.judged:
        mutants, fixed = sites.find(root, sources, [f for f in files if f.split("/")[1] in JUDGED])
        mutants = [m for m in mutants if m.room in JUDGED]
        total = len(mutants)
        chosen = sites.sample(mutants, ONE_IN, SEED)
        if given.thirty:
            state = given.draw or sites.digest(*(s.decode() for s in sources.values()))
            chosen = sorted(chosen, key=lambda m: sites.digest(state, *m.key))[:40]
    else:
        mutants, fixed = sites.find(root, sources, files)
        total = len(mutants)
        chosen = sites.sample(mutants, max(1, total // given.count), given.seed)
    seeded, missing = faults(root, sources, given.faults, mutants) if given.faults else ([], [])
    drawn = [m for m in chosen if m not in seeded]
    chosen = seeded + drawn
    for number, mutant in enumerate(chosen, 1):
        mutant.number = number
    parts = [f"part_{part}.cpp" for part in range(PARTS)]
    dropped = 0
    while True:
        write_tree(out, sources, parts, chosen)
        drop = refused(root, out, parts, chosen)
        if not drop:
            break
        dropped += len(drop)
        chosen = [m for m in chosen if m not in drop]
    missing += [f"{given.faults.name}: the compiler refuses {m.key}" for m in seeded if m not in chosen]
    if given.thirty:
        chosen = [m for m in chosen if m in seeded] + [m for m in chosen if m in drawn][:30]
        write_tree(out, sources, parts, chosen)
    (out / "mutants.json").write_text(json.dumps({
        "places": total, "compiled_away": fixed, "refused": dropped, "seed": given.seed, "missing": missing,
        "mutants": [{"number": m.number, "room": m.room, "kind": m.kind, "line": m.line, "key": m.key,
                     "is_fault": m in seeded} for m in chosen]}))


main()
