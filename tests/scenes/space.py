#!/usr/bin/python3
"""Elastic gates that the floor lets go, and water round posts and gates in 3D.

    space.py CASE SELKIE [ARGUMENT ...]

CASE is a function of this file; every ARGUMENT is a setting of the program. Exit
code 1 if a figure is beyond its bound.
"""
from check import BENCHMARKS, DATA, check, main, run, table


def at(curve, t):
    """A column of a probe between its rows."""
    times, values = curve
    i = next(i for i, s in enumerate(times) if s >= t - 1e-9)
    if i == 0:
        return values[0]
    share = (t - times[i - 1]) / (times[i] - times[i - 1])
    return (1 - share) * values[i - 1] + share * values[i]


def cost(s):
    """Steps, cuts and iterations of a run; the figures every scene here reports."""
    iterations = s["newton iterations"]
    print(f"       {len(iterations)} steps to {s['time'][-1]:.4f} s, {s['step cuts'][-1]:.0f} cuts, "
          f"Newton {sum(iterations) / len(iterations):.2f} a step (most "
          f"{max(iterations):.0f}), linear {sum(s['linear iterations']) / sum(iterations):.1f}; "
          f"{s['unknowns'][0]:.0f} to {max(s['unknowns']):.0f} unknowns, {s['points'][0]:.0f} points")


def energy(s):
    """The balance over what gravity has given."""
    given = s["potential energy"][0] - min(s["potential energy"])
    print(f"       energy balance / fall of the potential energy {s['energy balance'][-1] / given:+.4f} "
          f"(largest {max(map(abs, s['energy balance'])) / given:.4f})")


def tip(folder):
    p = table(folder / "probes" / "tip.csv")
    return {axis: (p["time"], [1000 * u for u in p["displacement " + axis]])
            for axis in "xyz" if "displacement " + axis in p}


COARSE = ("Domain/Lower corner=-0.09875, 0", "Domain/Upper corner=0.09875, 0.148125",
          "Domain/Cells=40, 30", "Bodies/water/Shape=box(-0.09875, 0, 0, 0.14)",
          "Bodies/gate/Shape=box(0, 0, 0.0049375, 0.079)",
          "Probes/tip/Shape=box(0, 0, 0.0049375, 0.0049375)")


def gate_release(selkie, folder, size="fine", *settings):
    """The gate on the floor opens as fast as the computed ones (10 %)."""
    s = run(selkie, BENCHMARKS / "elastic_gate_release.prm", folder,
            (*(COARSE if size == "coarse" else ()), "Time/End time=0.16", *settings))
    cost(s)
    energy(s)
    curves = tip(folder)
    band = table_with_comments(DATA / "elastic_gate.csv")
    for i, t in enumerate(band["time"]):
        if t > s["time"][-1] + 1e-9:
            break
        x, low, high = at(curves["x"], t), *sorted((band["x Yang"][i], band["x Khayyer"][i]))
        print(f"       t {t}: x {x:.2f} mm, computed {low} to {high}; "
              f"y {at(curves['y'], t):.2f} mm, computed {band['y Khayyer'][i]}")
        check(f"t {t}: x beyond the band / band", max(0, low - x, x - high) / (low if x < low else high), 0.1)


def table_with_comments(path):
    head, *rows = [line.split(",") for line in path.read_text().splitlines()
                   if line and not line.startswith("#")]
    return {name: [float(row[i]) for row in rows] for i, name in enumerate(head)}


def gate_stuck(selkie, folder, size="fine", *settings):
    """Without the effect the floor holds the gate by its normal component: it can
    neither rise nor swing free; printed, and that its foot has not risen."""
    s = run(selkie, BENCHMARKS / "elastic_gate_release.prm", folder,
            (*(COARSE if size == "coarse" else ()), "Time/End time=0.08",
             "Effects=inertia, gravity, viscosity, probes", *settings))
    cost(s)
    curves = tip(folder)
    for t in (0.04, 0.08):
        print(f"       t {t}: x {at(curves['x'], t):.2f} mm, y {at(curves['y'], t):.2f} mm")
    check("largest rise of the foot (mm)", max(curves["y"][1]), 1.)


def common_3d(s, folder, body):
    """What every scene of half a channel must keep."""
    cost(s)
    energy(s)
    check("points removed", s["points removed"][-1], 0)
    plane = table(folder / "probes" / "plane.csv")
    check(f"{body}: z of its points at the plane of symmetry (mm)",
          1000 * max(map(abs, plane["displacement z"])), 1.)
    check("mass / start - 1", s["mass"][-1] / s["mass"][0] - 1, 1e-9)
    curves = tip(folder)
    peak = max(curves["x"][1])
    print(f"       {body}: largest displacement of the tip {peak:.2f} mm at "
          f"{curves['x'][0][curves['x'][1].index(peak)]:.4f} s; then y "
          f"{at(curves['y'], curves['x'][0][curves['x'][1].index(peak)]):.2f} mm")
    for t in (0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28):
        if t <= s["time"][-1]:
            print(f"       t {t}: x {at(curves['x'], t):.2f} y {at(curves['y'], t):.2f} "
                  f"z {at(curves['z'], t):.2f} mm")
    return curves, peak


def obstacle_3d(selkie, folder, ranks="2", *settings):
    """The post bends down the stream; the water arrives when it does in 2D."""
    s = run(selkie, BENCHMARKS / "dam_break_obstacle_3d.prm", folder, settings, ranks=int(ranks))
    curves, peak = common_3d(s, folder, "post")
    onset = next((t for t, x in zip(*curves["x"]) if x > 0.5), float("nan"))
    print(f"       the tip starts (0.5 mm) at {onset:.4f} s")
    check("it starts later than 0.1475 s by (s)", onset - 0.1475, 0.0125)
    check("largest displacement beyond the 52 mm of 2D (mm)", max(0, peak - 52), 0)
    check("and below 5 mm (mm)", max(0, 5 - peak), 0)


def gate_3d(selkie, folder, ranks="2", *settings):
    """The gate opens, less than in 2D."""
    s = run(selkie, BENCHMARKS / "elastic_gate_3d.prm", folder, settings, ranks=int(ranks))
    curves, peak = common_3d(s, folder, "gate")
    check("largest displacement beyond the 42.5 mm of 2D (mm)", max(0, peak - 42.5), 0)
    check("and below 5 mm (mm)", max(0, 5 - peak), 0)


if __name__ == "__main__":
    main(globals())
