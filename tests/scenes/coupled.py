#!/usr/bin/python3
"""Two bodies on one conforming mesh of finite elements, against one dimension.

    coupled.py two_solids SELKIE      statics, closed form up to a quadrature
    coupled.py water_on_bed SELKIE    bouncing, against explicit differences
"""
import bisect
import math
import pathlib

from check import check, main, run, table

HERE = pathlib.Path(__file__).resolve().parent


def solid(E, nu):
    """First Piola stress of the neo-Hookean solid (theory.md L.11) between walls."""
    G, L = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    return lambda F: (L / 2 * (F * F - 1) - G) / F + G * F


def water(K, n=7):
    return lambda F: -K / n * (F**-n - 1)


def stretch(P, stress):
    """F with P(F) = stress, by bisection."""
    low, high = 0.3, 1.2
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if P(middle) > stress else (middle, high)
    return low


def settlement(layers, g, n=1000):
    """Displacement of the top of each layer (height, density, P) at rest."""
    weight = g * sum(height * density for height, density, _ in layers)
    u, tops = 0., []
    for height, density, P in layers:
        for i in range(n):
            u += height / n * (stretch(P, g * density * height * (i + 0.5) / n - weight) - 1)
        weight -= g * height * density
        tops.append(u)
    return tops


def bounce(layers, g, end, n=60):
    """Times and displacement of the top of each layer, n cells a layer, when
    gravity acts from t = 0 on."""
    cells = [(height / n, density, P) for height, density, P in layers for _ in range(n)]
    mass = [0.5 * (cells[i][0] * cells[i][1]
                   + (cells[i + 1][0] * cells[i + 1][1] if i + 1 < len(cells) else 0))
            for i in range(len(cells))]
    steps = 5400
    dt = end / steps
    u, v = [0.] * len(cells), [0.] * len(cells)
    curves = [[0.] for _ in layers]
    for step in range(steps):
        stress = [P(1 + (u[i] - (u[i - 1] if i else 0)) / h)
                  for i, (h, _, P) in enumerate(cells)] + [0.]
        for i in range(len(cells)):
            v[i] += (dt if step else dt / 2) * ((stress[i + 1] - stress[i]) / mass[i] - g)
            u[i] += dt * v[i]
        for layer, curve in enumerate(curves):
            curve.append(u[(layer + 1) * n - 1])
    return [i * dt for i in range(steps + 1)], curves


def interpolate(times, values, t):
    i = min(max(bisect.bisect(times, t), 1), len(times) - 1)
    share = (t - times[i - 1]) / (times[i] - times[i - 1])
    return (1 - share) * values[i - 1] + share * values[i]


def last(folder, probe):
    """The last row of a probe."""
    return {name: values[-1] for name, values in table(folder / "probes" / (probe + ".csv")).items()}


def two_solids(selkie, folder):
    """16 elements high: second order, (1/16)^2 of strains of 30 % is 1e-3."""
    g = 10.
    layers = [(0.5, 1000., solid(1e5, 0.3)), (0.5, 2000., solid(2e4, 0.3))]
    s = run(selkie, HERE / "coupled_column.prm", folder)
    # Shared nodes: two unknowns at each of 5 x 17, none twice.
    check("unknowns more than those of one mesh", s["unknowns"][-1] - 2 * 5 * 17, 0)
    for probe, exact in zip(("interface", "top"), settlement(layers, g)):
        found = last(folder, probe)["displacement y"]
        check(f"{probe}: {found:.6f} m against {exact:.6f} m", found / exact - 1, 2e-3)
    weight = 0.25 * g * sum(height * density for height, density, _ in layers)
    check("force on the floor", last(folder, "floor")["force y"] / -weight - 1, 1e-9)
    # From the Gauss points next to it the displacement continues to that of the
    # interface, in either body with the strain of the middle of its element.
    interface = last(folder, "interface")["displacement y"]
    weight, h = 0.5 * 2000 * g, 1 / 16
    distance = (1 - 1 / math.sqrt(3)) / 2 * h
    for probe, sign, (_, density, P) in (("below", 1, layers[0]), ("above", -1, layers[1])):
        strain = stretch(P, -weight - sign * density * g * h / 2) - 1
        continued = last(folder, probe)["displacement y"] + sign * distance * strain
        check(f"continued to the interface from {probe}", continued / interface - 1, 1e-3)


def water_on_bed(selkie, folder):
    """20 elements, 150 steps a period: sound lags by a share (w h/c)^2/24 + (w
    dt)^2/12 = 4e-4; over two periods that is 0.5 % of the amplitude."""
    g, end = 10., 0.6
    layers = [(0.4, 1500., solid(1e5, 0.3)), (0.6, 1000., water(2e6))]
    run(selkie, HERE / "coupled_bed.prm", folder)
    times, curves = bounce(layers, g, end)
    for probe, exact in zip(("interface", "surface"), curves):
        p = table(folder / "probes" / (probe + ".csv"))
        error = max(abs(u - interpolate(times, exact, t))
                    for t, u in zip(p["time"], p["displacement y"]))
        check(f"{probe}, over its largest displacement {min(exact):.4f} m",
              error / -min(exact), 0.01)
        check(f"{probe}, sideways", max(map(abs, p["displacement x"])), 1e-8)
    for name, tops in zip(("interface", "surface"), zip(curves, settlement(layers, g))):
        print(f"       {name}: lowest {min(tops[0]):.4f} m, at rest {tops[1]:.4f} m")


if __name__ == "__main__":
    main(globals())
