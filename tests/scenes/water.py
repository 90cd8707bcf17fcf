#!/usr/bin/python3
"""Water against closed forms and published curves; prints every figure.

    water.py CASE SELKIE [ARGUMENT]

CASE is a function of this file. Exit code 1 if a figure is beyond its bound.
"""
import math
import re

from check import BENCHMARKS, HERE, check, main, run, vtu_array, worst


def cost(folder):
    """CPU and wall seconds of a run."""
    with open(folder / "timing.csv") as file:
        head, row = [next(file).strip().split(",") for _ in range(2)]
    row = dict(zip(head, row))
    return f"{float(row['cpu (s)']):.1f} s CPU"


def pictures(folder, *names):
    """(time, [arrays of the points]) of every picture; "" is their position."""
    for line in (folder / "particles.pvd").read_text().splitlines():
        found = re.search(r'timestep="([^"]*)".*file="([^"]*)"', line)
        if found:
            file = (folder / found.group(2)).with_suffix("")
            yield float(found.group(1)), [vtu_array(file.parent / (file.name + ".0.vtu"), name)
                                          for name in names]


RHO, G, H, N = 997.5, 9.81, 0.6, 7  # of hydrostatic_column.prm


def at_rest(depth, K):
    """Pressure there: dp/dy = -rho g / J."""
    return K / N * ((1 + (N - 1) * RHO * G * depth / K)**(N / (N - 1)) - 1) if K < 1e8 \
        else RHO * G * depth


def column(selkie, folder, cells, K, settings=()):
    """{time: rms error of the points' pressure over rho g H}, sinking of the centre
    over H, mean kinetic energy of the second half per volume over rho g H^2.

    The pressure is compared with that of the depth at which a point is now: the
    points of a disordered lattice wander.
    """
    s = run(selkie, BENCHMARKS / "hydrostatic_column.prm", folder,
            (f"Domain/Cells={4 * cells // 10}, {12 * cells // 10}",
             f"Bodies/water/Law parameters/Bulk modulus={K}", "Output/Interval=0.1",
             *settings), picture=True)
    rms = {}
    for t, (x, p) in pictures(folder, "", "pressure"):
        error = [(found - at_rest(H - y, K)) / (RHO * G * H) for found, y in zip(p, x[1::3])]
        rms[t] = math.sqrt(sum(e * e for e in error) / len(error))
    sunk = (s["center of mass y"][0] - s["center of mass y"][-1]) / H
    half = s["kinetic energy"][len(s["time"]) // 2:]
    energy = sum(half) / len(half) / (max(s["volume"]) * RHO * G * H)
    return rms, sunk, energy


JITTER = "Bodies/water/Jitter=0.3"
FROM_REST = "Effects=inertia, gravity, viscosity, probes, hydrostatic start"


def jittered_column(selkie, folder, cells="10", *settings):
    """rms of the pressure after 1 s at K = 2 GPa, points disordered by 0.3 of their
    spacing: <= 1.5 % at h = H/10, <= 0.7 % at H/20, falling with h."""
    bound = {10: 0.015, 20: 0.007, 40: 0.007}[int(cells)]
    rms, sunk, energy = column(selkie, folder, int(cells), 2e9, (JITTER, *settings))
    check(f"h = H/{cells}, rms of the pressure over rho g H at t = {max(rms):g} s", rms[max(rms)], bound)
    check("   largest of t = 0.5 s to 1 s", max(v for t, v in rms.items() if t > 0.45), bound)
    print(f"       centre sinks by {sunk:.2e} H, kinetic energy {energy:.1e} of rho g H^2, {cost(folder)}")


def compressible_column(selkie, folder, cells="10"):
    """The same at K = 2 MPa from the hydrostatic start: it bounces, the mean over
    t = 0.5 s to 1 s of the rms is stated."""
    for name, jitter, bound in (("regular", (), 0.01), ("jittered", (JITTER,), 0.015)):
        rms, sunk, energy = column(selkie, folder / name, int(cells), 2e6, (FROM_REST, *jitter))
        later = [v for t, v in rms.items() if t > 0.45]
        check(f"{name}, h = H/{cells}: rms of the pressure, mean of t = 0.5 s to 1 s",
              sum(later) / len(later), bound)
        print(f"       {min(later):.2e} to {max(later):.2e}; centre sinks by {sunk:.2e} H, kinetic "
              f"energy {energy:.1e} of rho g H^2, {cost(folder / name)}")


def still_column(selkie, folder, end="10"):
    """Regular points from the hydrostatic start stay where they are."""
    rms, sunk, energy = column(selkie, folder, 10, 2e9, (FROM_REST, f"Time/End time={end}"))
    check(f"sinking of the centre in {end} s over H", sunk, 0.003 * float(end) / 10)
    check("kinetic energy per volume over rho g H", energy, 1e-6)
    check("rms of the pressure at the end", rms[max(rms)], 0.01)
    print(f"       {cost(folder)}")


def flight(selkie, folder):
    """A jittered block in free flight keeps its momentum (see the scene).

    The volume correction takes disorder for crowding and presses, which must not
    cost momentum; without it the water stays free of pressure.
    """
    for name, settings in (("as shipped", ()),
                           ("no volume correction", ("Fluid pressure/Volume correction=0",))):
        out = folder / name.replace(" ", "_")
        s = run(selkie, HERE / "water_flight.prm", out, settings, picture=True)
        for axis, v in (("x", 1), ("y", 0.1)):
            momentum = 1000 * 0.16 * v
            check(f"{name}: momentum {axis}", worst(s["momentum " + axis], momentum) / momentum, 1e-10)
        energy = 0.5 * 1000 * 0.16 * 1.01
        change = worst(s["kinetic energy"], energy) / energy
        pressure = max(max(map(abs, p)) for _, (p,) in pictures(out, "pressure")) / 1010
        if settings:
            check(f"{name}: kinetic energy", change, 1e-10)
            check(f"{name}: largest pressure over rho v^2", pressure, 1e-8)
        else:
            print(f"       {name}: kinetic energy {change:.1e}, largest pressure {pressure:.1e} rho v^2")


def vortex(selkie, folder, n, settings=()):
    """Kinetic energy of taylor_green.prm over the exact one at t = 1 s, minus 1;
    2 n cells a wavelength, the step goes with them."""
    s = run(selkie, BENCHMARKS / "taylor_green.prm", folder,
            (f"Domain/Cells={n}, {n}", f"Time/Step={0.08 / n!r}", *settings))
    error = s["kinetic energy"][-1] / (0.0625 * math.exp(-0.16 * math.pi**2 * s["time"][-1])) - 1
    print(f"       {2 * n} cells a wavelength {' '.join(settings)}: kinetic energy {error:+.2%}, J "
          f"{min(s['min J']):.4f} to {max(s['max J']):.4f}, energy balance "
          f"{s['energy balance'][-1] / 0.0625:+.2%}, cuts {s['step cuts'][-1]:.0f}, {cost(folder)}",
          flush=True)
    return error


def taylor_green(selkie, folder, n="16", bound="0.03", *settings):
    """The vortex decays as the exact one: 3 % of the kinetic energy at t = 1 s."""
    check("kinetic energy at t = 1 s", vortex(selkie, folder, int(n), settings), float(bound))


def interior_volume(path, h):
    """Volume of the points in a picture's cells inside the water over that of the
    cells, and their number. Inside are cells of which the eight around them and the
    second above hold points; they themselves may happen to hold none."""
    place = vtu_array(path, "")
    cells = {}
    for i, (V, J) in enumerate(zip(vtu_array(path, "reference volume"),
                                   vtu_array(path, "volume ratio"))):
        cell = (math.floor(place[3 * i] / h), math.floor(place[3 * i + 1] / h))
        cells[cell] = cells.get(cell, 0) + V * J
    across = round(0.584 / h)
    around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1, 2)
              if (i, j) != (0, 0) and (j < 2 or i == 0)]
    inside = [(x, y) for x in range(across) for y in range(across)
              if all(not 0 <= x + i < across or y + j < 0 or (x + i, y + j) in cells
                     for i, j in around)]
    return sum(cells.get(cell, 0) for cell in inside) / (len(inside) * h * h), len(inside)


def volume(selkie, folder, *settings):
    """A violent dam break to T = t sqrt(2g/a) = 37 keeps its volume to 2 %: points over
    cells inside the water, means of windows of six T; and potential less kinetic
    energy from T = 24 on (half of a swing's energy is potential) over that of the
    same water at rest. The sum of energies never rises.
    """
    a, g, length = 0.146, 9.81, 0.584
    s = run(selkie, BENCHMARKS / "dam_break.prm", folder,
            ("Time/End time=3.2", "Linear solver/Tolerance=1e-6", "Newton/Tolerance=1e-7",
             "Output/Interval=0.05", *settings), picture=True)
    h = 0.438 / int(next((text for text in settings if text.startswith("Domain/Cells")),
                         "36").split(",")[-1].split("=")[-1])
    windows = {}
    for n in range(1, 65):
        T = 0.05 * n * math.sqrt(2 * g / a)
        ratio, cells = interior_volume(folder / f"solution/particles_{n:04d}.0.vtu", h)
        sums = windows.setdefault(min(int(T / 6), 6), [0., 0])
        sums[0] += ratio * cells
        sums[1] += cells
    for window, (ratios, cells) in sorted(windows.items()):
        check(f"points over cells inside the water, T from {6 * window}, - 1",
              ratios / cells - 1, 0.02)
    rest = 0.5 * 1000 * g * (2 * a * a)**2 / length
    late = [p - k for t, p, k in zip(s["time"], s["potential energy"], s["kinetic energy"])
            if 24 <= t * math.sqrt(2 * g / a) <= 36]
    check("volume at rest / its own - 1", sum(late) / len(late) / rest - 1, 0.02)
    given = s["energy of volume correction"]
    balance = s["energy balance"]
    check("energy gained beyond the correction's / start",
          max(0, max(balance)) / s["potential energy"][0], 1e-3)
    print(f"       the correction gave {given[-1]:.1f} J of {s['potential energy'][0]:.1f} J, "
          f"crowding at the end {s['crowding'][-1]:+.4f}, {cost(folder)}")


def refined_column(selkie, folder, levels="1", *settings):
    """Finer cells below y = 0.1 m, from the hydrostatic start, rms at 0.5 s."""
    rms, sunk, energy = column(
        selkie, folder, 10, 2e9,
        (FROM_REST, "Domain/Refinements/Names=fine",
         "Domain/Refinements/fine/Shape=box(0, 0, 0.24, 0.1)",
         f"Domain/Refinements/fine/Levels={levels}", "Time/End time=0.5", *settings))
    check(f"refined {levels} times, rms of the pressure over rho g H", rms[max(rms)], 0.03)


if __name__ == "__main__":
    main(globals())
