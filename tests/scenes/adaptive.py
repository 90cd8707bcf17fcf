#!/usr/bin/python3
"""Scenes on a mesh that changes: what must not see it.

    adaptive.py CASE SELKIE [ARGUMENTS]
"""
import math

from check import A, BENCHMARKS, HERE, affine_prescribed, check, determinant, main, run, table, worst
from water import FROM_REST, column

EVERY_STEP = ("Adaptivity/Steps=1", "Adaptivity/Finer levels=1", "Adaptivity/Buffer=1")


def patch(selkie, folder):
    """Affine motion stays exact while the mesh changes with every step."""
    for points in ("keep", "split and merge"):
        out = folder / points.split()[0]
        affine_prescribed(selkie, out, *EVERY_STEP, "Adaptivity/Surface=true",
                          f"Adaptivity/Points={points}",
                          "Effects=inertia, prescribed motion, probes, adaptivity")
        cells = table(out / "statistics.csv")["cells"]
        check(f"{points}: steps for each number of cells", len(cells) / len(set(cells)), 5)


def elements(selkie, folder):
    """F = I + g A everywhere by finite elements, though only the rim is told to move, while
    the strain goes up and down and the mesh between two levels with it."""
    speed, omega, dt = 1., 22., 0.1
    v = "; ".join(f"({A[d][0]}*x + {A[d][1]}*y)*{speed}*cos({omega}*t)" for d in (0, 1))
    s = run(selkie, HERE / "hanging_nodes.prm", folder,
            ("Effects=prescribed motion, probes, adaptivity", *EVERY_STEP,
             "Adaptivity/Strain=0.012", f"Time/Step={dt}", "Time/End time=2",
             *(f"Domain/Walls/{wall} velocity={v}" for wall in ("left", "right", "bottom", "top"))))
    check("steps that are missing", len(s["time"]) - 20, 0)
    E, nu = 1e6, 0.3
    G, Lambda = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    error = dict.fromkeys(("min J", "max J", "volume", "strain energy"), 0.)
    g = 0.
    for n in range(len(s["time"])):
        g += 0.5 * dt * speed * (math.cos(omega * n * dt) + math.cos(omega * (n + 1) * dt))
        F = [[1 + g * A[0][0], g * A[0][1]], [g * A[1][0], 1 + g * A[1][1]]]
        J = determinant(F)
        W = 0.5 * G * (sum(f * f for row in F for f in row) - 2) - G * math.log(J) \
            + Lambda / 4 * (J * J - 1 - 2 * math.log(J))
        for name, value, scale in (("min J", J, 1.), ("max J", J, 1.), ("volume", J, 1.),
                                   ("strain energy", W, 1e-3 * E)):
            error[name] = max(error[name], abs(s[name][n] - value) / scale)
    for name, value in error.items():
        check(name, value, 1e-9)
    check("mass", worst(s["mass"], s["mass"][0]) / s["mass"][0], 1e-12)
    check("energy of adapting over the strain energy",
          max(map(abs, s["energy of adapting"])) / max(s["strain energy"]), 1e-12)
    cells = s["cells"]
    check("steps for each change of the mesh",
          len(cells) / max(1, sum(a != b for a, b in zip(cells, cells[1:]))), 3)


def pulled(selkie, folder):
    """A nearly incompressible block of finite elements with a load on one face, up and
    down again: place and pressure are those of the mesh that stays, though it is
    halved on the way up and joined on the way down."""
    fixed = run(selkie, HERE / "pulled_block.prm", folder / "fixed")
    s = run(selkie, HERE / "pulled_block.prm", folder / "changing",
            ("Effects=traction, mixed pressure, probes, adaptivity", *EVERY_STEP,
             "Adaptivity/Strain=0.25"))
    cells = s["cells"]
    changes = sum(a != b for a, b in zip(cells, cells[1:]))
    check("2 less the changes of the mesh (halved, joined)", max(0, 2 - changes), 0)
    probes = [table(folder / name / "probes" / "block.csv") for name in ("fixed", "changing")]
    for column in probes[0]:
        size = max(map(abs, probes[0][column]))
        check(column, max(abs(a - b) for a, b in zip(*(p[column] for p in probes)))
              / (size if size > 0 else 1), 1e-10)
    check("energy", max(abs(a - b) for a, b in zip(s["strain energy"], fixed["strain energy"]))
          / max(fixed["strain energy"]), 1e-10)


def panel(selkie, folder):
    """An L-shaped panel of finite elements finds its mesh in few changes, though it may have
    another one after each load step, since the error says how often to halve a cell."""
    s = run(selkie, BENCHMARKS / "l_shape.prm", folder,
            ("Approximation=q4 fem", "Bodies/panel/Points per direction=2",
             "Effects=body force, probes, adaptivity", "Adaptivity/Steps=1",
             "Adaptivity/Finer levels=8", "Adaptivity/Strain error=0.005", "Time/Step=0.125"))
    cells = s["cells"]
    check("changes of the mesh", sum(a != b for a, b in zip(cells, cells[1:])), 3)
    # Uniform meshes of h = 1/64 and 1/128 (4450 and 17 346 unknowns) and the limit of four of
    # them (doc/adaptive-meshes.md): 0.0582976, 0.0585329, 0.058693 m.
    sag = -table(folder / "probes" / "arm.csv")["displacement y"][-1]
    check("sag, from the limit of uniform meshes", abs(sag / 0.058693 - 1), 0.0068)
    check("unknowns over those of the uniform mesh as good", max(s["unknowns"]) / 4450, 0.5)


def flight(selkie, folder):
    """So does free flight by TPIC, whose points carry affine velocities."""
    s = run(selkie, HERE / "affine_flight.prm", folder,
            (*EVERY_STEP, "Adaptivity/Surface=true", "Adaptivity/Points=keep",
             "Effects=inertia, probes, adaptivity"))
    for name in ("kinetic energy", "momentum x", "momentum y", "angular momentum z"):
        check(name, worst(s[name], s[name][0]) / abs(s[name][0]), 1e-10)
    for name in ("min J", "max J"):
        check(name, max(abs(J / determinant([[1 + t * A[0][0], t * A[0][1]],
                                             [t * A[1][0], 1 + t * A[1][1]]]) - 1)
                        for t, J in zip(s["time"], s[name])), 1e-10)


def still(selkie, folder, end="0.5"):
    """A still column stays still while noise refines and coarsens its cells.

    The criterion is a difference of velocity of seven tenths of the largest, which is
    noise here: cells come and go, points split and merge.
    """
    rms, sunk, energy = {}, {}, {}
    for name, effects in (("plain", FROM_REST), ("adaptive", FROM_REST + ", adaptivity")):
        settings = [effects, f"Time/End time={end}"]
        if name == "adaptive":
            settings += ["Adaptivity/Steps=5", "Adaptivity/Velocity difference=0.7",
                         "Adaptivity/Buffer=1"]
        rms[name], sunk[name], energy[name] = column(selkie, folder / name, 10, 2e6, settings)
    s = table(folder / "adaptive" / "statistics.csv")
    for what in ("split", "merged"):
        check(f"points at the start for each one {what}",
              s["points"][0] / max(s["points " + what][-1], 1e-9), 5)
    for t in rms["plain"]:
        check(f"t = {t:g} s: change of the pressure's rms error over rho g H",
              abs(rms["adaptive"][t] - rms["plain"][t]), 0.01)
        check(f"t = {t:g} s: the error itself", rms["adaptive"][t], 0.01)
    check("sinking of the centre over H", sunk["adaptive"], 0.003)
    check("kinetic energy per volume over rho g H", energy["adaptive"], 1e-6)


if __name__ == "__main__":
    main({"patch": patch, "elements": elements, "pulled": pulled, "panel": panel,
          "flight": flight, "still": still})
