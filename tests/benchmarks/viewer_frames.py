#!/usr/bin/env python3
"""Frame times of the viewer for every file in a folder, as a table with the slowest named.

    python3 tests/benchmarks/viewer_frames.py build/release/thimble DATA_FOLDER [--frames N] [--threads N] [--only WORD]

Each scene turns once around at 1280 x 720, without a screen, then rests until its picture is finished
(thimble view --bench). Files that the command cannot read are counted, not timed. The status is 1 where a median
frame takes longer than a thirtieth of a second.
"""
import argparse
import csv
import os
import subprocess

FRAMES_A_SECOND = 30
COLUMNS = ["file", "voxels", "frames/s", "frame ms", "slowest ms", "engine", "lit s", "finished s"]


def files_in(folder, only):
    found = (os.path.join(path, name) for path, _, names in os.walk(folder) for name in names)
    return sorted(path for path in found if only in path)


def measure(path, arguments):
    """The row of a file, or None where the command has a sentence instead."""
    words = [arguments.program, "view", path, "--bench", str(arguments.frames), "--threads", str(arguments.threads)]
    result = subprocess.run(words, capture_output=True, text=True, timeout=300, check=False)
    if result.returncode == 1:
        return None
    if result.returncode != 0:
        raise SystemExit(f"{' '.join(words)}: status {result.returncode}: {result.stderr}")
    row = next(csv.DictReader(result.stdout.splitlines()))
    return {
        "file": os.path.relpath(path, arguments.folder),
        "voxels": f"{int(row['voxels']):,}",
        "frames/s": f"{float(row['frames_a_second']):.0f}",
        "frame ms": f"{float(row['frame_ms']):.0f}",
        "slowest ms": f"{float(row['slowest_frame_ms']):.0f}",
        "engine": f"{row['engine']} 1:{row['step']}",
        "lit s": f"{float(row['lit_ms']) / 1000:.1f}",
        "finished s": f"{float(row['finished_ms']) / 1000:.1f}",
        "rate": float(row["frames_a_second"]),
        "frame_ms": float(row["frame_ms"]),
        "finished_ms": float(row["finished_ms"]),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", default="", help="files with this in their path")
    arguments = parser.parse_args()
    rows = [measure(path, arguments) for path in files_in(arguments.folder, arguments.only)]
    unread = rows.count(None)
    rows = sorted((row for row in rows if row is not None), key=lambda row: row["rate"])
    if not rows:
        raise SystemExit("no file there can be read")
    print("| " + " | ".join(COLUMNS) + " |")
    print("| --- | ---: | ---: | ---: | ---: | --- | ---: | ---: |")
    for row in rows:
        print("| " + " | ".join(row[name] for name in COLUMNS) + " |")
    slow = [row for row in rows if row["rate"] < FRAMES_A_SECOND]
    last = max(rows, key=lambda row: row["finished_ms"])
    print(f"\n{len(rows)} files, {unread} not read. The slowest: {rows[0]['file']}, {rows[0]['frame_ms']:.0f} ms a frame.")
    print(f"Finished last: {last['file']}, after {last['finished_ms'] / 1000:.1f} s.")
    print(f"Below {FRAMES_A_SECOND} frames a second: {', '.join(row['file'] for row in slow) or 'none'}.")
    raise SystemExit(1 if slow else 0)


main()
