#!/usr/bin/python3
"""Nearly incompressible solids in mixed form beside water; prints every figure.

    mixed.py column SELKIE [FACTOR...]      at rest, against one dimension
    mixed.py pressed SELKIE [FACTOR...]     a pressure that jumps, closed form
    mixed.py wall SELKIE [FACTOR...]        a bending wall, against finite elements

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
    """mixed_column.prm at rest: settlement of the block and pressure at the height Y."""
    G, HEIGHT, TOP = 10., 0.4, 1.
    RHO = (1500., 1000.)

    def __init__(self, nu, E=1e5, K_water=2e6):
        shear, K = moduli(E, nu)
        self.shear = shear
        self.piola = (lambda F: (2 / 3 * shear * F**(-2 / 3) * (F * F - 1)
                                 + K / 2 * (F * F - 1)) / F,
                      water(K_water))
        self.of_stretch = (lambda F: -K / 2 * (F - 1 / F), lambda F: -self.piola[1](F))
        self.n, self.settlement = 1000, [0.]
        for i in range(self.n):
            F = self.stretch(self.HEIGHT * (i + 0.5) / self.n)
            self.settlement.append(self.settlement[-1] + (F - 1) * self.HEIGHT / self.n)

    def stretch(self, Y):
        weight = self.G * self.RHO[1] * (self.TOP - max(Y, self.HEIGHT))
        if Y < self.HEIGHT:
            weight += self.G * self.RHO[0] * (self.HEIGHT - Y)
        return stretch(self.piola[Y > self.HEIGHT], -weight)

    def u(self, Y):
        """Of the block (m); the water's is not its memory."""
        return self.settlement[round(Y / self.HEIGHT * self.n)]

    def pressure(self, Y):
        return self.of_stretch[Y > self.HEIGHT](self.stretch(Y))


ALPHA = 0.25  # of the pressure projection


def in_3d(folder):
    """The scene of the column, 0.2 m wide and deep."""
    text = (HERE / "mixed_column.prm").read_text()
    for flat, deep in (("Dimension = 2", "Dimension = 3"), ("0, 0\n", "0, 0, 0\n"),
                       ("0.4, 1.2\n", "0.2, 1.2, 0.2\n"), ("4, 12\n", "2, 12, 2\n"),
                       ("box(0, 0, 0.4, 0.4)", "box(0, 0, 0, 0.2, 0.4, 0.2)"),
                       ("box(0, 0.4, 0.4, 1)", "box(0, 0.4, 0, 0.2, 1, 0.2)"),
                       ("0, -10\n", "0, -10, 0\n")):
        text = text.replace(flat, deep)
    file = folder / "mixed_column_3d.prm"
    file.write_text(text)
    return file


def at_rest(selkie, scene, out, nu, h, settings):
    """The column against the closed form.

    The pressure projection gives way to a gradient of the pressure: next to a boundary
    the volume is wrong by up to alpha (p_a - p)/G_e, p_a - p of the order of rho g h,
    in a layer of h. So the block settles by c alpha rho g h^2/G_e less or more, whatever
    nu is. c was found to be 0.20 to 0.23; it is held below 0.3.
    """
    exact, dt, beta = Column(nu), 0.01, 0.5625
    s = run(selkie, scene, out,
            (f"Bodies/block/Law parameters/Poisson ratio={nu}", *settings), picture=True)
    u, p = [], ([], [])
    for body, X, x, p_i in points(out):
        p[body].append(p_i - exact.pressure(X[1]))
        if body == 0:
            u.append(x[1] - X[1] - exact.u(X[1]))
    rho = exact.RHO[0]
    modulus = exact.shear + rho * h * h / (beta * dt * dt)
    unit = ALPHA * rho * exact.G * h * h / modulus
    check(f"{out.name}, nu = {nu}: rms error of the block's displacement, {rms(u):.2e} m of "
          f"{-exact.u(exact.HEIGHT):.2e} m, over alpha rho g h^2/G_e", rms(u) / unit, 0.3)
    for body, which in enumerate(("block", "water")):
        check(f"   rms error of the pressure of the {which} over that at the floor",
              rms(p[body]) / exact.pressure(0.), 0.01)
    print(f"       Newton iterations a step {sum(s['newton iterations']) / len(s['time']):.2f}",
          flush=True)


def column(selkie, folder, *factors):
    for nu in (0.49, 0.4999):
        for n in map(int, factors or ("1", "2")):
            at_rest(selkie, HERE / "mixed_column.prm", folder / f"h = {0.1 / n} m", nu, 0.1 / n,
                    (f"Domain/Cells={4 * n}, {12 * n}",))
    if not factors:
        at_rest(selkie, in_3d(folder), folder / "3D", 0.4999, 0.1, ())


class Pressed:
    """mixed_beside.prm: plane strain with sigma_xx = 0 and a height exp(-0.001)."""

    def __init__(self, E=1e8, nu=0.4999, sunk=0.001):
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


def pressed_errors(selkie, folder, n, settings=()):
    """Of the block's displacement (L2, over its norm) and, over the jump, of the pressure:
    rms in the block and in the water next to each other, cell by cell from the
    interface."""
    exact, out, h = Pressed(), folder / f"{n}", 0.1 / n
    s = run(selkie, HERE / "mixed_beside.prm", out,
            (f"Domain/Cells={15 * n}, {10 * n}", *settings), picture=True)
    cells = ({}, {})
    for body, X, _, p in points(out):
        if X[1] < 0.4:
            error = (p - (0 if body else exact.pressure)) / exact.pressure
            cells[body].setdefault(int(abs(X[0] - 0.5) / h), []).append(error)
    error = table(out / "probes" / "block.csv")
    u = error["L2 error"][-1] / error["L2 norm of the function"][-1]
    p = [[rms(of_body[k]) for k in range(3)] for of_body in cells]
    print(f"       {15 * n} x {10 * n} cells: error of u {u:.2e}; of p in three rows of cells "
          f"from the interface, block {', '.join(f'{e:.1e}' for e in p[0])}, water "
          f"{', '.join(f'{e:.1e}' for e in p[1])}; Newton iterations a step "
          f"{sum(s['newton iterations']) / len(s['time']):.2f}", flush=True)
    return u, p


def pressed(selkie, folder, *factors):
    """LME functions reproduce the linear displacement, and constant pressures with a
    jump. What is left: the lid's nodes stay while the block sinks by 1e-3 of its height,
    so that 1e-3 of the stress is missing there; and water has its inertia, rho a L = 5 Pa
    of a jump of 67 kPa. A pressure common to both phases is wrong by 0.5 of the jump in
    the first cells of the block, and the displacement by 1e-2."""
    for n in map(int, factors or ("1", "2")):
        u, p = pressed_errors(selkie, folder, n)
        check("error of the displacement over its norm", u, 1e-3)
        check("largest rms error of the pressure over the jump", max(p[0] + p[1]), 2e-3)


def wall(selkie, folder, *factors):
    """A bending wall (no closed form) against finite elements with an eighth of the
    cells' size, whose own error is about 0.6 % (they gave 0.6 % less with a quarter).
    Two cells across bend badly; the error falls, with an order of 1 at least, to 5 %
    at eight cells across."""
    def tip(name, n, *settings):
        run(selkie, HERE / "mixed_wall.prm", folder / name,
            (f"Domain/Cells={10 * n}, {9 * n}", *settings))
        return 1e3 * table(folder / name / "probes" / "tip.csv")["displacement x"][-1]

    reference = tip("elements", 8, "Approximation=q4 fem")
    print(f"       finite elements: {reference:.2f} mm", flush=True)
    last = math.inf
    for n in map(int, factors or ("1", "2", "4")):
        found = tip(f"{n}", n)
        error = abs(found / reference - 1)
        check(f"h = {0.1 / n} m: {found:.2f} mm; error over half of the last one's",
              error / (0.5 * last), 1)
        last = error
    check("error of the finest", last, 0.05)


if __name__ == "__main__":
    main(globals())
