#!/usr/bin/python3
"""Prints a study over time step, LME gamma and points per cell as a map.

    stability_map.py STUDY.csv

One Markdown table for each number of points, a row for each gamma, a column for
each time step: error (CPU seconds), or why the member failed.
"""
import csv
import re
import sys


def setting(row, name):
    """The last value that a parameter gets."""
    return re.findall(re.escape(name) + r"=([^&]+)", row["settings"])[-1].strip()


def cell(row):
    if row["failure"]:
        return "**" + row["failure"].split(".")[0].split(":")[-1].strip() + "**"
    return f"{float(row['error']):.1e} ({float(row['cpu (s)']):.1f} s)"


def main():
    with open(sys.argv[1]) as file:
        rows = list(csv.DictReader(file))
    keys = ("Points per direction", "LME/Gamma", "Time/Step")
    points, gammas, steps = (
        sorted({setting(row, key) for row in rows}, key=float) for key in keys)
    found = {tuple(setting(row, key) for key in keys): cell(row) for row in rows}
    for n in points:
        print(f"{n} points a direction:\n")
        print("| γ̂ | " + " | ".join(f"Δt = {float(dt) * 1e3:g} ms" for dt in steps) + " |")
        print("| --- |" + " --- |" * len(steps))
        for gamma in gammas:
            print(f"| {gamma} | "
                  + " | ".join(found.get((n, gamma, dt), "–") for dt in steps) + " |")
        print()


if __name__ == "__main__":
    main()
