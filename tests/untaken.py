"""The branches of src that no test takes, as gcovr counts them, beside the list that is committed.

    untaken.py GCOVR_JSON LIST [--update]     exit status 1, and a line each, for what is not in LIST

LIST (tests/budgets/untaken.csv) has a row a line of src: file, text, how many of its branches, reason. A line is known by
its text, so that it may move. --update writes LIST anew; rows that were there keep their reasons, others are `open`.
The reasons are words of tests/README.md.
"""
import argparse
import csv
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLUMNS = ("file", "text", "untaken", "reason")
REASONS = ("told", "no-such-value", "checked-before", "too-large", "copies", "invariant", "bounded", "left-inside",
           "counted-twice", "asked-twice", "no-caller", "build", "wanted", "open")


def counted(report):
    """(file, text) -> how many branches of lines with this text are never taken, and of how many."""
    found = {}
    for file in json.loads(report.read_text())["files"]:
        lines = (ROOT / file["file"]).read_text().split("\n")
        for line in file["lines"]:
            branches = line.get("branches", [])
            never = sum(branch["count"] == 0 for branch in branches)
            if never and not line.get("gcovr/noncode"):
                key = (file["file"], lines[line["line_number"] - 1].strip())
                before = found.get(key, (0, 0))
                found[key] = (before[0] + never, before[1] + len(branches))
    return found


def first_guess(file, text, branches):
    """For a row that is new, what its text alone tells."""
    if file in ("src/light/asked.cpp", "src/light/asking.h") or "AskedFrame" in text or "is_answered" in text:
        return "told"
    if text.startswith("switch ("):
        return "no-such-value"
    if re.search(r"UINT32_MAX|SIZE_MAX|== kMaxBricks|kNowhere\)|\+\+shape\.nodes == 0", text):
        return "too-large"
    if re.search(r"status != Status::kOk|!= Status::kOk\)|== Status::kOk\)", text):
        return "checked-before"
    if branches >= 16:
        return "copies"
    return "open"


def main():
    options = argparse.ArgumentParser()
    options.add_argument("report", type=pathlib.Path)
    options.add_argument("list", type=pathlib.Path)
    options.add_argument("--update", action="store_true")
    given = options.parse_args()
    known = {}
    if given.list.is_file():
        with open(given.list, newline="") as file:
            known = {(row["file"], row["text"]): row for row in csv.DictReader(file)}
    found = counted(given.report)
    if given.update:
        with open(given.list, "w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(COLUMNS)
            for (name, text), (never, branches) in sorted(found.items()):
                row = known.get((name, text))
                rows.writerow((name, text, never, row["reason"] if row else first_guess(name, text, branches)))
        return 0
    bad = 0
    for (name, text), (never, _) in sorted(found.items()):
        row = known.get((name, text))
        if row is None or never > int(row["untaken"]):
            said = "none" if row is None else row["untaken"]
            print(f"{name}: {never} branches of `{text}` are never taken, {said} in {given.list.name}", file=sys.stderr)
            bad = 1
    for key, row in known.items():
        if row["reason"] not in REASONS:
            print(f"{key[0]}: `{row['reason']}` is no reason: {key[1]}", file=sys.stderr)
            bad = 1
    reasons = [row["reason"] for row in known.values()]
    print("lines with a branch that no test takes: " +
          ", ".join(f"{reasons.count(reason)} {reason}" for reason in REASONS if reason in reasons))
    return bad


sys.exit(main())
