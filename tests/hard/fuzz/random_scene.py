"""Small scenes made by chance, within what doc/parameters.md allows, and now and
then beyond it."""
import copy
import math
import random

SOLIDS = ("neo hookean", "isochoric neo hookean", "saint venant kirchhoff", "mooney rivlin")
FLUIDS = ("newtonian fluid", "bingham fluid")
WALLS = ("left", "right", "bottom", "top", "front", "back")
AXES = "xyz"


def number(x):
    return f"{x:.12g}"


def vector(x, separator=", "):
    return separator.join(map(number, x))


class Scene:
    """Parameters by their path, the number of ranks, and what is wrong with it."""

    def __init__(self):
        self.values, self.ranks, self.wrong = {}, 1, None

    def get(self, path, default=""):
        return self.values.get(path, default)

    def text(self):
        tree = {}
        for path, value in self.values.items():
            *sections, name = path.split("/")
            node = tree
            for section in sections:
                node = node.setdefault(section + "/", {})
            node[name] = value

        def lines(node, indent):
            for name, value in node.items():
                if isinstance(value, dict):
                    yield from (f"{indent}subsection {name[:-1]}", *lines(value, indent + "  "), f"{indent}end")
                else:
                    yield f"{indent}set {name} = {value}"
        return "\n".join(lines(tree, "")) + "\n"

    def smaller(self):
        """Scenes with one thing less: a section, an item of a list, a value."""
        def without(keep, ranks=self.ranks, **changed):
            scene = copy.deepcopy(self)
            scene.values = {p: changed.get(p, v) for p, v in self.values.items() if keep(p)}
            scene.ranks = ranks
            return scene

        if self.ranks > 1:
            yield without(lambda p: True, ranks=1)
        for path, value in self.values.items():
            if path == "Effects" or path.endswith("/Names"):
                items = value.split(", ")
                for item in items if len(items) > 1 else []:
                    inside = path[:-5] + item + "/" if path != "Effects" else item.capitalize() + "/"
                    yield without(lambda p: not p.startswith(inside),
                                  **{path: ", ".join(i for i in items if i != item)})
        sections = {path[:i + 1] for path in self.values for i, c in enumerate(path) if c == "/"}
        for section in sorted(sections, key=len):
            yield without(lambda p: not p.startswith(section))
        for path in self.values:
            yield without(lambda p: p != path)


class Maker:
    """Makes one scene; each method a part of it."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.scene = Scene()

    # Chance.

    def maybe(self, probability):
        return self.random.random() < probability

    def among(self, *values):
        return self.random.choice(values)

    def log(self, low, high):
        return math.exp(self.random.uniform(math.log(low), math.log(high)))

    def set(self, path, value):
        self.scene.values[path] = value if isinstance(value, str) else number(value)

    # Functions of space and time, small in the sense of the argument.

    def function(self, size, places="xy", time=True):
        r = self.random.uniform(-1, 1) * size
        x = self.among(*places)
        return self.among(number(r), number(r), f"{r:.4g}*sin({1 / self.h:.4g}*{x})",
                          *([f"{r:.4g}*sin({1 / self.dt:.4g}*t)", f"{r:.4g}*min(1, t/{self.end:.6g})"] if time else []))

    def functions(self, size, places=None, time=True):
        return "; ".join(self.function(size, places or AXES[:self.dim], time) for _ in range(self.dim))

    # Parts.

    def make(self):
        r = self.random
        self.dim = 3 if self.maybe(0.15) else 2
        self.scene.ranks = 2 if self.maybe(0.25) else 1
        self.approximation = self.among("lme mpm", "lme mpm", "lme mpm", "q4 mpm", "q4 fem")
        self.static = self.maybe(0.12)
        self.h = round(self.log(0.01, 0.5), 3)
        self.cells = [r.randint(4, 10) if self.dim == 2 else r.randint(2, 5) for _ in range(self.dim)]
        self.lower = [self.h * r.choice((0, 0, -2, 3)) for _ in range(self.dim)]
        self.effects = []
        self.boxes, self.fluids, self.solids, self.stiffest = {}, [], [], 0.
        self.set("Dimension", self.dim)
        if self.maybe(0.95):
            self.set("Approximation", self.approximation)
        else:
            self.approximation = "lme mpm"
        self.set("Effects", "")
        self.domain()
        self.bodies()
        self.times()
        self.walls()
        self.velocities()
        if not self.static:
            self.effects.append("inertia")
            self.inertia()
        self.loads()
        self.node_sets()
        self.contact()
        self.solid_cures()
        self.probes()
        self.numerics()
        self.adaptivity()
        self.own_nodes()
        if "prescribed motion" not in self.effects and self.moves:
            self.effects.append("prescribed motion")
        r.shuffle(self.effects)
        self.set("Effects", ", ".join(self.effects))
        if self.maybe(0.2):
            self.spoil()
        return self.scene

    def at(self, d, cell):
        return self.lower[d] + cell * self.h

    def box(self, low, high):
        """Of corners in cells."""
        return "box(" + ", ".join(number(self.at(d, c[d])) for c in (low, high) for d in range(self.dim)) + ")"

    def domain(self):
        self.set("Domain/Lower corner", vector(self.lower))
        self.set("Domain/Upper corner", vector([self.at(d, n) for d, n in enumerate(self.cells)]))
        self.set("Domain/Cells", vector(self.cells))
        self.set("Points leaving", self.among("stop", "keep", "remove"))
        if self.maybe(0.15):
            self.set("Domain/Refinements/Names", "fine")
            low = [self.random.uniform(0, 0.6 * n) for n in self.cells]
            self.set("Domain/Refinements/fine/Shape",
                     self.box(low, [self.random.uniform(c, n) + 0.1 for c, n in zip(low, self.cells)]))
            if self.maybe(0.3):
                self.set("Domain/Refinements/fine/Levels", self.among(1, 2) if self.dim == 2 else 1)

    def shape(self, low, high):
        """A shape within a box, corners in cells."""
        kind = self.among(*["box"] * 6, "round", "round", "polygon", "cut", "inside", "sum")
        if self.approximation == "q4 fem" and self.maybe(0.9):
            kind = "box"  # meshes fit them
        size = [b - a for a, b in zip(low, high)]
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        radius = min(size) / 2
        ball = (f"{'disc' if self.dim == 2 else 'sphere'}({vector([self.at(d, c) for d, c in enumerate(middle)])}, "
                "{})")
        if kind == "box" or radius < 0.9:
            self.is_box = True
            return self.box(low, high)
        self.is_box = False
        if kind == "round":
            return ball.format(number(radius * self.h))
        if kind == "cut":
            return f"{self.box(low, high)} - {ball.format(number(0.4 * radius * self.h))}"
        if kind == "inside":
            x, y = number(self.at(0, middle[0])), number(self.at(1, middle[1]))
            return (self.box(low, high).replace("box", "inside")[:-1]
                    + f", {number((0.9 * radius * self.h)**2)} - (x - {x})^2 - (y - {y})^2)")
        if kind == "polygon" and self.dim == 2:
            (a, b), (c, d) = ([self.at(i, p[i]) for i in (0, 1)] for p in (low, high))
            return f"polygon({vector([a, b, c, b, *self.among(((a + c) / 2, d), (c, d, a, (b + d) / 2))])})"
        half = [middle[0], *high[1:]]
        return f"{self.box(low, half)} + {self.box([middle[0], *low[1:]], [high[0], *high[1:-1], (low[-1] + high[-1]) / 2])}"

    def bodies(self):
        r = self.random
        count = self.among(1, 1, 2, 2, 3)
        # Slots side by side along x, which may touch or leave a gap.
        cuts = sorted(r.sample(range(1, self.cells[0]), min(count - 1, self.cells[0] - 1)))
        edges = [0, *cuts, self.cells[0]]
        names = ["water", "block", "lump"]
        r.shuffle(names)
        names = names[:len(edges) - 1]
        self.set("Bodies/Names", ", ".join(names))
        for name, a, b in zip(names, edges, edges[1:]):
            snapped = self.approximation == "q4 fem" or self.maybe(0.6)
            low = [a, *(self.among(0, 0, r.randint(0, n // 3)) for n in self.cells[1:])]
            if self.static:  # all stand on a floor that holds them
                low[1] = 0
            high = [b, *(r.randint(c + 1, n) for c, n in zip(low[1:], self.cells[1:]))]
            if b - a > 2 and self.maybe(0.6):
                high[0] -= 1
            if b - a > 3 and self.maybe(0.4):
                low[0] += 1
            if not snapped:
                low = [c + r.uniform(0, 0.3) * (c > 0 or not self.static) for c in low]
                high = [c - r.uniform(0, 0.3) for c in high]
            self.body(name, low, high)

    def body(self, name, low, high):
        r, path = self.random, f"Bodies/{name}/"
        law = self.among(*SOLIDS) if self.static or self.maybe(0.5) else self.among(FLUIDS[0], FLUIDS[0], FLUIDS[1])
        (self.fluids if law in FLUIDS else self.solids).append(name)
        self.set(path + "Law", law)
        self.set(path + "Shape", self.shape(low, high))
        self.boxes[name] = (low, high, self.is_box)
        if self.maybe(0.5):
            self.set(path + "Points per direction", r.randint(1, 4) if self.dim == 2 else r.randint(1, 2))
        if self.maybe(0.2):
            self.set(path + "Jitter", r.uniform(0, 0.5) if self.maybe(0.3) else r.uniform(0, 0.3))
        self.law(law, path + "Law parameters/", name)

    def law(self, law, path, name):
        r = self.random
        density = self.log(200, 4000)
        self.set(path + "Density", density)
        self.set_law = lambda **values: [self.set(path + n.replace("_", " "), v) for n, v in values.items()]
        if law == "mooney rivlin":
            c10, c01 = self.log(1e4, 1e6), self.among(0, self.log(1e3, 1e5))
            modulus = (4 / 3 * c10 + 16 / 3 * c01) * self.log(1.01, 20)
            self.set_law(Mooney_C10=c10, Mooney_C01=c01, Bulk_modulus=modulus)
            modulus += 8 / 3 * (c10 + c01)
        elif law in SOLIDS:
            E, nu = self.log(1e4, 1e8), self.among(0, 0.2, 0.3, 0.4, 0.45, 0.49)
            self.set_law(Young_modulus=E, Poisson_ratio=nu)
            modulus = E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
        else:
            modulus = self.log(1e5, 1e8)
            self.set_law(Bulk_modulus=modulus)
            if self.maybe(0.3):
                self.set_law(Pressure_exponent=self.among(1.5, 4, 7), Reference_pressure=self.among(0, 1e3))
            if law == "bingham fluid":
                if "viscosity" not in self.effects:
                    self.effects.append("viscosity")
                self.set_law(Plastic_viscosity=self.log(1e-3, 1e3), Yield_stress=self.log(1, 1e3),
                             Regularisation=self.log(1, 1e3))
            elif "viscosity" in self.effects or self.maybe(0.5):
                self.set_law(Viscosity=self.log(1e-4, 1e4))
                if "viscosity" not in self.effects:
                    self.effects.append("viscosity")
        self.softest = min(getattr(self, "softest", 1e99), modulus)
        self.stiffest = max(self.stiffest, math.sqrt(modulus / density))
        self.slowest = min(getattr(self, "slowest", 1e99), math.sqrt(modulus / density))

    def times(self):
        self.steps = self.random.randint(5, 20) if self.dim == 2 else self.random.randint(3, 8)
        self.dt = 0.1 if self.static else float(f"{self.h / self.stiffest * self.log(0.1, 4):.3g}")
        self.end = self.dt * self.steps
        self.set("Time/End time", self.end)
        self.set("Time/Step", self.dt)
        if self.maybe(0.1):
            self.set("Time/Smallest step", self.dt / self.among(2, 64, 1e4))
        if self.maybe(0.1):
            self.set("Time/Largest move", self.random.uniform(0.05, 0.9))
        if self.maybe(0.15):
            self.set("Time/Estimate errors", "true")
        # Fast, but less than a cell a step and less than sound.
        self.speed = min(0.2 * self.h / self.dt, 0.1 * self.slowest)

    def walls(self):
        self.conditions, self.moves = {}, False
        for wall in WALLS[:2 * self.dim]:
            kind = self.among("slip", "slip", "fixed", "free", *(["prescribed"] if self.maybe(0.2) else []))
            self.conditions[wall] = kind
            if kind == "prescribed":
                self.moves = True
                parts = [self.function(0.1 * self.speed, AXES[:self.dim]) for _ in range(self.dim)]
                if self.maybe(0.3):
                    parts[self.random.randrange(self.dim)] = "free"
                self.set(f"Domain/Walls/{wall} velocity", "; ".join(parts))
            if kind != "slip" or self.maybe(0.5):
                self.set(f"Domain/Walls/{wall}", kind)
        if self.static:
            self.set("Domain/Walls/bottom", "fixed")
            self.scene.values.pop("Domain/Walls/bottom velocity", None)
            self.conditions["bottom"] = "fixed"
            self.moves = "prescribed" in self.conditions.values()

    def velocities(self):
        for name in self.boxes:
            if not self.static and self.maybe(0.5):
                self.set(f"Bodies/{name}/Initial velocity", self.functions(self.speed, time=False))
            if name in self.fluids and self.maybe(0.1):
                self.set(f"Bodies/{name}/Initial displacement", self.functions(0.1 * self.h, AXES[:self.dim].upper(), False))

    def inertia(self):
        if self.maybe(0.4):
            gamma = self.random.uniform(0.5, 1)
            self.set("Inertia/Newmark beta", (gamma + 0.5)**2 / 4)
            self.set("Inertia/Newmark gamma", gamma)
        if self.maybe(0.2):
            self.set("Inertia/Mass", self.among("automatic", "lumped", "consistent"))
        if self.fluids and self.maybe(0.25):
            self.set("Fluid pressure/Volume correction", self.among(0, 20, 100))
            self.set("Fluid pressure/Gauss points in full cells", self.among("true", "false"))
            self.set("Fluid pressure/Stabilisation", self.among(0, 0.25, 1))

    def loads(self):
        r, dim = self.random, self.dim
        soft = 0.02 * self.slowest**2 / (self.h * max(self.cells))
        if self.maybe(0.5):
            self.effects.append("gravity")
            g = min(9.81, soft) if self.maybe(0.7) else soft
            direction = [r.uniform(-1, 1) for _ in range(dim)] if self.maybe(0.2) else [0, -1, 0][:dim]
            self.set("Gravity/Acceleration", vector([float(f"{g * x:.4g}") for x in direction]))
            if self.fluids and self.maybe(0.5):
                self.effects.append("hydrostatic start")
                if self.maybe(0.3):
                    self.set("Hydrostatic start/Bodies", r.choice(self.fluids))
        if self.maybe(0.15):
            self.effects.append("body force")
            self.set("Body force/Acceleration", self.functions(soft, AXES[:dim].upper() + AXES[:dim]))
        loaded = [n for n in self.solids if self.boxes[n][2]]
        if loaded and self.maybe(0.4):
            self.effects.append("traction")
            self.set("Tractions/Names", "push")
            if loaded[0] != list(self.boxes)[0] or self.maybe(0.5):
                self.set("Tractions/push/Body", loaded[0])
            self.set("Tractions/push/Face", r.choice(WALLS[:2 * dim]))
            self.set("Tractions/push/Value", self.functions(0.02 * self.softest, AXES[:dim].upper() + AXES[:dim]))
        if self.maybe(0.15):
            self.effects.append("spring foundation")
            self.set("Spring foundation/Body", r.choice(list(self.boxes)))
            self.set("Spring foundation/Face", r.choice(WALLS[:2 * dim]))
            self.set("Spring foundation/Stiffness", self.softest / self.h * self.log(1e-2, 10))

    def node_sets(self):
        names = [n for n in ("clamp", "driver", "obstacle") if self.maybe(0.12)]
        if self.approximation == "q4 fem":
            names = [n for n in names if n != "obstacle"]
        if not names:
            return
        self.set("Node sets/Names", ", ".join(names))
        for name in names:
            path = f"Node sets/{name}/"
            low, high, _ = self.boxes[self.random.choice(list(self.boxes))]
            corner = [self.among(math.floor(a), math.ceil(b)) for a, b in zip(low, high)]
            if self.maybe(0.9):
                self.set(path + "Shape", self.box([c - 0.6 for c in corner], [c + 0.6 for c in corner]))
            else:
                self.set(path + "Shape", f"{'disc' if self.dim == 2 else 'sphere'}"
                         f"({vector([self.at(d, c) for d, c in enumerate(corner)])}, {number(1.2 * self.h)})")
            if name == "driver":
                self.set(path + "Condition", "prescribed")
                self.set(path + "Velocity", self.functions(0.1 * self.speed))
            if name == "obstacle":
                self.set(path + "Condition", "moving")
                self.set(path + "Path", "; ".join(f"{self.random.uniform(-0.3, 0.3) * self.speed:.4g}*t"
                                                  for _ in range(self.dim)))
            if self.maybe(0.3):
                self.set(path + "Components", ", ".join(self.random.sample(AXES[:self.dim], self.random.randint(1, self.dim))))
            self.moves = self.moves or name != "clamp"

    def contact(self):
        slip = [w for w, c in self.conditions.items() if c == "slip"]
        held = [w for w, c in self.conditions.items() if c in ("slip", "fixed")]
        if self.fluids and slip and self.approximation == "lme mpm" and self.maybe(0.3):
            self.effects.append("wall friction")
            if self.maybe(0.5):
                self.set("Wall friction/Walls", self.random.choice(slip))
            self.set("Wall friction/Coefficient", self.log(1e-2, 1e4))
        if self.solids and held and not self.static and self.approximation != "q4 fem" and self.maybe(0.3):
            self.effects.append("wall release")
            if self.maybe(0.5):
                self.set("Wall release/Walls", ", ".join(self.random.sample(held, self.random.randint(1, len(held)))))
            if self.maybe(0.3):
                self.set("Wall release/Bodies", self.random.choice(list(self.boxes)))

    def own_nodes(self):
        if self.fluids or self.static or self.approximation != "lme mpm" or len(self.solids) < 2 \
                or {"adaptivity", "mixed pressure"} & set(self.effects) or self.maybe(0.3):
            return
        self.effects.append("contact")
        if self.maybe(0.3):
            self.set("Contact/Bodies", self.random.choice(list(self.boxes)))
        if self.maybe(0.3):
            self.set("Contact/Penalty", self.log(1, 1e6))

    def solid_cures(self):
        laws = {self.scene.get(f"Bodies/{n}/Law") for n in self.boxes}
        if "isochoric neo hookean" in laws and self.maybe(0.7):
            self.effects.append("mixed pressure")
        elif self.solids and self.maybe(0.2):
            self.effects.append("mean dilatation")

    def probes(self):
        if self.maybe(0.5):
            return
        r, dim = self.random, self.dim
        names = [f"curve{i}" for i in range(r.randint(1, 3))]
        self.effects.append("probes")
        self.set("Probes/Names", ", ".join(names))
        if self.maybe(0.2):
            self.set("Probes/Interval", self.dt * self.among(0.5, 2, 3))
        for name in names:
            path, body = f"Probes/{name}/", r.choice(list(self.boxes))
            low, high, _ = self.boxes[body]
            middle = vector([self.at(d, (a + b) / 2) for d, (a, b) in enumerate(zip(low, high))])
            kinds = ["point", "region", "wall force", "height", "front", "extent", "error"]
            kinds += [] if self.static else ["body force"]
            kinds += ["wall pressure"] if self.fluids else []
            kinds += ["node"] if self.approximation == "q4 fem" else []
            kind = r.choice(kinds)
            self.set(path + "Kind", kind)
            if kind in ("point", "node", "height", "wall force", "body force"):
                self.set(path + "Position", middle)
            if kind in ("region", "wall pressure"):
                self.set(path + "Shape", self.box(low, high))
            if kind in ("wall force", "wall pressure"):
                self.set(path + "Wall", r.choice(WALLS[:2 * dim]) if kind == "wall force" or not self.touched(low, high)
                         else r.choice(self.touched(low, high)))
            if kind in ("front", "extent", "height", "body force", "error"):
                self.set(path + "Body", body)
            if kind in ("front", "height"):
                self.set(path + "Axis", r.choice(AXES[:dim]))
            if kind == "error":
                self.set(path + "Quantity", "displacement" if self.static else self.among("displacement", "velocity"))
                self.set(path + "Function", self.functions(0.1 * self.h))

    def touched(self, low, high):
        return [w for i, w in enumerate(WALLS[:2 * self.dim])
                if (low[i // 2] <= 0.2 if i % 2 == 0 else high[i // 2] >= self.cells[i // 2] - 0.2)]

    def numerics(self):
        r = self.random
        if self.approximation == "lme mpm":
            if self.maybe(0.6):
                self.set("LME/Gamma", r.uniform(0.8 if self.dim == 2 else 1.8, 4.5))
            if self.maybe(0.1):
                self.set("LME/Support tolerance", self.among(1e-6, 1e-8, 1e-10))
            if self.maybe(0.1):
                self.set("LME/Newton tolerance", self.log(1e-14, 1e-8))
        if self.maybe(0.5):
            self.set("Transfer/Scheme", self.among("flip", "tpic"))
            self.set("Transfer/FLIP fraction", self.among(0, 0.9, 0.98, 1))
            self.set("Transfer/FLIP interval", self.among(0, 1e-4, 1e-2))
            self.set("Transfer/Projection order", self.among(1, 1, 2, 4, 10))
        if self.maybe(0.3):
            self.set("Newton/Tolerance", self.log(1e-10, 1e-4))
        if self.maybe(0.1):
            self.set("Newton/Iterations", self.among(2, 5, 10, 50))
        if self.maybe(0.2):
            self.set("Newton/Line search", self.among("true", "false"))
        if self.maybe(0.3):
            self.set("Linear solver/Solver", self.among("automatic", "cg jacobi", "cg ml", "gmres block", "minres jacobi",
                                                        "direct"))
            self.set("Linear solver/Direct below", self.among(0, 100, 8000))
        if self.maybe(0.1):
            self.set("Linear solver/Tolerance", self.log(1e-12, 1e-4))
            self.set("Linear solver/Iterations", self.among(1, 20, 2000))
        self.set("Output/Interval", self.among(0, 0, self.end, 2.5 * self.dt))
        if self.maybe(0.1):
            self.set("Output/Mesh", "false")
        if self.maybe(0.1):
            self.set("Output/Audit", "none")
        if self.maybe(0.15):
            self.set("Time/Largest energy jump", self.log(1e-3, 1))

    def adaptivity(self):
        if self.approximation != "lme mpm" or self.maybe(0.8):
            return
        r, path = self.random, "Adaptivity/"
        self.effects.append("adaptivity")
        self.set(path + "Steps", self.among(1, 2, 10))
        self.set(path + "Finer levels", self.among(0, 1, 1, 2) if self.dim == 2 else 1)
        if all(n % 2 == 0 for n in self.cells) and self.maybe(0.4):
            self.set(path + "Coarser levels", 1)
        self.set(path + "Most cells", 3000)
        if self.maybe(0.3):
            self.set(path + "Points", self.among("split", "keep"))
        criteria = {"Surface": "true", "Interface": "true", "Bodies": r.choice(list(self.boxes)), "Strain": self.log(1e-4, 1),
                    "Strain variation": self.log(1e-2, 1), "Velocity difference": self.log(1e-2, 1),
                    "Pressure difference": self.log(1e-2, 1), "Velocity error": self.log(1e-3, 1)}
        for name in r.sample(list(criteria), r.randint(1, 3)):
            self.set(path + name, criteria[name])

    # Contradictory or out of range.

    def spoil(self):
        """One thing made wrong; `wrong` says what, if it must be refused."""
        r, values = self.random, self.scene.values
        body = r.choice(list(self.boxes))

        def wrong(path, value):
            self.set(path, value)
            self.scene.wrong = f"{path} = {value}"

        def garbage():
            path = r.choice([p for p in values if not p.endswith("Names") and p != "Effects"])
            self.set(path, self.among("", "nan", "inf", "-1", "0", "1e400", "x", "1, 2, 3, 4", "1;", "(", "\\", "-1e30",
                                      "1e30", "sqrt(-1)", "1/0", "true", "äöü", "0x10", "1e-320", '"'))

        def double_name():
            path = r.choice([p for p in values if p.endswith("Names")])
            wrong(path, values[path] + ", " + values[path].split(", ")[0])

        def forgotten_effect():
            effects = values["Effects"].split(", ")
            effects.remove(r.choice(effects))
            self.set("Effects", ", ".join(effects))

        def forgotten_value():
            del values[r.choice(list(values))]

        def scaled():
            path = r.choice([p for p in values if values[p].replace(".", "").replace("e", "").replace("-", "").isdigit()
                             and "Points" not in p and "Levels" not in p])
            self.set(path, float(values[path]) * self.among(0, -1, 1e-12, 1e-3, 1e3, 1e12))

        r.choice([
            garbage, garbage, garbage, garbage, garbage, double_name, forgotten_effect, forgotten_effect, forgotten_value,
            forgotten_value, forgotten_value, scaled, scaled, scaled, scaled,
            lambda: wrong(f"Bodies/{body}/Law parameters/Density", self.among(-1, 0)),
            lambda: wrong(f"Bodies/{body}/Points per direction", self.among(0, 21, 1.5)),
            lambda: wrong(f"Bodies/{body}/Jitter", self.among(-0.1, 0.51)),
            lambda: wrong(f"Bodies/{body}/Shape", self.box([-1] * self.dim, [1] * self.dim)),
            lambda: wrong(f"Bodies/{body}/Shape", self.among("box(1, 2)", "disc(0, 0)", "cube(0, 0, 1, 1)", "box(0, 0, 1, 1",
                                                             "sphere(0, 0, 0, -1)", "inside(0, 0, 1, 1, x +)")),
            lambda: wrong(f"Bodies/{body}/Law", "honey"),
            lambda: wrong("Effects", values["Effects"] + ", lift"),
            lambda: wrong("Time/Step", self.among(0, -1, "small")),
            lambda: wrong("Time/End time", self.among(0, -1)),
            lambda: wrong("Time/Smallest step", 2 * self.dt),
            lambda: wrong("Time/Largest move", self.among(0, 1)),
            lambda: wrong("Dimension", self.among(1, 4, "two", 5 - self.dim)),
            lambda: wrong("Domain/Cells", vector([*self.cells[1:], 10 * self.cells[0] + 1])),
            lambda: wrong("Domain/Upper corner", vector(self.lower)),
            lambda: wrong("Domain/Wells/left", "slip"),
            lambda: wrong("Inertia/Newmark beta", self.among(0.1, 2)),
            lambda: wrong("LME/Gamma", self.among(0, -1, 50)) if self.approximation == "lme mpm" else garbage(),
            lambda: wrong("Transfer/Scheme", "pic"),
            lambda: wrong("Newton/Iterations", self.among(0, -3)),
            lambda: wrong("Linear solver/Solver", "magic"),
        ])()


def random_scene(seed):
    return Maker(seed).make()
