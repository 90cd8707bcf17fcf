#!/usr/bin/python3
"""Walls that rub and walls that let go, against closed forms.

    walls.py CASE SELKIE

CASE is a function of this file. Exit code 1 if a figure is beyond its bound.
"""
import math

from check import BENCHMARKS, HERE, check, main, run, table


def friction(selkie, folder):
    """A lump slides and slows down: v0 exp(-beta t / (rho H))."""
    s = run(selkie, HERE / "friction.prm", folder)
    mass = 1000 * 0.8 * 0.4
    v = [p / mass for p in s["momentum x"]]
    exact = [0.5 * math.exp(-400 * t / (1000 * 0.4)) for t in s["time"]]
    # The lump is not stiff: its foot lags behind its centre.
    check("velocity of the centre, largest deviation / start",
          max(abs(a - b) for a, b in zip(v, exact)) / 0.5, 2e-2)
    lost = 0.5 * mass * 0.25 - s["kinetic energy"][-1]
    check("heat of viscosity and friction / kinetic energy lost - 1",
          s["dissipated energy"][-1] / lost - 1, 2e-2)


def friction_walls(selkie, folder):
    """A list of walls that is empty means the slip walls: an open wall that the lump
    touches does not rub."""
    settings = ("Domain/Walls/left=free", "Bodies/lump/Shape=box(0, 0, 0.8, 0.4)",
                "Time/End time=0.1")
    one = run(selkie, HERE / "friction.prm", folder / "one", settings)
    # The lump touches neither the right wall nor the top.
    all_of_them = run(selkie, HERE / "friction.prm", folder / "all",
                      (*settings, "Wall friction/Walls="))
    check("difference of the momentum / its start",
          max(abs(a - b) for a, b in zip(one["momentum x"], all_of_them["momentum x"])) / 160,
          1e-12)


def release(selkie, folder):
    """The floor lets the block go, or not."""
    mass = 1000 * 0.4 * 0.3
    s = run(selkie, HERE / "wall_release.prm", folder / "released")
    check("released: momentum / (m v) - 1, largest",
          max(abs(p / mass - 1) for p in s["momentum y"]), 1e-10)
    check("released: rise of the centre / (v t) - 1",
          (s["center of mass y"][-1] - s["center of mass y"][0])
          / (s["time"][-1] - s["time"][0]) - 1, 1e-3)
    stuck = run(selkie, HERE / "wall_release.prm", folder / "stuck", ("Effects=inertia",))
    # It stretches by v sqrt(rho / E) L = 0.03 m at most and swings back.
    rise = max(stuck["center of mass y"]) - stuck["center of mass y"][0]
    check("stuck: largest rise of the centre (m)", rise, 0.03)


def landing(selkie, folder):
    """With gravity the block comes back and is caught, without a blow from below."""
    s = run(selkie, HERE / "wall_release.prm", folder,
            ("Effects=inertia, gravity, wall release", "Gravity/Acceleration=0, -9.81",
             "Time/End time=1.5"))
    top = max(s["center of mass y"])
    check("highest point of the centre - v^2 / 2g (m)",
          top - s["center of mass y"][0] - 1 / (2 * 9.81), 3e-3)
    energy = [k + e + p for k, e, p in
              zip(s["kinetic energy"], s["strain energy"], s["potential energy"])]
    check("energy gained / start", max(energy) / energy[0] - 1, 1e-2)
    # Matter is felt one cell (0.1 m) before it touches.
    check("the centre at the end is above its place on the floor by (m)",
          s["center of mass y"][-1] - 0.15, 0.1)


def piston(selkie, folder):
    """A moving node set pushes a solid block: it gets the piston's velocity."""
    s = run(selkie, HERE / "piston.prm", folder)
    mass = 1000 * 0.3 * 0.2
    half = len(s["time"]) // 2
    mean = sum(s["momentum x"][half:]) / (len(s["time"]) - half) / mass
    check("mean velocity of the block / that of the piston - 1", mean / 0.5 - 1, 0.1)


def gauges(selkie, folder):
    """Gauge, level and wall force of a column at rest."""
    weight, height, width = 997.5 * 9.81 * 0.6, 0.6, 0.24
    run(selkie, BENCHMARKS / "hydrostatic_column.prm", folder,
        ("Effects=inertia, gravity, viscosity, probes, hydrostatic start", "Time/End time=0.1",
         "Bodies/water/Law parameters/Bulk modulus=2e9"))
    gauge, level, force = (table(folder / "probes" / f"{name}.csv")
                           for name in ("gauge", "level", "bottom_force"))
    check("mean pressure of the gauge / (rho g H) - 1", gauge["mean pressure"][-1] / weight - 1, 1e-2)
    check("wet share - 1", gauge["wet share"][-1] - 1, 1e-12)
    # The uppermost points are half their spacing below the surface.
    check("level - H, over H", (level["height y"][-1] + 0.015) / height - 1, 2e-3)
    check("force on the floor / (rho g H W) + 1",
          force["force y"][-1] / (weight * width) + 1, 1e-3)
    check("its moment about the corner / (force W / 2) - 1",
          force["moment z"][-1] / (force["force y"][-1] * width / 2) - 1, 1e-3)


if __name__ == "__main__":
    main(globals())
