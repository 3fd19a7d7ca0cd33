"""Tries every mutant that mutate.py chose: runs the tests that come by its place, the fastest first, until one fails.

    run.py PROGRAM WORK [--check] [--only TEXT] [--faults]

WORK holds mutants.json; WORK/results.csv is written. What survives is printed. With --check the exit status is 1 when
less than 90 per cent of all are killed, those included that nobody could tell from the core. With --faults it tries the
faults of faults.csv instead, writes WORK/faults.csv, and the exit status is 1 unless there are twenty or more and each
of them is killed.
"""
import argparse
import csv
import json
import os
import pathlib
import queue
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as xml

HERE = pathlib.Path(__file__).parent
ROOMS = ("base", "tree", "trace", "picture", "light", "plane", "bake", "c", "misuse")
TOLD = "*/wide/test_wide_lit.cpp"  # frames of the core that the wide renderer tells what their rays meet
WANTED = 90  # per cent of all
FAULTS = 20
AT_MOST_MS = 5000  # of tests a mutant, of the processor, of its own rooms and again of the others
SLOW_CPU_MS = 4000  # a test that takes longer is left out
AT_ONCE = 100  # tests after which what is known is kept


class Runner:
    """A program that runs one test at a time in a child of its own."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "--serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.groups = [int(count) for count in self.process.stdout.readline().split()]

    def ask(self, *words):
        self.process.stdin.write("\t".join(words) + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().split()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def in_two(runners, work, do, title):
    """do(runner, item) for every item, each runner in a thread of its own; says how far it is."""
    waiting, done, started = queue.Queue(), [0], time.time()
    for item in work:
        waiting.put(item)

    def loop(runner):
        while True:
            try:
                item = waiting.get_nowait()
            except queue.Empty:
                return
            do(runner, item)
            done[0] += 1

    threads = [threading.Thread(target=loop, args=(runner,)) for runner in runners]
    for thread in threads:
        thread.start()
    said = 0.0
    while any(thread.is_alive() for thread in threads):
        time.sleep(0.1)
        if time.time() - said > (1 if sys.stderr.isatty() else 10):
            said = time.time()
            print(f"{title}: {done[0]} of {len(work)}, {said - started:.0f} s", file=sys.stderr,
                  end="\r" if sys.stderr.isatty() else "\n")
    for thread in threads:
        thread.join()


def slow_names():
    lines = (HERE.parent / "slow_cases.txt").read_text().splitlines()
    return tuple(line for line in lines if line and not line.startswith("#"))


def all_tests(program, groups, quick):
    tests = [f"p:{group}:{index}" for group, count in enumerate(groups) for index in range(count)]
    for files in [f"*/{room}/test_*" for room in ROOMS] + [TOLD]:
        said = subprocess.run([program, f"--source-file={files}", "--list-test-cases", "-r=xml"],
                              capture_output=True, text=True, check=True).stdout
        for case in xml.fromstring(said).iter("TestCase"):
            file = pathlib.PurePath(case.get("filename"))
            if quick and (case.get("name").startswith(slow_names()) or file.parent.name == "misuse"):
                continue
            # A comma or a colon would end the name.
            name = case.get("name").replace(",", "?").replace(":", "?").replace("\\", "?")
            tests.append(f"d:{file.parent.name}/{file.name}:{name}")
    return list(dict.fromkeys(tests))  # a file that is there twice is one


class Cover:
    """Which tests come by which mutant, and what each takes."""

    def __init__(self, kept):
        self.ms, self.crc, self.of, self.kills = {}, {}, {}, {}
        self.kept = kept
        self.most_ms = AT_MOST_MS
        self.load(kept)

    def add(self, runners, tests):
        tests = [t for t in tests if t not in self.ms]
        for first in range(0, len(tests), AT_ONCE):
            some = tests[first:first + AT_ONCE]
            in_two(runners, some, self.note, f"tests without a mutant, {first} done of {len(tests)}")
            # Beside it and then in its place, so that who interrupts this loses no more than these.
            beside = self.kept.with_suffix(".new")
            beside.write_text(json.dumps([self.ms, self.crc, sorted(self.of.items())]))
            beside.replace(self.kept)

    def load(self, kept):
        """What the same program has noted before."""
        if kept.is_file():
            self.ms, self.crc, of = json.loads(kept.read_text())
            self.of = dict(of)

    def note(self, runner, test):
        result, ms, crc, *numbers = runner.ask("cover", str(SLOW_CPU_MS), test)
        self.ms[test] = int(ms)
        if result == "failed" or result == "crashed":
            print(f"mutants: left out, since it fails without a mutant: {test}", file=sys.stderr)
        if result != "ok":
            return  # or too slow to be tried again and again
        self.crc[test] = crc
        for number in numbers:
            self.of.setdefault(int(number), []).append(test)

    def tests(self, mutant):
        """The fastest first; but for three that killed neighbours."""
        done = mutant["done"]
        order = sorted((t for t in self.of.get(mutant["number"], []) if t not in done), key=lambda t: self.ms[t])
        near = self.kills.get(mutant["key"][0], {})
        first = sorted((t for t in near if t in order), key=lambda t: -near[t] / (self.ms[t] + 5))[:3]
        chosen, total = [], sum(self.ms.get(t, 0) for t in done)
        for test in first + [t for t in order if t not in first]:
            total += self.ms[test]
            if total > self.most_ms and (chosen or done):
                break
            chosen.append(test)
        done += chosen
        return chosen


def try_one(runner, mutant, cover):
    tests = cover.tests(mutant)
    words = []
    for test in tests:
        words += [str(4 * cover.ms[test] + 1000), test + (f":{cover.crc[test]}" if test[0] == "p" else "")]
    mutant["tests"] += len(tests)
    if not tests:
        mutant.update(result="survived", by="", ms=0)
        return
    answer = runner.ask("try", str(mutant["number"]), *words)
    if answer[0] == "survived":
        mutant.update(result="survived", by="", ms=int(answer[1]))
        return
    test = tests[int(answer[1])]
    near = cover.kills.setdefault(mutant["key"][0], {})
    near[test] = near.get(test, 0) + 1
    mutant.update(result=answer[2], by=test, ms=int(answer[3]))


def table(mutants):
    rows = {}
    for mutant in mutants:
        for name in (mutant["room"], "all"):
            row = rows.setdefault(name, {"killed": 0, "survived": 0})
            row["survived" if mutant["result"] == "survived" else "killed"] += 1
    print(f"{'room':10}{'mutants':>9}{'killed':>9}{'survived':>10}{'per cent':>10}")
    for name in sorted(rows, key=lambda n: (n == "all", n)):
        killed, survived = rows[name].values()
        print(f"{name:10}{killed + survived:9}{killed:9}{survived:10}{100 * killed / (killed + survived):10.1f}")
    return rows.get("all", {"killed": 0, "survived": 0})


def main():
    options = argparse.ArgumentParser()
    options.add_argument("program")
    options.add_argument("work", type=pathlib.Path)
    options.add_argument("--check", action="store_true")
    options.add_argument("--quick", action="store_true")
    options.add_argument("--only", default="")
    options.add_argument("--faults", action="store_true")
    given = options.parse_args()
    os.environ["THIMBLE_FEW"] = "1"  # a case that draws a million pixels draws fewer
    chosen = json.loads((given.work / "mutants.json").read_text())
    mutants = [m for m in chosen["mutants"] if given.only in m["key"][0] and m["is_fault"] == given.faults]
    runners = [Runner(given.program) for _ in range(2)]
    stat = os.stat(given.program)
    for old in list(given.work.glob("cover-*")) + list(given.work.glob("tried-*")):
        if f"-{stat.st_mtime_ns}." not in old.name:
            old.unlink()
    cover = Cover(given.work / f"cover-{stat.st_mtime_ns}.json")
    # What an interrupted run of the same program has tried is not tried again: of what survived, the tests so far.
    kept = given.work / f"tried-{stat.st_mtime_ns}.jsonl"
    tried = {}
    if kept.is_file():
        tried = {one["number"]: one for one in map(json.loads, kept.read_text().splitlines())}
    tests = all_tests(given.program, runners[0].groups, given.quick)
    for mutant in mutants:
        mutant.update(tried.get(mutant["number"], {"result": "", "tests": 0, "done": []}))
    with open(kept, "a") as keep:

        def note(mutant):
            kept_of = ("number", "result", "by", "ms", "tests", "done")
            keep.write(json.dumps({name: mutant[name] for name in kept_of}) + "\n")
            keep.flush()

        def attempt(runner, mutant):
            try_one(runner, mutant, cover)
            note(mutant)

        # The portable cases, which are quick; the tests of the rooms of what survives; then the others.
        for turn in range(3):
            waiting = [m for m in mutants if m["result"] in ("", "survived")]
            rooms = {m["room"] for m in waiting}
            some = [t for t in tests if turn == 2 or t[0] == "p" or (turn == 1 and t[2:].split("/")[0] in rooms)]
            if waiting:
                cover.add(runners, some)
                in_two(runners, waiting, attempt, "mutants")
            cover.most_ms += AT_MOST_MS
    for runner in runners:
        runner.close()
    if any(not m["result"] for m in mutants):
        raise SystemExit("mutants: the program that runs the tests ended before its time")
    with open(given.work / ("faults.csv" if given.faults else "results.csv"), "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("number", "file", "line", "function", "text", "change", "of_these", "kind", "result", "ms", "tests", "by"))
        for m in mutants:
            file_name, function, text, change, ordinal = m["key"]
            rows.writerow((m["number"], file_name, m["line"], function, text, change, ordinal, m["kind"], m["result"],
                           m["ms"], m["tests"], m["by"]))
    for m in mutants:
        if m["result"] == "survived":
            print(f"{m['key'][0]}:{m['line']}: {m['key'][1]}: {m['key'][3]} (number {m['key'][4]} in the line) survives "
                  f"{m['tests']} tests: {m['key'][2]}")
    row = table(mutants)
    print(f"{chosen['places']} changes could be made, {chosen['compiled_away']} more are computed by compilers, "
          f"{chosen['refused']} were refused by one; seed {chosen['seed']}")
    if given.faults:
        for text in chosen["missing"]:
            print(text)
        if chosen["missing"] or row["survived"] or row["killed"] < FAULTS:
            raise SystemExit(f"mutants: tests/mutants/faults.csv has to describe {FAULTS} faults or more, each of them has "
                             "to be there and to be killed: mend its row, or add a test")
    elif given.check and 100 * row["killed"] < WANTED * len(mutants):
        raise SystemExit(f"mutants: fewer than {WANTED} per cent are killed: test what survives")


main()
