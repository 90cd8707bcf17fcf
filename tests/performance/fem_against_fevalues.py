#!/usr/bin/env python3
"""Selkie's `q4 fem` against a loop with deal.II's FEValues: CPU time.

usage: fem_against_fevalues.py SELKIE FEVALUES_LOOP [PAIRS]

Runs both programs in turn, PAIRS times (3) for each problem, on one core, and
prints a Markdown table: CPU microseconds per unknown and Newton iteration,
assembly / solution with Newton's overhead / together; medians, the ratio of
the medians, the ratio of each pair in order.
"""

import csv
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
COOK = TOP / "prm/benchmarks/cook_membrane.prm"
BLOCK = TOP / "tests/performance/block.prm"
COOK_LAW = ["Bodies/panel/Law=neo hookean", "Output/Interval=0"]

# name, arguments of the loop, scene, settings of the scene
PROBLEMS = [
    ("Cook 64², MUMPS", ["cook", "64", "direct"], COOK,
     ["Domain/Mesh/Global refinements=6", "Linear solver/Solver=direct", *COOK_LAW]),
    ("Cook 64², CG with ML", ["cook", "64", "amg"], COOK,
     ["Domain/Mesh/Global refinements=6", "Linear solver/Solver=cg ml", *COOK_LAW]),
    ("Cook 128², MUMPS", ["cook", "128", "direct"], COOK,
     ["Domain/Mesh/Global refinements=7", "Linear solver/Solver=direct", *COOK_LAW]),
    ("Cook 128², CG with ML", ["cook", "128", "amg"], COOK,
     ["Domain/Mesh/Global refinements=7", "Linear solver/Solver=cg ml", *COOK_LAW]),
    ("sheared cube 16³, CG with ML", ["block", "16", "amg"], BLOCK, []),
]

ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")


def run(command):
    return subprocess.run(["taskset", "-c", "1", *map(str, command)], env=ENVIRONMENT,
                          check=True, capture_output=True, text=True).stdout


def time_loop(program, arguments):
    text = run([program, *arguments])
    return tuple(float(re.search(rf"{part} (\S+) us", text)[1])
                 for part in ("assembly", "solution", "together"))


def time_selkie(program, scene, settings):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, scene, "--output", folder]
        for setting in settings:
            command += ["--set", setting]
        text = run(command)
        with open(pathlib.Path(folder) / "timing.csv", encoding="utf-8") as file:
            cpu = {row["path"]: float(row["cpu (s)"]) for row in csv.DictReader(file)}
    steps = re.findall(r"Newton (\d+) .* unknowns (\d+)", text)
    work = sum(int(iterations) * int(unknowns) for iterations, unknowns in steps)
    assembly = 1e6 * (cpu["newton/residual"] + cpu["newton/tangent"]) / work
    together = 1e6 * (cpu["newton"] + cpu["supports"]) / work
    return assembly, together - assembly, together


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    selkie, loop = map(os.path.abspath, sys.argv[1:3])
    pairs = int(sys.argv[3]) if len(sys.argv) == 4 else 3
    print("| problem, solver | FEValues loop | Selkie | ratio | the pairs |")
    print("| --- | --- | --- | --- | --- |")
    for name, arguments, scene, settings in PROBLEMS:
        theirs, ours = [], []
        for _ in range(pairs):
            theirs.append(time_loop(loop, arguments))
            ours.append(time_selkie(selkie, scene, settings))
        median = [[statistics.median(run[part] for run in runs) for part in range(3)]
                  for runs in (theirs, ours)]
        ratios = ", ".join(f"{b[2] / a[2]:.2f}" for a, b in zip(theirs, ours))
        cells = [" / ".join(f"{value:.2f}" for value in values) for values in median]
        print(f"| {name} | {cells[0]} | {cells[1]} | {median[1][2] / median[0][2]:.2f} "
              f"| {ratios} |", flush=True)


if __name__ == "__main__":
    main()
