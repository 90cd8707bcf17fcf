#!/usr/bin/python3
"""What a point of a fluid costs in a step, compared with one of a solid.

    point_costs.py SELKIE

A box of water that shakes on an elastic bed, in 2D and 3D, with the bed making up
1/4, 1/2 and 3/4 of it: CPU seconds of a Newton iteration, and from a straight line
through them the cost of either kind of point. One Markdown row for each dimension.
(doc/performance.md, "What a point costs")
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

SCENE = """
set Title     = Water on an elastic bed
set Dimension = {dim}
set Effects   = inertia, gravity, hydrostatic start
subsection Domain
  set Lower corner = {lower}
  set Upper corner = {upper}
  set Cells        = {cells}
  subsection Walls
{walls}
  end
end
subsection Bodies
  set Names = water, bed
  subsection water
    set Law   = newtonian fluid
    set Shape = box({water})
    subsection Law parameters
      set Bulk modulus = 2e6
    end
  end
  subsection bed
    set Law   = neo hookean
    set Shape = box({bed})
    subsection Law parameters
      set Density       = 2000
      set Young modulus = 1e7
    end
  end
end
subsection Gravity
  set Acceleration = {gravity}
end
subsection Time
  set Step     = 2e-3
  set End time = {end}
end
subsection Output
  set Interval = 0
end
"""


def numbers(values):
    return ", ".join(f"{value:g}" for value in values)


def iteration(selkie, dim, n, bed):
    """(points of water, points of the bed, CPU seconds of a Newton iteration)"""
    def corner(y):  # gravity acts along y; a fifth of the box, on top, is empty
        return [1., y] + [1.] * (dim - 2)

    def floor(y):
        return [0., y] + [0.] * (dim - 2)

    walls = ["left", "right", "bottom", "top"] + ["front", "back"] * (dim - 2)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "bed.prm")
        path.write_text(SCENE.format(
            dim=dim, lower=numbers(floor(0)), upper=numbers(corner(1.25)),
            cells=numbers([n, n * 5 // 4] + [n] * (dim - 2)),
            walls="\n".join(f"    set {wall} = slip" for wall in walls),
            water=numbers(floor(bed) + corner(1)), bed=numbers(floor(0) + corner(bed)),
            gravity=numbers([0, -9.81] + [0] * (dim - 2)), end=0.04))
        subprocess.run([selkie, path, "--output", folder + "/run"], check=True, stdout=subprocess.DEVNULL)
        with open(folder + "/run/statistics.csv") as file:
            newton = sum(int(row["newton iterations"]) for row in csv.DictReader(file))
        with open(folder + "/run/timing.csv") as file:
            sections = {row["path"]: float(row["cpu (s)"]) for row in csv.DictReader(file)}
    points = (2 * n) ** dim
    return points * (1 - bed), points * bed, (sections["total"] - sections["set-up"]) / newton


def main():
    selkie = str(pathlib.Path(sys.argv[1]).resolve())
    print("| | points | solid, µs an iteration | fluid | fluid over solid |\n| --- | --- | --- | --- | --- |")
    for dim, n in ((2, 64), (3, 12)):
        runs = [iteration(selkie, dim, n, bed) for bed in (0.25, 0.5, 0.75)]
        # Least squares for seconds = a water + b bed.
        ww, wb, bb = (sum(r[i] * r[j] for r in runs) for i, j in ((0, 0), (0, 1), (1, 1)))
        ws, bs = (sum(r[i] * r[2] for r in runs) for i in (0, 1))
        det = ww * bb - wb * wb
        water, bed = (ws * bb - bs * wb) / det, (bs * ww - ws * wb) / det
        print(f"| {dim}D | {(2 * n) ** dim} | {1e6 * bed:.1f} | {1e6 * water:.1f} | {water / bed:.2f} |")


if __name__ == "__main__":
    main()
