#!/usr/bin/python3
"""Runs block.prm with two time steps and two point sets, and compares the runs.

    check.py SELKIE

A run and itself must not differ, runs with the steps 2 and 1 ms must differ by
little, and less than 4 and 1 ms do. Prints every figure with its bound; exit code
1 if one is beyond it.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
failures = 0


def check(what, value, bound):
    """Value must not exceed bound (and NaN does)."""
    global failures
    good = value <= bound
    failures += not good
    print(f"{'ok    ' if good else 'FAILED'} {what}: {value:.3e} (bound {bound:.1e})")


def run(*command):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        print(result.stdout)
        sys.exit(f"FAILED {' '.join(command)}: exit code {result.returncode}")
    return result.stdout


def compare(selkie, a, b):
    """{(source, quantity): [relative difference over all times, per time ...]}"""
    screen = run(selkie, "compare", str(a), str(b))
    result = {}
    with open(a / f"compare_{b.name}" / "compare.csv", newline="") as file:
        for row in csv.DictReader(file):
            values = result.setdefault((row["source"], row["quantity"].split(" (")[0]), [None])
            value = float(row["relative L2 difference"])
            if row["time (s)"] == "all":
                values[0] = value
                assert row["quantity"] in screen
            else:
                values.append(value)
    return result


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    selkie = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        def make(name, *settings):
            settings = [word for setting in settings for word in ("--set", setting)]
            run(selkie, str(HERE / "block.prm"), "--output", f"{folder}/{name}", *settings)
            return pathlib.Path(folder) / name

        coarse = make("coarse", "Time/Step=4e-3")
        middle = make("middle", "Time/Step=2e-3")
        fine = make("fine", "Time/Step=1e-3", "Output/Interval=0.01")
        dense = make("dense", "Time/Step=1e-3", "Bodies/block/Points per direction=3")

        same = compare(selkie, fine, fine)
        check("a run and itself, largest of all", max(v[0] for v in same.values()), 1e-6)
        far, near = compare(selkie, coarse, fine), compare(selkie, middle, fine)
        for key in (("probe tip", "displacement x"), ("body block", "displacement"),
                    ("body block", "velocity"), ("body block", "deformation gradient"),
                    ("body water", "displacement"), ("body water", "volume ratio"),
                    ("statistics", "kinetic energy")):
            check(f"{' '.join(key)}, 2 and 1 ms", near[key][0], 0.1)
            check(f"{' '.join(key)}, 2 and 1 ms over 4 and 1 ms", near[key][0] / far[key][0], 0.7)
        missing = 6 - (len(near["body block", "velocity"]) - 1)
        check("pictures at t = 0, 0.02 ... 0.1 s that are not compared", missing, 0)
        check("solid's pressure and fluid's deformation gradient compared",
              sum(k in near for k in (("body block", "pressure"), ("body water", "deformation gradient"))), 0)
        points = compare(selkie, dense, fine)
        check("body block displacement, 3 and 2 points", points["body block", "displacement"][0], 0.1)
    sys.exit(failures > 0)


if __name__ == "__main__":
    main()
