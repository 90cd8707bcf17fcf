#!/usr/bin/python3
"""Orders of convergence with the manufactured solution.

    manufactured.py orders SELKIE        finite elements and LME-MPM, with bounds
    manufactured.py sweep SELKIE CSV     all approximations: one row a run in CSV
    manufactured.py causes SELKIE CSV    what the error of LME-MPM consists of

Errors are those of probes/displacement.csv: L2 norm over sqrt(volume) and largest
of all points, over the amplitude A; at half a period, where the exact
displacement is zero, and the largest of all times.
"""
import csv
import math
import re

from check import BENCHMARKS, check, main, run, table

COLUMNS = ("L2", "largest", "L2 of all times", "largest of all times")


def scene(folder, amplitude):
    """The shipped scene with another amplitude."""
    text = (BENCHMARKS / "manufactured.prm").read_text()
    text = text.replace("0.05*", f"{amplitude!r}*")
    path = folder / "scene.prm"
    path.write_text(re.sub(r"(?<![.\d])5\*pi", f"{100 * amplitude!r}*pi", text))
    return path


def errors(selkie, folder, cells, approximation, settings=(), amplitude=0.05, steps=4):
    """[L2, largest, L2 of all times, largest of all times], relative. `steps` a cell."""
    run(selkie, scene(folder, amplitude), folder / "run",
        (f"Approximation={approximation}", f"Domain/Cells={cells}, {cells}",
         f"Time/Step={0.01 / (steps * cells)!r}", *settings))
    p = table(folder / "run" / "probes" / "displacement.csv")
    names = ("L2 error", "largest error")
    return [p[name][-1] / amplitude for name in names] \
        + [max(p[name]) / amplitude for name in names]


def points(gamma, n):
    return (f"LME/Gamma={gamma}", f"Bodies/block/Points per direction={n}")


def order(coarse, fine):
    return math.log2(coarse / fine)


def write_series(selkie, folder, path, series, cells=(8, 16, 32)):
    """Runs {label: arguments of errors()} with each number of cells; prints the
    orders between them."""
    with open(path, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(("series", "cells", *COLUMNS))
        for label, (approximation, *rest) in series.items():
            previous = None
            for n in cells:
                found = errors(selkie, folder, n, approximation, *rest)
                out.writerow((label, n, *found))
                file.flush()
                orders = [order(a, b) for a, b in zip(previous, found)] if previous else []
                print(f"{label:42s} {n:3d}  " + "  ".join(f"{e:.2e}" for e in found)
                      + "   orders " + " ".join(f"{o:5.2f}" for o in orders), flush=True)
                previous = found


def orders(selkie, folder):
    """Finite elements: second order. So are material points as long as they stay
    where they were put (A/100: within 1 % of a cell); how much of that crossing
    cells costs is seen in the sweep, here the error still has to fall.
    """
    series = {"Q4 FEM": ("q4 fem",), "LME-MPM 3, 2x2, A/100": ("lme mpm", points(3, 2), 0.0005)}
    for label, arguments in series.items():
        found = [errors(selkie, folder, n, *arguments) for n in (8, 16, 32)[:2 + ("FEM" in label)]]
        for coarse, fine in zip(found, found[1:]):
            for name, a, b in zip(COLUMNS, coarse, fine):
                check(f"{label}, {name} error {a:.2e} to {b:.2e}: order - 2", order(a, b) - 2, 0.15)
    coarse, fine = (errors(selkie, folder, n, "lme mpm", points(3, 2)) for n in (8, 16))
    check(f"LME-MPM 3, 2x2, L2 error {coarse[0]:.2e} to {fine[0]:.2e}: ratio",
          fine[0] / coarse[0], 0.75)


def sweep(selkie, folder, path):
    """All approximations, for scripts/plots/manufactured."""
    series = {"Q4 FEM": ("q4 fem",)}
    for n in (2, 3, 4):
        series[f"Q4 MPM, {n}x{n}"] = ("q4 mpm", points(3, n)[1:])
        for gamma in (0.8, 1.8, 3):
            series[f"LME-MPM {gamma}, {n}x{n}"] = ("lme mpm", points(gamma, n))
    write_series(selkie, folder, path, series)


def causes(selkie, folder, path):
    """What the error of LME-MPM (gamma = 3, 2x2) consists of: one thing changed at a
    time, with points that cross cells and, A/100, with points that do not.
    """
    series = {}
    for A, name in ((0.05, "A"), (0.0005, "A/100")):
        series[name] = ("lme mpm", points(3, 2), A)
        series[name + ", half the step"] = ("lme mpm", points(3, 2), A, 8)
        series[name + ", TPIC"] = ("lme mpm", (*points(3, 2), "Transfer/Scheme=tpic"), A)
        series[name + ", consistent mass"] = \
            ("lme mpm", (*points(3, 2), "Inertia/Mass=consistent"), A)
    write_series(selkie, folder, path, series)


if __name__ == "__main__":
    main(globals())
