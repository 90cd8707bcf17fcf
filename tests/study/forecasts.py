#!/usr/bin/python3
"""What `selkie check` and the first steps of a run say of its time, and what it took.

    forecasts.py SELKIE SCENE...

One row of a Markdown table a scene (wall seconds; factors above 1: it took longer).
"""
import argparse
import re
import subprocess
import tempfile
from pathlib import Path

SECONDS = {"s": 1., "min": 60., "h": 3600.}


def seconds(text, word):
    """The first time span after a word at the beginning of a line; None if there is none."""
    line = re.search(rf"^{word}\s+([0-9.e+-]+) (s|min|h)\b", text, re.MULTILINE)
    return float(line[1]) * SECONDS[line[2]] if line else None


def total(folder):
    rows = (folder / "timing.csv").read_text().splitlines()
    names = rows[0].split(",")
    wall = next(i for i, name in enumerate(names) if "wall" in name)
    return next(float(row.split(",")[wall]) for row in rows[1:] if row.startswith("total"))


def cell(forecast, took):
    return f"{forecast:.3g} ({took / forecast:.2f})" if forecast else "none"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("selkie")
    parser.add_argument("scenes", nargs="+", type=Path)
    arguments = parser.parse_args()
    print("| scene | `selkie check` | the run's own | it took |\n| --- | --- | --- | --- |")
    for scene in arguments.scenes:
        check = subprocess.run([arguments.selkie, "check", scene], capture_output=True, text=True, check=True).stdout
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([arguments.selkie, scene, "--output", folder + "/run", "--set", "Output/Interval=0"],
                                 capture_output=True, text=True, check=True).stdout
            took = total(Path(folder) / "run")
        print(f"| {scene.stem} | {cell(seconds(check, 'Time'), took)} | {cell(seconds(run, 'Forecast'), took)} |"
              f" {took:.3g} |", flush=True)


if __name__ == "__main__":
    main()
