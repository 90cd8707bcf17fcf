#!/usr/bin/python3
"""Whether the timings of a study repeat.

    repetitions.py STUDY_FOLDER...

Of all pairs of members whose medians differ by more than 20 %: how many are in the
same order in every repetition.
"""
import itertools
import json
import pathlib
import statistics
import sys


def timings(folder):
    """CPU seconds of each member, one for each repetition."""
    found = {}
    for file in sorted(folder.glob("*.json")):
        data = json.loads(file.read_text())
        if "cpu" in data and "wall" in data:
            found.setdefault(file.stem.split("_again_")[0], []).append(data["cpu"])
    most = max(map(len, found.values()))
    return {name: times for name, times in found.items() if len(times) == most}


def main():
    for folder in map(pathlib.Path, sys.argv[1:]):
        found = timings(folder)
        pairs = same = 0
        for (a, of_a), (b, of_b) in itertools.combinations(found.items(), 2):
            fast, slow = sorted((statistics.median(of_a), statistics.median(of_b)))
            if slow > 1.2 * fast:
                pairs += 1
                orders = {x < y for x, y in zip(of_a, of_b)}
                same += len(orders) == 1
                if len(orders) > 1:
                    print(f"  {a} {of_a}, {b} {of_b}")
        spread = statistics.median(max(t) / min(t) for t in found.values())
        print(f"{folder.name}: {same} of {pairs} pairs in the same order; largest / smallest time of a "
              f"member {spread:.2f} (median)")


main()
