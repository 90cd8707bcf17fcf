#!/usr/bin/python3
"""Nearly incompressible solids in mixed form beside water; prints every figure.

    mixed.py column SELKIE [FACTOR...]      at rest, against one dimension
    mixed.py pressed SELKIE [FACTOR...]     a pressure that jumps, closed form

FACTOR divides the cells of the scene's file. Exit code 1 if a figure is beyond its
bound.
"""
import math

from check import HERE, check, main, run, table, vtu_array
from coupled import stretch, water
from water import pictures


def moduli(E, nu):
    return E / (2 * (1 + nu)), E / (3 * (1 - 2 * nu))


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def points(folder):
    """(body, X, x, pressure) of the points in the last picture."""
    names = ("body", "reference position", "", "pressure")
    *_, (_, (body, X, x, p)) = pictures(folder, *names)
    dim = len(X) // len(body)
    for i, (b, p_i) in enumerate(zip(body, p)):
        yield int(b), X[dim * i:dim * (i + 1)], x[3 * i:3 * (i + 1)], p_i


class Column:
    """mixed_column.prm at rest: settlement and pressure at the height Y."""
    G, HEIGHT, TOP = 10., 0.4, 1.
    RHO = (1500., 1000.)

    def __init__(self, E=1200, nu=0.4999, K_water=2e6, n=2000):
        shear, K = moduli(E, nu)
        self.piola = (lambda F: (2 / 3 * shear * F**(-2 / 3) * (F * F - 1)
                                 + K / 2 * (F * F - 1)) / F,
                      water(K_water))
        self.of_stretch = (lambda F: -K / 2 * (F - 1 / F), lambda F: -self.piola[1](F))
        self.n, self.settlement = n, [0.]
        for i in range(n):
            Y = self.TOP * (i + 0.5) / n
            self.settlement.append(self.settlement[-1] + (self.stretch(Y) - 1) * self.TOP / n)

    def stretch(self, Y):
        weight = self.G * self.RHO[1] * (self.TOP - max(Y, self.HEIGHT))
        if Y < self.HEIGHT:
            weight += self.G * self.RHO[0] * (self.HEIGHT - Y)
        return stretch(self.piola[Y > self.HEIGHT], -weight)

    def u(self, Y):
        return self.settlement[round(Y / self.TOP * self.n)]

    def pressure(self, Y):
        return self.of_stretch[Y > self.HEIGHT](self.stretch(Y))


def column_errors(selkie, folder, name, settings):
    """rms of (u of the block, u of the water, p of the block, p of the water) over the
    largest of each."""
    exact = Column()
    s = run(selkie, HERE / "mixed_column.prm", folder / name, settings, picture=True)
    u, p = ([], []), ([], [])
    for body, X, x, p_i in points(folder / name):
        u[body].append(x[1] - X[1] - exact.u(X[1]))
        p[body].append(p_i - exact.pressure(X[1]))
    below, above = exact.pressure(0.), exact.pressure(exact.HEIGHT + 1e-9)
    errors = (rms(u[0]) / -exact.u(exact.HEIGHT), rms(u[1]) / -exact.u(exact.TOP),
              rms(p[0]) / below, rms(p[1]) / above)
    print(f"       {name}: rms error of u, block {errors[0]:.2e}, water {errors[1]:.2e}; of p, "
          f"block {errors[2]:.2e}, water {errors[3]:.2e}; Newton iterations a step "
          f"{sum(s['Newton iterations']) / len(s['time']):.2f}", flush=True)
    return errors


def column(selkie, folder, *factors):
    for n in map(int, factors or ("1", "2")):
        column_errors(selkie, folder, f"{n}", (f"Domain/Cells={4 * n}, {12 * n}",))


class Pressed:
    """mixed_beside.prm: plane strain with sigma_xx = 0 and a height exp(-0.01)."""

    def __init__(self, E=1e7, nu=0.4999, sunk=0.01):
        self.height = math.exp(-sunk)  # nodes stay where they are and give a speed
        shear, K = moduli(E, nu)

        def stress(width):
            J = width * self.height
            mean = (width**2 + self.height**2 + 1) / 3
            return shear * J**(-5 / 3) * (width**2 - mean) + K / 2 * (J - 1 / J)

        low, high = 1., 1.1
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if stress(middle) < 0 else (low, middle)
        self.width = low
        J = self.width * self.height
        self.pressure = -K / 2 * (J - 1 / J)


def pressed_errors(selkie, folder, n):
    """rms error of the block's displacement (m), and of the pressure over the jump:
    in the block, in the water, and by the distance from the interface in cells."""
    exact, out, h = Pressed(), folder / f"{n}", 0.1 / n
    s = run(selkie, HERE / "mixed_beside.prm", out,
            (f"Domain/Cells={15 * n}, {12 * n}",
             f"Probes/block/Function={exact.width - 1!r}*X; {exact.height - 1!r}*Y"), picture=True)
    block, beside, all_block, all_water = {}, {}, [], []
    for body, X, x, p in points(out):
        error = (p - (0 if body else exact.pressure)) / exact.pressure
        (all_water if body else all_block).append(error)
        if x[1] < 0.4:
            bins = beside if body else block
            bins.setdefault(int(abs(X[0] - 0.5) / h), []).append(error)
    error = table(out / "probes" / "block.csv")
    name = next(name for name in error if name.startswith("rms"))
    rows = ["    ".join(f"{rms(bins[k]):.3f}" for k in range(3)) for bins in (block, beside)]
    print(f"       {15 * n} x {12 * n} cells: rms error of u {error[name][-1]:.3e} m; of p over the "
          f"jump, block {rms(all_block):.3f}, water {rms(all_water):.3f}; cell by cell from the "
          f"interface, block {rows[0]}, water {rows[1]}; Newton iterations a step "
          f"{sum(s['Newton iterations']) / len(s['time']):.2f}", flush=True)
    return error[name][-1], rms(all_block), rms(all_water)


def pressed(selkie, folder, *factors):
    for n in map(int, factors or ("1", "2")):
        pressed_errors(selkie, folder, n)


if __name__ == "__main__":
    main(globals())
