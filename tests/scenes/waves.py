#!/usr/bin/python3
"""A small standing wave that viscosity damps, against the linear theory.

    waves.py CASE SELKIE [ARGUMENT ...]

CASE is a function of this file. Exit code 1 if a figure is beyond its bound.
"""
import cmath
import math

from check import BENCHMARKS, check, main, run, table

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


def exact(nu, t, depth=DEPTH):
    """a(t) / a0 on water of finite depth over a slip bottom.

    A potential part cosh k(y + h) and a rotational one sinh m(y + h), m^2 = k^2 +
    s / nu, no stress on the surface, at rest at the start: the transform of a / a0 is
    D / (s (D + g k)), D = (s + 2n)^2 coth kh - 4 n^2 (m/k) coth mh, n = nu k^2.
    Inverted along Talbot's contour (Abate and Valko 2004), wide enough for 3 s.
    """
    if t == 0:
        return 1.
    n = nu * K * K

    def transform(s):
        ratio = cmath.sqrt(1 + s / n)
        mh = ratio * K * depth
        D = (s + 2 * n)**2 / math.tanh(K * depth) \
            - 4 * n * n * ratio * (1 / cmath.tanh(mh) if mh.real < 300 else 1)
        return D / (s * (D + G * K))

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
    """The two formulas against each other and against the table of references.md."""
    known = {0.1: (0.865351, -0.403966, 0.027220, -0.071212),
             0.01: (0.851674, -0.845921, 0.595699, 0.027436),
             0.001: (0.850015, -0.923828, 0.727365, 0.098768)}
    for nu, values in known.items():
        for t, value in zip((0.1, 0.5, 1., 2.), values):
            check(f"nu {nu}, t {t}: Prosperetti - table", prosperetti(nu, t) - value, 1e-6)
            check(f"nu {nu}, t {t}: finite depth, h = 100 m, - table",
                  exact(nu, t, 100.) - value, 1e-5)


def amplitude(folder):
    """Times and first mode over its start, of the uppermost row of points: both
    crests less the trough between them. Crests and trough share the second mode
    (k a0^2 / 2 at the surface) and any sinking, which so drop out."""
    left, middle, right = (table(folder / "probes" / f"{name}.csv")
                           for name in ("left", "middle", "right"))
    mode = [(a + c - 2 * b) / 4 for a, b, c in
            zip(*(p["displacement y"] for p in (left, middle, right)))]
    return left["time"], [m / mode[0] for m in mode]


def deviations(folder, nu):
    """Of a(t) / a0 from theory: largest, rms; at the troughs and crests, t = T/2 to
    2T: the amplitude's own; period's lag from the zeros (share of it)."""
    times, mode = amplitude(folder)
    theory = [exact(nu, t) for t in times]
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


def wave(selkie, folder, nu, cells=40, settings=()):
    cells = int(cells)
    h, rows = 2 / cells, math.ceil(0.6 * cells)
    top = 1 - 0.4 * h  # above it: the uppermost row of 2 or 3 points a cell
    run(selkie, BENCHMARKS / "standing_wave.prm", folder,
        (f"Domain/Cells={cells}, {rows}", f"Domain/Upper corner=2, {rows * h!r}",
         f"Bodies/water/Law parameters/Viscosity={1000 * float(nu)!r}",
         f"Probes/left/Shape=box(0, {top!r}, {h!r}, 1)",
         f"Probes/middle/Shape=box({1 - h!r}, {top!r}, {1 + h!r}, 1)",
         f"Probes/right/Shape=box({2 - h!r}, {top!r}, 2, 1)",
         f"Time/Step={0.2 / cells!r}", *settings))
    return report(folder, nu)


def report(folder, nu):
    """Prints what deviations() finds."""
    e = deviations(folder, float(nu))
    print(f"       nu {nu}: largest deviation / a0 {e['largest']:.4f}, rms {e['rms']:.4f} "
          f"(from deep water {e['deep']:.4f})\n       at troughs and crests "
          + ", ".join(f"{x:+.4f}" for x in e["extremes"])
          + "; zeros late by " + ", ".join(f"{x:+.4f}" for x in e["lag"]))
    return e


def standing_wave(selkie, folder, nu="0.01", cells="40", *settings):
    """The amplitude, over two periods."""
    e = wave(selkie, folder, nu, cells, settings)
    check(f"nu {nu}, {cells} cells: largest deviation of the amplitude / a0", e["largest"], 0.03)


if __name__ == "__main__":
    main(globals())
