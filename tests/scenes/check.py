#!/usr/bin/python3
"""Runs a scene and compares its curves with theory, never with older output.

    check.py CASE SELKIE [ARGUMENT]

CASE is a function of this file. Prints every figure with its bound; exit code
1 if one is beyond it. Writes into a temporary folder.
"""
import base64
import csv
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

HERE = pathlib.Path(__file__).resolve().parent
BENCHMARKS = HERE.parents[1] / "prm" / "benchmarks"
COOKBOOKS = HERE.parents[1] / "prm" / "cookbooks"
DATA = HERE.parents[1] / "doc" / "data"
failures = 0


def check(what, value, bound):
    """|value| must not exceed bound (and NaN does)."""
    global failures
    good = abs(value) <= bound
    failures += not good
    print(f"{'ok    ' if good else 'FAILED'} {what}: {value:.3e} (bound {bound:.1e})")


def run(selkie, scene, folder, settings=(), ranks=0, picture=False):
    """Runs the scene; returns its statistics."""
    command = [selkie, str(scene), "--output", str(folder)]
    for setting in (*settings, *([] if picture else ["Output/Interval=0"])):
        command += ["--set", setting]
    if ranks:
        command = [os.environ.get("SELKIE_MPIEXEC", "mpirun"), "--oversubscribe",
                   "--bind-to", "none", "-np", str(ranks)] + command
    result = subprocess.run(command, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        print(" ".join(command))
        print("\n".join(result.stdout.splitlines()[-12:]))
        sys.exit(f"FAILED the run ends with exit code {result.returncode}")
    return table(pathlib.Path(folder) / "statistics.csv")


def table(path):
    """A CSV file as columns, named without their units."""
    with open(path, newline="") as file:
        head, *rows = list(csv.reader(file))
    return {name.split(" (")[0]: [float(row[i]) for row in rows]
            for i, name in enumerate(head)}


def vtu_array(path, name):
    """A Float32 array of one of the program's .vtu files, as flat numbers."""
    found = re.search(f'<DataArray type="Float32" Name="{name}"[^>]*>\\s*([^<]*)<'
                      if name else "<Points>[^<]*<DataArray[^>]*>\\s*([^<]*)<",
                      path.read_text())
    text = found.group(1).strip()
    n = struct.unpack("<I", base64.b64decode(text[:8])[:4])[0]
    head = 4 * ((4 * (3 + n) + 2) // 3)  # characters of the blocks' sizes
    sizes = struct.unpack(f"<{3 + n}I", base64.b64decode(text[:head]))[3:]
    data, numbers, at = base64.b64decode(text[head:]), b"", 0
    for size in sizes:
        numbers += zlib.decompress(data[at:at + size])
        at += size
    return struct.unpack(f"<{len(numbers) // 4}f", numbers)


def worst(values, expected):
    """The largest deviation of a curve from a number."""
    return max(abs(value - expected) for value in values)


def times(P, Q):
    return [[sum(P[i][k] * Q[k][j] for k in (0, 1)) for j in (0, 1)] for i in (0, 1)]


def determinant(F):
    return F[0][0] * F[1][1] - F[0][1] * F[1][0]


def lattice(low, high, n):
    """n points in the middles of equal intervals."""
    return [low + (high - low) * (i + 0.5) / n for i in range(n)]


A = [[0.5, 0.8], [-0.3, -0.2]]  # of the affine scenes


def rigid_translation(selkie, folder):
    """Momentum and kinetic energy stay, the displacement is v t."""
    v, mass = (3.7, 2.1), 250.
    s = run(selkie, HERE / "rigid_translation.prm", folder)
    check("momentum x", worst(s["momentum x"], mass * v[0]) / (mass * v[0]), 1e-10)
    check("momentum y", worst(s["momentum y"], mass * v[1]) / (mass * v[1]), 1e-10)
    energy = 0.5 * mass * (v[0]**2 + v[1]**2)
    check("kinetic energy", worst(s["kinetic energy"], energy) / energy, 1e-10)
    check("smallest J", worst(s["min J"], 1), 1e-10)
    check("largest J", worst(s["max J"], 1), 1e-10)
    p = table(folder / "probes" / "corner.csv")
    for d, axis in enumerate("xy"):
        check("displacement " + axis,
              max(abs(u - v[d] * t) for u, t in zip(p["displacement " + axis], p["time"]))
              / (v[d] * p["time"][-1]), 1e-10)
        check("velocity " + axis, worst(p["velocity " + axis], v[d]) / v[d], 1e-10)


def short_interval(selkie, folder):
    """Intervals of output far below the step mean every step, and take no time of their own."""
    s = run(selkie, HERE / "rigid_translation.prm", folder, ["Output/Interval=1e-17", "Probes/Interval=1e-17"],
            picture=True)
    rows = len(table(folder / "probes" / "corner.csv")["time"])
    check("rows of a probe - steps - 1", rows - len(s["step"]) - 1, 0)
    pictures = (folder / "particles.pvd").read_text().count("<DataSet")
    check("pictures - steps - 1", pictures - len(s["step"]) - 1, 0)


def at_rest(selkie, folder):
    """Nothing moves for 20 steps; then momentum = force x time.

    The traction at the new end of a step acts through Newmark's average
    acceleration: half of it counts in the step in which it appears.
    """
    s = run(selkie, HERE / "at_rest.prm", folder)
    force, dt = 500., 1e-3
    check("momentum x while at rest", worst(s["momentum x"][:20], 0), 1e-12)
    exact = [force * dt * (n + 0.5) for n in range(20)]
    check("momentum x under the traction",
          max(abs(a - b) for a, b in zip(s["momentum x"][20:], exact)) / exact[-1], 1e-6)
    check("momentum y", worst(s["momentum y"], 0) / exact[-1], 1e-10)


def affine_prescribed(selkie, folder, *settings):
    """x = (I + dt A)^n X, its J and its energy."""
    s = run(selkie, HERE / "affine_prescribed.prm", folder, settings)
    p = table(folder / "probes" / "corner.csv")
    dt, area = 0.02, 0.95 * 0.95
    E, nu = 1e6, 0.3
    G, Lambda = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    X = [p["position x"][0], p["position y"][0]]
    step = [[1 + dt * A[0][0], dt * A[0][1]], [dt * A[1][0], 1 + dt * A[1][1]]]
    F = [[1, 0], [0, 1]]
    error = dict.fromkeys(("place", "min J", "max J", "volume", "strain energy"), 0.)
    for n in range(len(s["time"])):
        F = times(step, F)
        J = determinant(F)
        trace = sum(f * f for row in F for f in row) + 1
        W = 0.5 * G * (trace - 3) - G * math.log(J) \
            + Lambda / 4 * (J * J - 1 - 2 * math.log(J))
        for d, axis in enumerate("xy"):
            x = F[d][0] * X[0] + F[d][1] * X[1]
            error["place"] = max(error["place"], abs(p["position " + axis][n + 1] - x))
        for name, value in (("min J", J), ("max J", J), ("volume", J * area),
                            ("strain energy", W * area)):
            error[name] = max(error[name], abs(s[name][n] / value - 1))
    for name, value in error.items():
        check(name, value, 1e-10)


def hanging_nodes(selkie, folder, approximation="q4 fem", steps="4"):
    """F = I + t A everywhere, though only the rim is told to move.

    By material points in the first step only: in the next they are no lattice.
    """
    s = run(selkie, HERE / "hanging_nodes.prm", folder,
            (f"Approximation={approximation}", "Time/Step=0.02", f"Time/End time={0.02 * int(steps)}"))
    t = s["time"][-1]
    check("steps that are missing", len(s["time"]) - int(steps), 0)
    F = [[1 + t * A[0][0], t * A[0][1]], [t * A[1][0], 1 + t * A[1][1]]]
    J = determinant(F)
    E, nu = 1e6, 0.3
    G, Lambda = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    W = 0.5 * G * (sum(f * f for row in F for f in row) - 2) - G * math.log(J) \
        + Lambda / 4 * (J * J - 1 - 2 * math.log(J))
    for name, value in (("min J", J), ("max J", J), ("volume", J), ("strain energy", W)):
        check(name, s[name][-1] / value - 1, 1e-10)


def affine_flight(selkie, folder, variant):
    """x = (I + t A) X, v = A X: energy and both momenta are constant.

    The consistent mass is combined with the lumped recovery of velocities: the
    points keep their velocity, but do not follow it exactly.
    """
    settings = {"tpic": (), "consistent": ("Transfer/Scheme=flip", "Inertia/Mass=consistent")}
    s = run(selkie, HERE / "affine_flight.prm", folder, settings[variant])
    p = table(folder / "probes" / "corner.csv")
    X = [p["position x"][0], p["position y"][0]]
    points = [(x, y) for x in lattice(-0.5, 0.5, 16) for y in lattice(-0.375, 0.5, 14)]
    m = 1000 * 0.875 / len(points)
    V = [(A[0][0] * x + A[0][1] * y, A[1][0] * x + A[1][1] * y) for x, y in points]
    exact = {"kinetic energy": 0.5 * m * sum(u * u + v * v for u, v in V),
             "momentum x": m * sum(u for u, v in V),
             "momentum y": m * sum(v for u, v in V),
             "angular momentum z": m * sum(x * v - y * u
                                           for (x, y), (u, v) in zip(points, V))}
    for name, value in exact.items():
        if variant == "tpic" or name != "angular momentum z":
            check(name, worst(s[name], value) / abs(value), 1e-10)
    if variant == "consistent":
        return
    for name in ("min J", "max J"):
        check(name, max(abs(J / determinant([[1 + t * A[0][0], t * A[0][1]],
                                             [t * A[1][0], 1 + t * A[1][1]]]) - 1)
                        for J, t in zip(s[name], s["time"])), 1e-10)
    for d, axis in enumerate("xy"):
        u = A[d][0] * X[0] + A[d][1] * X[1]
        check("displacement " + axis,
              max(abs(value - t * u)
                  for value, t in zip(p["displacement " + axis], p["time"])), 1e-10)


def bingham_shear(selkie, folder):
    """The heat of a prescribed shear; trapezoidal velocities make it exact.

    Points move along y = const, J stays 1, and the velocity gradient is the
    prescribed one at every point: only the law is tested.
    """
    s = run(selkie, HERE / "bingham_shear.prm", folder)
    rate, mu, tau, m, area = 2., 5., 40., 1.5, 1.
    power = (tau * (1 - math.exp(-m * rate)) + mu * rate) * rate * area
    check("dissipated energy", worst([e / (power * t) for e, t in
                                      zip(s["dissipated energy"], s["time"])], 1), 1e-9)
    check("smallest J", worst(s["min J"], 1), 1e-6)


def spring_foundation(selkie, folder):
    """A stiff block on springs under sudden gravity: m y'' = m g - k A y.

    y(t) = (m g / k A)(1 - cos w t), w^2 = k A / m. The block is 25 000 times
    stiffer than the springs, which leaves 1e-4 in the period.
    """
    s = run(selkie, COOKBOOKS / "spring_foundation.prm", folder)
    mass, g, kA = 1000. * 0.5 * 0.5, 9.81, 1e6 * 0.5
    omega = math.sqrt(kA / mass)
    static = mass * g / kA
    y = [s["center of mass y"][0] - v for v in s["center of mass y"]]
    y0 = static * (1 - math.cos(omega * s["time"][0]))  # of the first row
    exact = [static * (1 - math.cos(omega * t)) - y0 for t in s["time"]]
    check("sinking of the centre over 2 m g / k A, two periods",
          max(abs(a - b) for a, b in zip(y, exact)) / (2 * static), 1e-2)
    check("energy balance over m g y",
          worst(s["energy balance"], 0) / (2 * mass * g * static), 1e-3)


def spinning_plate(selkie, folder):
    """Linear momentum stays zero; the angular momentum drifts within bounds."""
    s = run(selkie, HERE / "spinning_plate.prm", folder)
    omega, mass = 5., 500.
    radii = [x * x + y * y for x in lattice(-0.5, 0.5, 32) for y in lattice(-0.25, 0.25, 16)]
    m = mass / len(radii)
    scale = m * omega * sum(math.sqrt(r) for r in radii)
    spin = m * omega * sum(radii)
    for axis in "xy":
        check(f"momentum {axis} over sum |m v|", worst(s["momentum " + axis], 0) / scale, 1e-12)
    drift = [value / spin - 1 for value in s["angular momentum z"]]
    check("angular momentum, drift in one turn", max(drift, key=abs), 0.08)
    check("min J - 1", worst(s["min J"], 1), 5e-3)
    check("max J - 1", worst(s["max J"], 1), 5e-3)


def largest_gain(s):
    """The largest share of the energy in play that a step but the first gained from nothing, as
    'Time/Largest energy jump' counts it."""
    none = [0.] * len(s["step"])
    of = lambda name: s.get(name, none)
    stored = [sum(parts) for parts in zip(of("kinetic energy"), of("strain energy"), of("compression energy"))]
    shares = []
    for i in range(1, len(none)):
        change = lambda name: of(name)[i] - of(name)[i - 1]
        play = max(stored[i - 1:i + 1]) + abs(change("potential energy")) + abs(change("external work"))
        shares.append(change("energy balance") / (play or 1.))
    return max(shares)


def energy_gain(selkie, folder, scene, *settings):
    """Prints it for a benchmark."""
    print(f"{scene}: {largest_gain(run(selkie, BENCHMARKS / (scene + '.prm'), folder, settings)):.2e}")


def energy_jump(selkie, folder):
    """A plate that turns by 0.8 rad a step, which the trapezoidal rule answers with energy:
    with a limit such steps are taken again, and by the statistics none is left."""
    limit = 0.1
    settings = ["Approximation=q4 fem", "Domain/Cells=16, 16", "Bodies/plate/Initial velocity=-10*y; 10*x",
                "Time/Step=0.08", "Time/End time=0.4"]

    loose = run(selkie, HERE / "spinning_plate.prm", folder / "loose", settings)
    check("limit / largest gain of a step without it", limit / largest_gain(loose), 0.5)
    check("cuts without it", loose["step cuts"][-1], 0)
    strict = run(selkie, HERE / "spinning_plate.prm", folder / "strict", [*settings, f"Time/Largest energy jump={limit}"])
    check("largest gain of a step over the limit", largest_gain(strict) / limit, 1)
    check("1 / cuts", 1 / max(strict["step cuts"][-1], 1e-9), 1)
    said = (folder / "strict" / "log.txt").read_text()
    check("cuts that log.txt does not explain", strict["step cuts"][-1] - said.count("from nothing"), 0)


def bar(selkie, folder, cells, scene="vibrating_bar.prm", v0=1e-3, end=20, settings=()):
    """Period error, velocity error and energy drift of the vibrating bar."""
    h = 25 / cells
    s = run(selkie, BENCHMARKS / scene, folder,
            (f"Domain/Upper corner={25 + 3 * h!r}, {h!r}", f"Domain/Cells={cells + 3}, 1",
             f"Bodies/bar/Shape=box(0, 0, 25, {h!r})",
             f"Bodies/bar/Initial velocity={v0}*sin(pi*x/50); 0",
             f"Probes/tip/Shape=box({25 - h!r}, 0, 25, {h!r})",
             f"Time/Step={1.28 / cells!r}", f"Time/End time={end}", *settings))
    t, v = s["time"], [p / m for p, m in zip(s["momentum x"], s["mass"])]
    zeros = [t[i] + (t[i + 1] - t[i]) * v[i] / (v[i] - v[i + 1])
             for i in range(len(v) - 1) if v[i] * v[i + 1] < 0]
    period = 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)
    amplitude, omega = 2 * v0 / math.pi, 2 * math.pi / 10
    rms = math.sqrt(sum((a - amplitude * math.cos(omega * b))**2
                        for a, b in zip(v, t)) / len(t)) / amplitude
    start = 0.25 * v0**2 * 25 * h  # rho A v0^2 L / 4
    drift = max((k + e) / start - 1 for k, e in zip(s["kinetic energy"], s["strain energy"]))
    lost = min((k + e) / start - 1 for k, e in zip(s["kinetic energy"], s["strain energy"]))
    return period / 10 - 1, rms, max(drift, lost, key=abs)


def vibrating_bar(selkie, folder):
    """Second order in the period and in the velocity; energy within 1 %."""
    coarse = bar(selkie, folder / "8", 8)
    fine = bar(selkie, folder / "16", 16)
    for name, a, b in zip(("period", "velocity of the centre (rms)"), coarse, fine):
        print(f"       {name}: error {a:.3e} at 8 cells, {b:.3e} at 16 cells")
        check(name + ", order below 2", max(0, 2 - math.log2(a / b)), 0.2)
    check("period at 8 cells", coarse[0], 0.01)
    check("energy drift at 8 cells", coarse[2], 0.01)
    check("energy drift at 16 cells", fine[2], 0.01)


def vibrating_bar_full(selkie, folder):
    """The shipped scene: ten periods with 32 cells; then the order."""
    error = bar(selkie, folder / "full", 32, v0=0.1, end=100)
    check("period", error[0], 0.01)
    check("energy drift", error[2], 0.01)
    previous = None
    for cells in (8, 16, 32, 64):
        error = bar(selkie, folder / str(cells), cells)
        order = [math.log2(a / b) for a, b in zip(previous[:2], error[:2])] \
            if previous else [math.nan] * 2
        print(f"       {cells} cells: period {error[0]:.3e} (order {order[0]:.2f}), "
              f"velocity {error[1]:.3e} (order {order[1]:.2f}), energy {error[2]:.3e}")
        previous = error


def cantilever(selkie, folder, cells="8"):
    """The deflection of the authors' code, which runs half a step late."""
    settings = ["Time/End time=0.54"]
    if cells == "16":
        settings += ["Domain/Cells=80, 56", "Probes/tip/Shape=box(3.9375, 0, 4, 1)"]
    run(selkie, BENCHMARKS / "cantilever.prm", folder, settings)
    tip = table(folder / "probes" / "tip.csv")["displacement y"]
    expected = {"8": -0.717, "16": -0.726}[cells]
    check(f"largest deflection {min(tip):.4f} m against {expected} m",
          min(tip) / expected - 1, 0.01)
    theirs = table(DATA / f"nlps_beam_h{cells}.csv")["tip_uy"]
    check("curve, of the largest deflection",
          max(abs(0.5 * (tip[n] + tip[n + 1]) - theirs[n]) for n in range(len(tip) - 1))
          / -expected, 0.01)


def elliptical_drop(selkie, folder, dimension="2", cells="16"):
    """Monaghan's ellipse, and its three-dimensional form (see the scenes).

    k directions are squeezed alike: a' = -A a / k, b' = A b and
    A' = A^2 (a^2 / k^2 - b^2) / (a^2 / k + b^2); the pressure falls like 1 - x^2/a^2
    - y^2/b^2 from rho b^2 (A' + A^2) / 2 in the centre. `cells` are those of the
    radius in 2D.
    """
    k, cells = int(dimension) - 1, int(cells)
    scene = {1: "elliptical_drop.prm", 2: "elliptical_drop_3d.prm"}[k]
    run(selkie, BENCHMARKS / scene, folder, () if k == 2 else (
        f"Domain/Cells={3 * cells}, {11 * cells // 2}", f"Time/Step={1.6e-3 / cells!r}",
        f"Probes/centre/Shape=disc(0, 0, {1.6 / cells!r})"))
    probe = table(folder / "probes" / "drop.csv")
    pressure = table(folder / "probes" / "centre.csv")["pressure"]

    def rate(a, b, A):
        return -A * a / k, A * b, A * A * (a * a / k**2 - b * b) / (a * a / k + b * b)

    def advance(state, dt, n):
        for _ in range(n):  # the midpoint rule
            half = [x + dt / 2 / n * r for x, r in zip(state, rate(*state))]
            state = tuple(x + dt / n * r for x, r in zip(state, rate(*half)))
        return state

    states = [(1., 1., 100.)]
    for t, later in zip(probe["time"], probe["time"][1:]):
        states.append(advance(states[-1], later - t, 10))
    exact_pressure = [b * b * (rate(a, b, A)[2] + A * A) / 2 for a, b, A in states]
    for quarter in (0.25, 0.5, 0.75, 1.):
        row = min(range(len(probe["time"])),
                  key=lambda i: abs(probe["time"][i] - quarter / 100))
        at = f"A0 t = {100 * probe['time'][row]:.2f}"
        for axis, exact in zip("xyz", (*states[row][:2], states[row][0])[:k + 1]):
            value = probe["semi-axis " + axis][row]
            check(f"{at}: {axis} {value:.5f} m, exact {exact:.5f} m",
                  value / exact - 1, 0.01 if k == 1 else 0.02)
        check(f"{at}: volume", probe["volume"][row] / probe["volume"][0] - 1, 0.005)
        print(f"       {at}: pressure of the centre {pressure[row]:.0f} Pa, exact "
              f"{exact_pressure[row]:.0f} Pa: {pressure[row] / exact_pressure[row] - 1:+.4f}")
    # 5 % is wanted. In 2D it takes h = R/16 (R/8: 14 %); R/6 is what 3D is shipped with.
    check("pressure of the centre in any step, largest deviation",
          max(abs(p / exact - 1) for p, exact in zip(pressure, exact_pressure)),
          0.05 if k == 1 else 0.15)


def cook_membrane(selkie, folder):
    """deal.II's code gallery, Q1: the rise of the tip's middle, mm."""
    for refinements, expected in ((1, 8.638), (2, 12.07), (3, 13.86), (4, 14.49), (5, 14.67)):
        out = folder / str(refinements)
        run(selkie, BENCHMARKS / "cook_membrane.prm", out,
            (f"Domain/Mesh/Global refinements={refinements}",))
        tip = 1e3 * table(out / "probes" / "tip.csv")["displacement y"][-1]
        check(f"{2**refinements} elements an edge: {tip:.3f} mm against {expected} mm",
              tip / expected - 1, 0.01)


def cook_points(selkie, folder):
    """Cook's membrane by LME-MPM: with the mixed pressure the error does not depend
    on nu (what is left is the stepped edge); without, it does.

    References: deal.II's code gallery (nu = 0.3) and Q2-P1 (cook_incompressible).
    """
    error = {}
    for effect in ("", ", mixed pressure"):
        for nu, reference in (("0.3", 14.738), ("0.4999", 13.407)):
            if not effect and nu == "0.3":
                continue
            out = folder / (nu + effect)
            run(selkie, HERE / "cook_points.prm", out,
                (f"Bodies/panel/Law parameters/Poisson ratio={nu}",
                 f"Effects=body force, probes{effect}"))
            rise = 1e3 * table(out / "probes" / "tip.csv")["displacement y"][-1]
            error[effect, nu] = rise / reference - 1
            print(f"       nu = {nu}{effect}: {rise:.3f} mm against {reference} mm, "
                  f"{100 * error[effect, nu]:+.1f} %")
    for nu in ("0.3", "0.4999"):
        check(f"mixed pressure, nu = {nu}", error[", mixed pressure", nu], 0.03)
    check("what nu = 0.4999 adds to the error of nu = 0.3",
          error[", mixed pressure", "0.4999"] - error[", mixed pressure", "0.3"], 0.01)
    check("without it at nu = 0.4999 at least 5 % are missing",
          max(0, 0.05 + error["", "0.4999"]), 0)


def cook_incompressible(selkie, folder):
    """nu = 0.4999: the cures do not lock; without them Q4 does.

    The reference is another program with another method: Q2 displacements, P1
    discontinuous pressures, 32 elements an edge
    (tests/references/cook_q2_p1.cc: `cook_q2_p1 0.4999 32`; 13.397 mm with 16).
    """
    reference = 13.407
    rise = {}
    cures = (", mean dilatation", ", mixed pressure")
    for effect, refinements in (*((cure, n) for cure in cures for n in (4, 5)), ("", 4)):
        out = folder / f"{refinements}{effect}"
        run(selkie, BENCHMARKS / "cook_membrane.prm", out,
            (f"Domain/Mesh/Global refinements={refinements}",
             "Bodies/panel/Law parameters/Poisson ratio=0.4999",
             f"Effects=traction{effect}, probes"))
        rise[effect, refinements] = 1e3 * table(out / "probes" / "tip.csv")["displacement y"][-1]
    for cure in cures:
        for refinements, bound in ((4, 0.03), (5, 0.01)):
            found = rise[cure, refinements]
            check(f"{cure[2:]}, {2**refinements} elements an edge: {found:.3f} mm against "
                  f"{reference} mm", found / reference - 1, bound)
    locked = rise["", 4] / reference
    check(f"without it, {locked:.2f} of the rise; more than half is missing",
          max(0, locked - 0.5), 0)


def kirsch(x, y, a, pull):
    """Stresses xx, yy, xy by a hole of radius a in an infinite plate."""
    r, t = math.hypot(x, y), math.atan2(y, x)
    q, c2, s2 = (a / r)**2, math.cos(2 * t), math.sin(2 * t)
    radial = pull / 2 * (1 - q + (1 - 4 * q + 3 * q * q) * c2)
    hoop = pull / 2 * (1 + q - (1 + 3 * q * q) * c2)
    shear = -pull / 2 * (1 + 2 * q - 3 * q * q) * s2
    c, s = math.cos(t), math.sin(t)
    return (radial * c * c + hoop * s * s - 2 * shear * s * c,
            radial * s * s + hoop * c * c + 2 * shear * s * c,
            (radial - hoop) * s * c + shear * (c * c - s * s))


def plate_with_hole(selkie, folder):
    """Kirsch's stresses near the hole; means of the elements' four points.

    The hole is a twentieth of the plate's width: the stress above it is then
    3.008 times the pull instead of 3 (Heywood), 0.3 %. Elements of 6 degrees and
    a tenth of the radius add (6 deg)^2 / 2 = 0.5 %.
    """
    run(selkie, BENCHMARKS / "plate_with_hole.prm", folder, ("Output/Interval=1",), picture=True)
    a, pull = 0.05, 1000.
    file = folder / "solution" / "particles_0001.0.vtu"
    x, stress = vtu_array(file, ""), vtu_array(file, "Cauchy stress")
    worst_error, factor = 0., {}
    for cell in range(len(x) // 12):
        points = range(4 * cell, 4 * cell + 4)
        found, exact = ([sum(values) / 4 for values in zip(*stresses)] for stresses in (
            [(stress[9 * i], stress[9 * i + 4], stress[9 * i + 1]) for i in points],
            [kirsch(x[3 * i], x[3 * i + 1], a, pull) for i in points]))
        X, Y = (sum(x[3 * i + d] for i in points) / 4 for d in (0, 1))
        r, angle = math.hypot(X, Y) / a, math.degrees(math.atan2(Y, X))
        if r < 3:
            worst_error = max(worst_error, *(abs(f - e) for f, e in zip(found, exact)))
        if r < 1.1 and angle > 84:
            factor["above"] = 3 * found[0] / exact[0]
        if r < 1.1 and angle < 6:
            factor["ahead"] = -found[1] / exact[1]
    check("stresses within three radii, of the largest", worst_error / (3 * pull), 0.01)
    check(f"stress above the hole: {factor['above']:.3f} instead of 3", factor["above"] / 3 - 1, 0.01)
    check(f"stress ahead of it: {factor['ahead']:.3f} instead of -1", factor["ahead"] + 1, 0.02)


ELASTICA = {1: (.30172, .05643), 2: (.49346, .16064), 3: (.60325, .25442),
            5: (.71379, .38763), 10: (.81061, .55500)}  # P L^2/EI: v/L, u/L


def at_time(curve, name, t):
    """A column of a curve at time t, linear between its rows."""
    i = next(i for i, time in enumerate(curve["time"]) if time >= t - 1e-9)
    share = (t - curve["time"][i - 1]) / (curve["time"][i] - curve["time"][i - 1])
    return (1 - share) * curve[name][i - 1] + share * curve[name][i]


def elastica(selkie, folder, approximation="q4 fem"):
    """Mattiasson's table of the tip, statically, within 1 %.

    Material points cross cells while the beam turns: gamma = 1.8 and 3 x 3
    points integrate that well enough on a mesh of half the fineness (gamma = 3
    with 2 x 2 points is off by 7 %, doc/verification.md).
    """
    settings = {"q4 fem": (),
                "lme mpm": ("Domain/Cells=105, 105", "LME/Gamma=1.8",
                            "Bodies/beam/Points per direction=3")}[approximation]
    run(selkie, BENCHMARKS / "elastica.prm", folder,
        (f"Approximation={approximation}", *settings))
    tip = table(folder / "probes" / "tip.csv")
    for load, (v, u) in ELASTICA.items():
        check(f"P L^2/EI = {load}: v/L", at_time(tip, "displacement y", load) / 10 / v - 1, 0.01)
        check(f"P L^2/EI = {load}: u/L", -at_time(tip, "displacement x", load) / 10 / u - 1, 0.01)


def scales(s):
    """What a difference in each column is measured by."""
    energies = [name for name in s if "energy" in name and "balance" not in name]
    volume = max(s["volume"])
    dimension = 3 if "momentum z" in s else 2
    length = max([volume**(1 / dimension)]
                 + [abs(x) for d in "xyz" for x in s.get("center of mass " + d, ())])
    energy = max(sum(abs(s[name][i]) for name in energies) for i in range(len(s["time"])))
    momentum = math.sqrt(2 * max(s["mass"]) * energy)
    result = {}
    for name, values in s.items():
        if "energy" in name or name == "external work":
            result[name] = energy
        elif name.startswith("center of mass"):
            result[name] = length
        elif name.startswith("momentum"):
            result[name] = momentum
        elif name.startswith("angular momentum"):
            result[name] = momentum * length
        elif name == "crowding":  # theta - 1
            result[name] = 1.
        else:
            result[name] = max(abs(value) for value in values) or 1.
    return result


def ranks(selkie, folder, what):
    """SCENE:STEPS[:SETTING]: 1, 2 and 3 ranks write the same statistics."""
    scene, steps, *settings = what.split(":")
    path = next(path for path in (HERE / (scene + ".prm"), BENCHMARKS / (scene + ".prm"))
                if path.exists())
    lines = path.read_text().splitlines()
    lines = lines[lines.index("subsection Time"):]
    step = next(float(line.split("=")[1].split("#")[0]) for line in lines
                if line.strip().startswith("set Step "))
    settings.append(f"Time/End time={int(steps) * step!r}")
    one = run(selkie, path, folder / "1", settings, 1)
    by = scales(one)
    if "pressure checkerboard" in by:
        by["pressure checkerboard"] = 1.  # a share: that of still water is round-off
    # The work of the linear solver may depend on the partition; a point may need
    # one more iteration for lambda because of round-off at the tolerance.
    names = [name for name in one if name not in ("linear iterations", "imbalance")
             and "lambda" not in name]
    for n in (2, 3):
        other = run(selkie, path, folder / str(n), settings, n)
        if len(other["time"]) != len(one["time"]):
            check(f"{n} ranks: rows", len(other["time"]) - len(one["time"]), 0)
            print((folder / str(n) / "log.txt").read_text())
            continue
        error = {name: max(abs(a - b) for a, b in zip(one[name], other[name])) / by[name]
                 for name in names}
        lambdas = zip(one["mean lambda iterations"], other["mean lambda iterations"])
        check(f"{n} ranks: mean lambda iterations",
              max(abs(a - b) / max(a, 1.) for a, b in lambdas), 0.01)
        name = max(error, key=error.get)
        check(f"{scene}, {len(one['time'])} steps, {n} ranks: most in '{name}'",
              error[name], 1e-8)


def balance(selkie, folder):
    """A dam break that leaves a rank with too few points: the cells are shared out
    anew, and the statistics stay those of one rank."""
    # (With loose linear solves, whose errors depend on the partition, a step ends
    # near Newton's tolerance, and may need one iteration more.)
    ranks(selkie, folder, "dam_break:80:Domain/Cells=32, 24:Time/Step=2e-3:Domain/Balance steps=5"
          ":Linear solver/Loosest tolerance=1e-8")
    for n in (2, 3):
        with open(folder / str(n) / "timing.csv", newline="") as file:
            calls = sum(int(row["calls"]) for row in csv.DictReader(file) if row["path"] == "balance")
        print(f"       {n} ranks: shared out anew {calls} times")
        if n == 3:
            check("3 ranks: 0 if the points were shared out anew", int(calls == 0), 0)


def main(cases):
    if len(sys.argv) < 3 or sys.argv[1] not in cases:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory(prefix="selkie-scene-") as folder:
        cases[sys.argv[1]](sys.argv[2], pathlib.Path(folder), *sys.argv[3:])
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main(globals())
