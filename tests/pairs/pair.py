#!/usr/bin/python3
"""One scene by LME-MPM (A) and by finite elements (B), compared by the program.

    pair.py CASE SELKIE

CASE is a function of this file, whose docstring says how much the two may differ
and why. Prints every figure with its bound; exit code 1 if one is beyond it.
"""
import csv
import math
import pathlib
import subprocess
import sys
from collections import namedtuple

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenes"))
import manufactured as mms  # noqa: E402
from check import BENCHMARKS, bar, check, main, run, table  # noqa: E402

Difference = namedtuple("Difference", "relative largest scale")  # L2, absolute, of A


def compare(selkie, a, b):
    """{(source, quantity): {time or "all": Difference}}"""
    subprocess.run([selkie, "compare", str(a), str(b)], check=True, stdout=subprocess.DEVNULL)
    result = {}
    with open(a / f"compare_{b.name}" / "compare.csv", newline="") as file:
        next(file)
        for source, quantity, time, relative, largest, _, scale in csv.reader(file):
            rows = result.setdefault((source, quantity.split(" (")[0]), {})
            rows[time if time == "all" else float(time)] = \
                Difference(float(relative), float(largest), float(scale))
    return result


def pair(selkie, folder, scene, settings=(), lme=(), fem=()):
    """Runs both; returns their folders and what they differ in."""
    folders = []
    for approximation, own in (("lme mpm", lme), ("q4 fem", fem)):
        folders.append(folder / approximation.replace(" ", "_"))
        run(selkie, BENCHMARKS / scene, folders[-1],
            (f"Approximation={approximation}", *settings, *own), picture=True)
    return (*folders, compare(selkie, *folders))


def probe(folder, name):
    return table(folder / "probes" / (name + ".csv"))


def vibrating_bar(selkie, folder):
    """Both are of second order, so their difference is: a quarter at half of h.

    By finite elements the errors are known in closed form: the consistent mass
    makes the period too short by (k h)^2/24, the trapezoidal rule too long by
    (w dt)^2/12, and interpolating the initial velocity loses the share (k h)^2/6
    of the energy. LME-MPM (lumped, wide functions) is too slow by 9e-3 at 8 cells,
    which after two periods is 0.11 of the velocity's amplitude.
    """
    found = {}
    for cells in (8, 16):
        for approximation in ("lme mpm", "q4 fem"):
            found[approximation, cells] = bar(
                selkie, folder / f"{approximation} {cells}", cells,
                settings=(f"Approximation={approximation}",))
        kh, wdt = math.pi / 50 * 25 / cells, 2 * math.pi / 10 * 1.28 / cells
        period, velocity, energy = found["q4 fem", cells]
        exact = wdt**2 / 12 - kh**2 / 24
        check(f"{cells} elements: period {period:+.3e} against {exact:+.3e}",
              period / exact - 1, 0.05)
        check(f"{cells} elements: energy {energy:+.3e} against {-kh**2 / 6:+.3e}",
              energy / (-kh**2 / 6) - 1, 0.05)
        difference = compare(selkie, folder / f"lme mpm {cells}", folder / f"q4 fem {cells}")
        found[cells] = (found["lme mpm", cells][0] - period,
                        difference["statistics", "momentum x"]["all"].relative)
    for name, bound, coarse, fine in zip(("periods", "momenta"), (0.01, 0.11), found[8], found[16]):
        check(f"difference of the {name}, 8 cells", coarse, bound)
        check(f"difference of the {name}, 16 over 8 cells", fine / coarse, 0.3)


def cantilever(selkie, folder):
    """The difference is the mesh's, and halves at least when h does.

    At h = 1/8 eight bilinear elements over the depth are 1 to 2 % too stiff in
    bending; both tend to the same curve.
    """
    difference = []
    for cells in ("40, 28", "80, 56"):
        *_, differences = pair(
            selkie, folder / cells, "cantilever.prm",
            (f"Domain/Cells={cells}", "Probes/tip/Shape=box(3.875, 0, 4, 1)",
             "Time/End time=0.54", "Output/Interval=0"))
        tip = differences["probe tip", "displacement y"]["all"]
        difference.append(tip.largest / tip.scale)
    check("difference at h = 1/8, of the largest deflection", difference[0], 0.03)
    check("ratio of the differences at 1/16 and 1/8", difference[1] / difference[0], 0.6)


def hydrostatic_column(selkie, folder):
    """Come to rest under a large viscosity: both within 1 % of the closed form.

    The problem is one-dimensional and smooth, so the fields differ by less than
    the 1 % that either may be off.
    """
    *folders, difference = pair(
        selkie, folder, "hydrostatic_column.prm",
        ("Bodies/water/Law parameters/Viscosity=1e4", "Time/End time=0.25"))
    for out in folders:
        p = probe(out, "surface")
        Y = p["position y"][0]
        exact = -sum(1 - (1 + 7 * 997.5 * 9.81 * (0.6 - Y * (i + 0.5) / 100) / 2e6)**(-1 / 7)
                     for i in range(100)) * Y / 100
        check(f"settlement at Y = {Y:.3f} m, {out.name}", p["displacement y"][-1] / exact - 1, 0.01)
        check(f"force on the floor, {out.name}",
              probe(out, "bottom_force")["force y"][-1] / (-997.5 * 9.81 * 0.6 * 0.24) - 1, 0.01)
    for key in (("body water", "displacement"), ("body water", "pressure"),
                ("probe bottom_force", "force y"), ("statistics", "compression energy")):
        check(" ".join(key), difference[key]["all"].relative, 0.01)


def elliptical_drop(selkie, folder):
    """To A0 t = 0.5: both within 0.5 % of the exact axes.

    The mesh of the disc is a polygon whose second moments are 0.1 % short; the
    material points' stepped edge is as good.
    """
    exact = {"x": 0.62705, "y": 1.59476}
    *folders, difference = pair(
        selkie, folder, "elliptical_drop.prm",
        ("Time/End time=0.005",),
        fem=("Domain/Mesh/Generator=hyper_ball_balanced", "Domain/Mesh/Arguments=0, 0 : 1",
             "Domain/Mesh/Global refinements=3"))
    for out in folders:
        drop = probe(out, "drop")
        for axis, value in exact.items():
            check(f"semi-axis {axis}, {out.name}",
                  drop["semi-axis " + axis][-1] / value - 1, 5e-3)
    for axis in exact:
        check(f"semi-axis {axis}, difference",
              difference["probe drop", "semi-axis " + axis]["all"].relative, 5e-3)
    for quantity in ("displacement", "velocity"):
        if ("body drop", quantity) in difference:
            check(quantity, difference["body drop", quantity]["all"].relative, 0.02)


def dam_break(selkie, folder):
    """To t = 0.14 s, T = 1.6; then elements of the front's tip turn over.

    Fronts differ by less than half a cell, which is how far the first material
    point may be from where the water ends; velocities by 3 %.
    """
    *_, difference = pair(selkie, folder, "dam_break.prm", ("Time/End time=0.14",))
    half_cell = 0.146 / 24
    check("front, over half a cell",
          difference["probe front", "front x"]["all"].largest / half_cell, 1)
    check("velocity", difference["body water", "velocity"]["all"].relative, 0.03)
    for name in ("kinetic energy", "potential energy"):
        check(name, difference["statistics", name]["all"].relative, 0.02)


def dam_break_obstacle(selkie, folder):
    """The water's fall to t = 0.02 s, on a mesh that fits water and obstacle.

    Its cells are 2 x 4 mm; material points keep their cells of 6 mm, of which half
    a one is what the fronts may differ by. A step of 1 ms is 20 sound crossings of
    a fine cell, and the mesh of the front's tip suffers: at 0.04 s velocities differ
    by 15 %, at 0.048 s it needs steps of 0.4 ms. Water and obstacle would meet at
    0.146 s, and two meshes that do not share nodes there would not notice.
    """
    *folders, difference = pair(
        selkie, folder, "dam_break_obstacle.prm",
        ("Time/End time=0.02",),
        fem=("Domain/Cells=292, 110", "Domain/Upper corner=0.584, 0.44"))
    check("front, over half a cell",
          difference["probe front", "front x"]["all"].largest / (0.584 / 98 / 2), 1)
    check("velocity", difference["body water", "velocity"]["all"].relative, 0.03)
    for out in folders:
        check(f"tip, {out.name}, over its height",
              max(map(abs, probe(out, "tip")["displacement x"])) / 0.08, 1e-6)


def hydrostatic_plate(selkie, folder):
    """The plate's middle, mean from 10 to 30 ms after its load came on.

    Timoshenko's -7.11e-5 m, of which shear is 3.6 %. Two bilinear elements across
    are too stiff in bending by ((1 - nu)/2 + nu^2/(1 - 2 nu))/2^2 = 17 % (parasitic
    shear, and a transverse strain that cannot vary), so -6.10e-5 m is expected of
    them. Steps of 1 ms: with those of 10 ms of the scene the water's mesh turns
    over at 0.1 s. Both still swing by some per cent.
    """
    nu, thin, shear = 0.34, -6.8604e-5, 1.0364
    stiffer = 1 + ((1 - nu) / 2 + nu**2 / (1 - 2 * nu)) / 4
    *folders, _ = pair(
        selkie, folder, "hydrostatic_plate.prm",
        ("Time/Step=1e-3", "Time/End time=0.03", "Inertia/Newmark beta=0.3025",
         "Inertia/Newmark gamma=0.6", "Output/Interval=0.01", "Linear solver/Solver=direct"))
    for out, expected in zip(folders, (thin * shear, thin * (1 / stiffer + shear - 1))):
        p = probe(out, "middle")
        late = [u for t, u in zip(p["time"], p["displacement y"]) if t > 0.01]
        mean = sum(late) / len(late)
        check(f"{out.name}: {mean:.3e} m against {expected:.3e} m", mean / expected - 1, 0.05)


def manufactured(selkie, folder):
    """With A/100, where points stay on their lattice: both of second order.

    What the two differ in is the error of LME-MPM, mostly (8.6 % of A at 8 cells).
    """
    found = []
    for cells in (8, 16):
        out = folder / str(cells)
        out.mkdir()
        *_, difference = pair(
            selkie, out, mms.scene(out, 0.0005),
            (f"Domain/Cells={cells}, {cells}", f"Time/Step={0.0025 / cells!r}"),
            lme=mms.points(3, 2))
        found.append([difference["body block", name]["all"].relative
                      for name in ("displacement", "velocity")])
    for name, coarse, fine in zip(("displacement", "velocity"), *found):
        check(f"{name}, 8 cells", coarse, 0.1)
        check(f"{name}, 16 over 8 cells", fine / coarse, 0.3)


if __name__ == "__main__":
    main(globals())
