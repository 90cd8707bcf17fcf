#!/usr/bin/python3
"""Scenes on a mesh that changes: what must not see it.

    adaptive.py CASE SELKIE [ARGUMENTS]
"""
from check import A, HERE, affine_prescribed, check, determinant, main, run, table, worst
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
    main({"patch": patch, "flight": flight, "still": still})
