#!/usr/bin/python3
"""A small standing wave that viscosity damps, against the linear theory.

    waves.py CASE SELKIE [ARGUMENT ...]

CASE is a function of this file. Exit code 1 if a figure is beyond its bound.
"""
import cmath
import math
import re

from check import BENCHMARKS, check, main, run, table, vtu_array

K, G, DEPTH, A0 = math.pi, 9.81, 1., 0.01


def prosperetti(nu, t, g=G):
    """a(t) / a0 on deep water (references.md, 3a).

    erfc by its power series: |z| < 4 here, which costs seven of 16 digits.
    """
    def erfc(z):
        term, total, n = z, z, 0
        while abs(term) > 1e-17 * abs(total) and n < 200:
            n += 1
            term *= -z * z / n
            total += term / (2 * n + 1)
        return 1 - 2 / math.sqrt(math.pi) * total

    n, w2 = nu * K**2, g * K
    roots = [cmath.sqrt(cmath.sqrt(-w2) * s) * r for s in (1, -1) for r in (1, -1)]
    for _ in range(100):  # Durand and Kerner
        for i, z in enumerate(roots):
            value = z**4 + 2 * n * z**2 + 4 * n**1.5 * z + n**2 + w2
            roots[i] = z - value / math.prod(z - y for j, y in enumerate(roots) if j != i)
    a = 4 * n**2 / (8 * n**2 + w2) * erfc(math.sqrt(n * t) + 0j)
    for i, z in enumerate(roots):
        Z = math.prod(y - z for j, y in enumerate(roots) if j != i)
        a += z / Z * w2 / (z * z - n) * cmath.exp((z * z - n) * t) * erfc(z * math.sqrt(t))
    return a.real


def exact(nu, t, depth=DEPTH, below=0.):
    """a(t) / a0 on water of finite depth over a slip bottom, of the surface or of the
    water `below` it.

    A potential part cosh k(y + h) and a rotational one sinh m(y + h), m^2 = k^2 +
    s / nu, no stress on the surface, at rest at the start: the transform of the
    surface's a / a0 is D / (s (D + g k)), D = (s + 2n)^2 coth kh - 4 n^2 (m/k) coth mh,
    n = nu k^2. The stress-free surface gives the rotational part, -2n / s of its
    velocity there and the potential part 1 + 2n / s of it, so that water which follows
    f = sinh k(y + h) / sinh kh without viscosity lags by 2n (f - g) / s of it,
    g = sinh m(y + h) / sinh mh. Inverted along Talbot's contour (Abate and Valko 2004),
    wide enough for 3 s.
    """
    if t == 0:
        return 1.
    n = nu * K * K

    def transform(s):
        ratio = cmath.sqrt(1 + s / n)
        mh = ratio * K * depth
        D = (s + 2 * n)**2 / math.tanh(K * depth) \
            - 4 * n * n * ratio * (1 / cmath.tanh(mh) if mh.real < 300 else 1)
        surface = D / (s * (D + G * K))
        f = math.sinh(K * (depth - below)) / math.sinh(K * depth)
        m_below = ratio * K * below
        g = cmath.sinh(mh - m_below) / cmath.sinh(mh) if mh.real < 300 \
            else cmath.exp(-m_below)
        return surface + (s * surface - 1) * 2 * n / (s * s) * (1 - g / f)

    M = 32
    total = 0.5 * math.exp(2 * M / 5) * transform(2 * M / (5 * t) + 0j).real
    for k in range(1, M):
        angle = k * math.pi / M
        cot = 1 / math.tan(angle)
        delta = 2 * k * math.pi / 5 * (cot + 1j)
        weight = (1 + 1j * angle * (1 + cot * cot) - 1j * cot) * cmath.exp(delta)
        total += (weight * transform(delta / t)).real
    return 0.4 / t * total


def formulas(*_):
    """The two formulas against each other and against the table of references.md;
    below the surface: next to it, at the start and without viscosity."""
    known = {0.1: (0.865351, -0.403966, 0.027220, -0.071212),
             0.01: (0.851674, -0.845921, 0.595699, 0.027436),
             0.001: (0.850015, -0.923828, 0.727365, 0.098768)}
    for nu, values in known.items():
        for t, value in zip((0.1, 0.5, 1., 2.), values):
            check(f"nu {nu}, t {t}: Prosperetti - table", prosperetti(nu, t) - value, 1e-6)
            check(f"nu {nu}, t {t}: finite depth, h = 100 m, - table",
                  exact(nu, t, 100.) - value, 1e-5)
            check(f"nu {nu}, t {t}: 1e-7 m below the surface - at it",
                  exact(nu, t, below=1e-7) - exact(nu, t), 1e-5)
        check(f"nu {nu}, half the depth, t 1e-3: its displacement - 1",
              exact(nu, 1e-3, below=0.5) - 1, 1e-4)
    check("nu 1e-6, a tenth of the depth, t 1: displacement - the surface's",
          exact(1e-6, 1., below=0.1) - exact(1e-6, 1.), 1e-4)


def amplitude(folder):
    """Times and first mode over its start, of the uppermost row of points: both
    crests less the trough between them. Crests and trough share the second mode
    (k a0^2 / 2 at the surface) and any sinking, which so drop out."""
    left, middle, right = (table(folder / "probes" / f"{name}.csv")
                           for name in ("left", "middle", "right"))
    mode = [(a + c - 2 * b) / 4 for a, b, c in
            zip(*(p["displacement y"] for p in (left, middle, right)))]
    return left["time"], [m / mode[0] for m in mode]


def deviations(folder, nu, below):
    """Of a(t) / a0 from theory at the depth of the points: largest, rms; at the troughs
    and crests, t = T/2 to 2T: the amplitude's own; period's lag from the zeros (share
    of it)."""
    times, mode = amplitude(folder)
    theory = [exact(nu, t, below=below) for t in times]
    errors = [m - a for m, a in zip(mode, theory)]

    def zeros(a):
        return [s + (t - s) * p / (p - q) for s, t, p, q in zip(times, times[1:], a, a[1:])
                if p * q < 0]

    def extremes(a):
        found, marks = [], [0, *zeros(a)]
        for s, t in zip(marks[1:], marks[2:]):
            found.append(max(abs(x) for x, at in zip(a, times) if s < at < t))
        return found

    return {"largest": max(map(abs, errors)),
            "rms": math.sqrt(sum(e * e for e in errors) / len(errors)),
            "extremes": [a - b for a, b in zip(extremes(mode), extremes(theory))],
            "lag": [a / b - 1 for a, b in zip(zeros(mode), zeros(theory))],
            "deep": max(abs(m - prosperetti(nu, t)) for m, t in zip(mode, times) if t > 0)}


def points_per_direction(settings):
    return next((int(value) for key, _, value in (s.partition("=") for s in settings)
                 if key == "Bodies/water/Points per direction"), 4)


def wave(selkie, folder, nu, cells=40, settings=(), picture=False):
    cells = int(cells)
    h, rows = 2 / cells, math.ceil(0.6 * cells)
    points = points_per_direction(settings)
    top = 1 - h / points  # above it: the uppermost row of points
    run(selkie, BENCHMARKS / "standing_wave.prm", folder,
        (f"Domain/Cells={cells}, {rows}", f"Domain/Upper corner=2, {rows * h!r}",
         f"Bodies/water/Law parameters/Viscosity={1000 * float(nu)!r}",
         f"Probes/left/Shape=box(0, {top!r}, {h!r}, 1)",
         f"Probes/middle/Shape=box({1 - h!r}, {top!r}, {1 + h!r}, 1)",
         f"Probes/right/Shape=box({2 - h!r}, {top!r}, 2, 1)",
         f"Time/Step={0.2 / cells!r}", *settings), picture=picture)
    return report(folder, nu, h / points / 2)


def report(folder, nu, below):
    """Prints what deviations() finds."""
    e = deviations(folder, float(nu), below)
    print(f"       nu {nu}: largest deviation / a0 {e['largest']:.4f}, rms {e['rms']:.4f} "
          f"(from deep water {e['deep']:.4f})\n       at troughs and crests "
          + ", ".join(f"{x:+.4f}" for x in e["extremes"])
          + "; zeros late by " + ", ".join(f"{x:+.4f}" for x in e["lag"]))
    return e


def standing_wave(selkie, folder, nu="0.01", cells="40", *settings):
    """The amplitude, over two periods."""
    e = wave(selkie, folder, nu, cells, settings)
    check(f"nu {nu}, {cells} cells: largest deviation of the amplitude / a0", e["largest"], 0.03)


def depths(selkie, folder, nu="0.01", cells="40", *settings):
    """The first mode of the displacement of single rows of points, over two periods;
    over f, so that all would be a(t) / a0 without viscosity."""
    wave(selkie, folder, nu, cells, (*settings, "Output/Interval=0.1"), picture=True)
    spacing = 2 / int(cells) / points_per_direction(settings)
    worst = {}
    for time, name in re.findall(r'timestep="([^"]*)"[^>]*file="solution/([^"]*)"',
                                 (folder / "particles.pvd").read_text()):
        file = folder / "solution" / name.replace(".pvtu", ".0.vtu")
        x, u = vtu_array(file, ""), vtu_array(file, "displacement")
        rows = {}  # by number from below, of single precision
        for i in range(0, len(x), 3):
            rows.setdefault(math.floor((x[i + 1] - u[i + 1]) / spacing), []).append(
                u[i + 1] * math.cos(K * (x[i] - u[i])))
        for n in (1, 2, 4, 8, len(rows) // 2, 3 * len(rows) // 4):
            row = rows[len(rows) - n]
            y = (len(rows) - n + 0.5) * spacing
            f = math.sinh(K * y) / math.sinh(K)
            mode = 2 * sum(row) / len(row) / A0 / f
            error = abs(mode - exact(float(nu), float(time), below=1 - y))
            lag = abs(mode - exact(float(nu), float(time)))
            worst[n] = [max(pair) for pair in zip(worst.get(n, (0, 0)), (error, lag))]
    for n, (error, lag) in worst.items():
        print(f"       row {n} from above: {error:.3f} from theory there, "
              f"{lag:.3f} from that of the surface")


def corner(*_):
    """doc/data/standing_wave.csv: the mean displacement of the water within 0.1 m of the
    left wall and of the surface, nu = 0.001."""
    width, nu, n = 0.1, 0.001, 20
    depths = [(i + 0.5) * width / n for i in range(n)]
    start = [A0 * math.sin(K * width) / (K * width)
             * math.sinh(K * (DEPTH - below)) / math.sinh(K * DEPTH) for below in depths]
    print("time (s),displacement y (m)")
    for step in range(229):
        t = step / 100
        mean = sum(a * exact(nu, t, below=below) for a, below in zip(start, depths)) / n
        print(f"{t:.2f},{mean:.6e}")


if __name__ == "__main__":
    main(globals())
