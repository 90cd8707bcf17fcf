#!/usr/bin/python3
"""The battery of hard cases: each against theory, literature or a converged
reference, never against the program's own earlier output.

    battery.py SELKIE [--quick | --full] [--only NAME] [--markdown FILE] [--json FILE]
    battery.py --list

--quick (the default) leaves out what takes long and all but the first approximation
of each case; --only takes the name of a case, or the beginning of several. Exit code
1 if a figure is beyond its limit and nothing is known about it, or if a known failure
passes (then its mark has to go).

Every run of every case must also end with exit code 0 and keep all points, all
mass (1e-12) and finite figures: `Bench.run`.
"""
import argparse
import contextlib
import dataclasses
import io
import json
import math
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
from typing import Callable

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE.parent / "scenes"
os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
sys.path.insert(0, str(SCENES))
import check  # noqa: E402
import coupled  # noqa: E402
import water  # noqa: E402
from check import BENCHMARKS, COOKBOOKS, table, vtu_array, worst  # noqa: E402

LME, MPM, FEM = "lme mpm", "q4 mpm", "q4 fem"
TIME_LIMIT = {False: 300, True: 1500}  # s; what takes longer hangs


class Broken(Exception):
    """What no run may do."""


class Bench:
    """Runs scenes for one case with one approximation."""

    def __init__(self, selkie, folder, approximation):
        self.selkie, self.folder, self.approximation = selkie, pathlib.Path(folder), approximation
        self.runs = 0

    def run(self, scene, settings=None, ranks=0, picture=False, leaving=False):
        """The statistics of a scene with {parameter: value}; `out` is its folder.

        leaving: points may be removed or kept at walls.
        """
        self.runs += 1
        self.out = self.folder / str(self.runs)
        chosen = {"Approximation": self.approximation, **(settings or {})}
        said = io.StringIO()
        try:
            with contextlib.redirect_stdout(said):
                s = check.run(self.selkie, scene, self.out,
                              [f"{name}={value}" for name, value in chosen.items()],
                              ranks, picture)
        except SystemExit as end:
            lines = said.getvalue().splitlines()
            reason = [line for line in lines[1:] if line and not line.startswith("step ")]
            raise Broken(f"{end.code}: {' '.join(reason[-4:])}") from None
        for name, values in s.items():
            if not all(map(math.isfinite, values)):
                raise Broken(f"'{name}' is not finite")
        if not leaving and worst(s["points"], s["points"][0]) > 0:
            raise Broken(f"{worst(s['points'], s['points'][0]):.0f} points lost")
        if not leaving and worst(s["mass"], s["mass"][0]) > 1e-12 * s["mass"][0]:
            raise Broken(f"mass changes by {worst(s['mass'], s['mass'][0])} kg")
        return s

    def probe(self, name):
        return table(self.out / "probes" / (name + ".csv"))


@dataclasses.dataclass(frozen=True)
class Known:
    """Why a case fails, what is published about it, what is planned."""
    reason: str
    art: str
    plan: str


@dataclasses.dataclass
class Case:
    """`measure(bench)` returns the figures, one for each (what, limit, source)."""
    name: str
    group: str
    measure: Callable
    figures: list
    on: tuple = (LME,)
    safe: str = ""
    known: dict = dataclasses.field(default_factory=dict)  # approximation: Known
    long: bool = False

    def slow(self, approximation):
        return self.long or approximation != self.on[0]

    def named(self, approximation):
        return self.name + ("" if approximation == LME else "." + approximation.replace(" ", "_"))


def energy(s, *kinds):
    """The sum of energies over time."""
    kinds = kinds or [name for name in ("kinetic energy", "strain energy", "compression energy",
                                        "potential energy") if name in s]
    return [sum(values) for values in zip(*(s[name] for name in kinds))]


def gain(values):
    """By how much a curve rises above its start, relative to that."""
    return max(0, max(values) / values[0] - 1)


GROWTH = "nothing feeds energy in: theory"

LOCKING = Known(
    "Q4 elements lock: four Gauss points ask for four constant volumes, a node has two unknowns.",
    "B-bar and F-bar (Hughes 1980, de Souza Neto et al. 1996), mixed pressures.",
    "None: list `mixed pressure` or `mean dilatation`.")
CROSSING = Known(
    "The gradients of hat functions jump at the faces of cells: the force of a stressed point "
    "jumps when it crosses.",
    "GIMP (Bardenhagen & Kober 2004), B-splines (Steffen, Kirby & Berzins 2008), LME.",
    "None: `q4 mpm` is there for comparison; use `lme mpm`.")
FRACTURE = Known(
    "Numerical fracture: with functions as narrow as at gamma 3 (or hats) and 2 x 2 points the "
    "points drift apart by the distance of nodes, forces scatter as in cell crossing, and the bar "
    "tears long before cells are empty.",
    "Wider or anisotropic supports (Kumar, Danas & Kochmann 2019), total Lagrangian MPM "
    "(de Vaucorbeil et al. 2020), splitting of points.",
    "Use gamma 0.8 with 3 x 3, or 1.8 with 4 x 4 points; splitting of points is not planned yet.")
TRANSFER = Known(
    "The lumped projection smooths velocities over h / sqrt(2 gamma): points move with the "
    "smoothed velocity but keep their own, which costs energy and angular momentum where a "
    "wave or a turn has few cells.",
    "TPIC/APIC (Jiang et al. 2015), XPIC and FMPM of higher order (Nairn & Hammerquist 2021).",
    "The default stays order 1, which damps what integration over points scatters when they cross "
    "cells. `Projection order = 4` (10 for strains above 1) with `Mass = consistent` mends it: the "
    "cases named `sharp`.")
SHARPER = "`Projection order` 4 and `Mass = consistent`"
DISTORTION = Known(
    "Strains above 1 pull the points' lattice apart, and what they then integrate wrongly moves energy to "
    "and fro, where the default transfer loses 28 %.",
    "Total Lagrangian MPM (de Vaucorbeil et al. 2020); splitting of points.",
    "TPIC gains less than 0.5 %, but loses 4 %; 3 x 3 points lose 4 %.")
CORRECTION = Known(
    "The volume correction takes the disorder of the points for crowding and moves volume from cell "
    "to cell at a rate s of its own. We think (not isolated by a run) that points and nodes lose such "
    "a short divergence when they exchange velocities, so that every step makes it anew, at a pressure rho h^2 s / dt: the shorter the step, "
    "the higher, until the points have spread (0.5 s). A gentle start of the correction does not help "
    "(0.07 rho g H after ten periods at 5e-4 s, 0.29 at 1e-4 s). Limiting that pressure to 2 % of the "
    "one that is there helps (0.034, still too much), but a violent dam break then loses 6.2 % of its volume (commit "
    "e957954).",
    "Delta-plus-SPH and particle shifting (Lind et al. 2012, Sun et al. 2017) move points instead "
    "of pressing.",
    "`Volume correction = 0` where water stays at rest; shifting of points, which presses nothing.")
STABILISATION = Known(
    "The pressure projection works on the pressure itself and, with the reset of J, moves volume at "
    "alpha g beta dt / 6: seen with steps of tens of sound crossings.",
    "Stabilisation by the residual (Hughes, Franca & Balestra 1986) vanishes at rest.",
    "Keep the acoustic Courant number below 20 where water is to stand still.")
FINER = Known(
    "Functions of fine nodes reach into coarse cells whose points are too few to integrate them.",
    "Subdivided quadrature; truncated hierarchical B-splines (Giannelli et al. 2012).",
    "4 x 4 points at the change of fineness; more Gauss points as for full cells of fluids.")
PER_STEP = Known(
    "`FLIP fraction = 0.98` takes 2 % of PIC in every step, however short: the shorter the steps, the "
    "more is damped.",
    "A share per time, 1 - (1 - a)^(dt / dt0), or damping by XPIC (Hammerquist & Nairn 2017).",
    "`FLIP interval`, the time in which the share is taken, or `Projection order = 4`, with which PIC "
    "takes only what nodes do not see.")

# --- Near-incompressible -------------------------------------------------------


def cook(nu, effect="mixed pressure"):
    """The rise of the tip of Cook's membrane against Q2-P1 elements."""
    reference = {0.3: 14.738, 0.4999: 13.407}[nu]

    def measure(bench):
        settings = {"Bodies/panel/Law parameters/Poisson ratio": nu}
        if bench.approximation == FEM:
            bench.run(BENCHMARKS / "cook_membrane.prm",
                      {**settings, "Domain/Mesh/Global refinements": 4,
                       "Effects": f"traction, probes, {effect}".strip(", ")})
        else:
            bench.run(SCENES / "cook_points.prm",
                      {**settings, "Effects": f"body force, probes, {effect}".strip(", ")})
        return [1e3 * bench.probe("tip")["displacement y"][-1] / reference - 1]
    return measure


COLUMN = BENCHMARKS / "hydrostatic_column.prm"
H, W = water.H, 0.24
FROM_REST = "inertia, gravity, viscosity, probes, hydrostatic start"


def nodal_pressure_error(bench, h, K):
    """{(i, j): error over rho g H} at the nodes inside the water, at the end."""
    last = sorted((bench.out / "solution").glob("mesh_*.vtu"))[-1]
    x, p = vtu_array(last, ""), vtu_array(last, "pressure")
    return {(round(x[3 * i] / h), round(x[3 * i + 1] / h)):
            (p[i] - water.at_rest(H - x[3 * i + 1], K)) / (water.RHO * water.G * H)
            for i in range(len(p)) if x[3 * i + 1] < H - 0.5 * h}


def still(K, jitter, periods=10, cells=10, **more):
    """A column at rest for ten acoustic periods: (checkerboard index, rms of the
    pressure, growth of the kinetic energy)."""
    period = 4 * H / math.sqrt(K / water.RHO)

    def measure(bench):
        h = H / cells
        end = periods * period
        step = min(1e-3, end / 32)
        s = bench.run(COLUMN, {
            "Effects": FROM_REST,
            "Domain/Cells": f"{4 * cells // 10}, {12 * cells // 10}",
            "Bodies/water/Law parameters/Bulk modulus": K, "Bodies/water/Jitter": jitter,
            "Time/Step": step, "Time/End time": end, "Output/Interval": end, **more},
            picture=True)
        error = nodal_pressure_error(bench, h, K)
        board = abs(sum((-1)**(i + j) * e for (i, j), e in error.items())) / len(error)
        rms = math.sqrt(sum(e * e for e in error.values()) / len(error))
        speed = math.sqrt(2 * max(s["kinetic energy"][len(s["time"]) // 2:]) / s["mass"][0])
        return [board, rms, speed / math.sqrt(water.G * H)]
    return measure


# --- Where points are ----------------------------------------------------------

BLOCK, DROP = HERE / "block.prm", HERE / "drop.prm"
SOLID_AND_WATER = (("solid", BLOCK), ("water", DROP))


def flight(dt=0.01, steps=10, share=0.25, v=None, scene=BLOCK, h=1 / 16, dimension=2, **more):
    """A body moves by `share` of a cell in every step and direction: (largest error
    of the momentum, of the place of the centre over h, of J)."""
    def measure(bench):
        speed = share * h / dt
        s = bench.run(scene, {
            "Bodies/block/Initial velocity": "; ".join([repr(speed)] * dimension),
            "Time/Step": dt, "Time/End time": steps * dt, **more})
        mass, errors = s["mass"][0], [0., 0., max(worst(s["min J"], 1), worst(s["max J"], 1))]
        for axis in "xyz"[:dimension]:
            errors[0] = max(errors[0], worst(s["momentum " + axis], mass * speed) / (mass * speed))
            x, t = s["center of mass " + axis], s["time"]
            errors[1] = max(errors[1], *(abs(b - x[0] - speed * (c - t[0])) / h
                                         for b, c in zip(x, t)))
        return errors
    return measure


FLIGHT = [("momentum / (m v) - 1, largest", 1e-10, "exact"),
          ("place of the centre - v t, over h", 1e-10, "exact"),
          ("J - 1, largest", 1e-10, "exact")]


def parabola(scene):
    """Free fall of a single point: (place over g t^2 / 2, momentum over m g t)."""
    def measure(bench):
        s = bench.run(scene, {"Bodies/block/Shape": "box(0.5, 0.5, 0.53, 0.53)",
                              "Effects": "inertia, gravity", "Time/Step": 0.01,
                              "Time/End time": 0.3})
        y, t, g = s["center of mass y"], s["time"], 9.81
        fallen = [y[0] - value for value in y]
        exact = [g * (b * b - t[0]**2) / 2 for b in t]
        return [max(abs(a - b) for a, b in zip(fallen, exact)) / exact[-1],
                max(abs(-p / (s["mass"][0] * g * b) - 1) for p, b in zip(s["momentum y"], t))]
    return measure


def in_corner(scene):
    """Two points in the corner of two slip walls, pressed into it by gravity:
    (distance behind a wall over h, energy gained over m g h)."""
    h = 1 / 16

    def measure(bench):
        s = bench.run(scene, {
            "Bodies/block/Shape": f"box(0, 0, {h!r}, {h / 2!r})",
            "Domain/Walls/left": "slip", "Domain/Walls/bottom": "slip",
            "Effects": "inertia, gravity, probes", "Gravity/Acceleration": "-5, -9.81",
            "Probes/Names": "extent", "Probes/extent/Kind": "extent",
            "Time/Step": 1e-3, "Time/End time": 0.5})
        p = bench.probe("extent")
        lowest = min(min(p["min x"]), min(p["min y"]))
        total = energy(s)
        return [max(0, -lowest) / h,
                max(0, max(total) - total[0]) / (s["mass"][0] * 9.81 * h)]
    return measure


def near_walls(bench):
    """A column of water whose outermost points are put 1e-4 h and 1e-12 h from the walls,
    two of them from the corners (the program keeps them 1e-5 h away): (force on the floor over the weight at the nearer
    ones, its difference over the weight, that of the kinetic energy over rho g H V)."""
    h, forces, energies = H / 10, [], []
    for distance in (1e-4, 1e-12):
        move = (f"X < {0.5 * h!r} ? {distance * h!r} - X : "
                f"(X > {W - 0.5 * h!r} ? {W - distance * h!r} - X : 0); "
                f"Y < {0.5 * h!r} ? {distance * h!r} - Y : 0")
        s = bench.run(COLUMN, {
            "Effects": FROM_REST, "Bodies/water/Law parameters/Bulk modulus": 2e9,
            "Bodies/water/Initial displacement": move, "Time/End time": 0.1})
        weight = s["mass"][0] * water.G
        forces.append(bench.probe("bottom_force")["force y"][-1] / -weight)
        energies.append(s["kinetic energy"][-1] / (weight * H))
    return [forces[1] - 1, forces[1] - forces[0], energies[1] - energies[0]]


def vibrating(points, cells=16):
    """Period, velocity and energy of the bar of check.py with so many points."""
    def measure(bench):
        return list(check.bar(bench.selkie, bench.folder, cells, settings=(
            f"Approximation={bench.approximation}", f"Bodies/bar/Points per direction={points}")))
    return measure


BAR = [("period of the vibrating bar / closed form - 1", 0.01, "linear theory; 1 %: verification.md"),
       ("velocity of its centre, rms error / amplitude", 0.05, "linear theory"),
       ("its energy, drift", 0.02, "practice: 2 %")]

# --- Large motion and strain ---------------------------------------------------


def carried(bench):
    """A free bar vibrates while it is carried across 20 cells: strain energy against
    that of the same bar at rest (Galileo), over its largest."""
    h, v0, dt = 25 / 16, 0.1, 25 / 16 / 10 / 2
    curves = []
    for V in (0., 20 * h / (64 * dt)):
        s = bench.run(BENCHMARKS / "vibrating_bar.prm", {
            "Domain/Lower corner": f"{-2 * h!r}, 0", "Domain/Upper corner": f"{40 * h!r}, {h!r}",
            "Domain/Cells": "42, 1", "Domain/Walls/left": "free",
            "Bodies/bar/Shape": f"box(0, 0, 25, {h!r})",
            "Bodies/bar/Initial velocity": f"{V!r} + {v0}*cos(pi*x/25); 0",
            "Time/Step": dt, "Time/End time": 64 * dt})
        curves.append(s["strain energy"])
    return [max(abs(a - b) for a, b in zip(*curves)) / max(curves[0])]


def turn(bench):
    """All nodes turn by 360 degrees in steps: F = (I + dt A)^n, J = (1 + dt^2)^n."""
    dt, n = 0.05, 126  # of w = 1 /s
    s = bench.run(SCENES / "affine_prescribed.prm", {
        "Bodies/block/Initial velocity": "-y; x", "Node sets/all/Velocity": "-y; x",
        "Bodies/block/Shape": "box(-0.5, -0.5, 0.5, 0.5)", "Time/Step": dt, "Time/End time": n * dt})
    J = [(1 + dt * dt)**(i + 1) for i in range(n)]
    return [n - len(s["time"]),
            max(abs(s[name][i] / J[i] - 1) for name in ("min J", "max J", "volume")
                for i in range(len(s["time"])))]


def spin(**more):
    """A free plate turns once: drift of the angular momentum and of the energy, the
    largest |J - 1|."""
    def measure(bench):
        s = bench.run(SCENES / "spinning_plate.prm", more)
        L, total = s["angular momentum z"], energy(s)
        return [worst([value / L[0] for value in L], 1), gain(total),
                max(worst(s["min J"], 1), worst(s["max J"], 1))]
    return measure


def twist(cells=2, step=1e-3, **more):
    """Bonet's twisting column: (energy lost or gained, volumes turned inside out)."""
    def measure(bench):
        s = bench.run(HERE / "column_3d.prm", {
            "Domain/Cells": f"{3 * cells}, {3 * cells}, {15 * cells // 2}", "Time/Step": step, **more})
        total = energy(s)
        return [worst([value / total[0] for value in total], 1), max(0, -min(s["min J"]))]
    return measure


def stretch(to, **more):
    """A bar of 8 x 2 cells under a dead load at its end, statically, nu = 0:
    P = G (l - 1 / l); (stretch / l - 1, strain energy / closed form - 1)."""
    E = 1e6
    G = E / 2

    def measure(bench):
        P = G * (to - 1 / to)
        s = bench.run(BLOCK, {
            "Effects": "traction, probes", "Domain/Upper corner": f"{to + 0.25!r}, 0.25",
            "Domain/Lower corner": "0, 0", "Domain/Cells": f"{round((to + 0.25) * 16)}, 4",
            "Domain/Walls/left": "slip", "Domain/Walls/bottom": "slip",
            "Bodies/block/Shape": "box(0, 0, 1, 0.125)",
            "Bodies/block/Law parameters/Poisson ratio": 0,
            "Tractions/Names": "pull", "Tractions/pull/Face": "right",
            "Tractions/pull/Value": f"{P!r}*t; 0",
            "Probes/Names": "end", "Probes/end/Kind": "region",
            "Probes/end/Shape": "box(0.96875, 0, 1, 0.125)",
            "Time/Step": 0.02, "Time/End time": 1, **more})
        p = bench.probe("end")
        x = p["position x"][-1] / p["position x"][0]
        W = (G / 2 * (to**2 - 1) - G * math.log(to)) * 0.125
        return [(x - to) / (to - 1), s["strain energy"][-1] / W - 1]
    return measure


def tensile(**more):
    """A disordered block held at a stretch of 1.5 for 40 sound crossings: energy
    after the load has come to stand still."""
    def measure(bench):
        E, G, to = 1e6, 5e5, 1.5
        P, ramp = G * (to - 1 / to), 1.
        s = bench.run(BLOCK, {
            "Effects": "inertia, traction", "Domain/Upper corner": "2, 0.25", "Domain/Cells": "32, 4",
            "Domain/Walls/left": "slip", "Domain/Walls/bottom": "slip",
            "Bodies/block/Shape": "box(0, 0, 1, 0.125)", "Bodies/block/Jitter": 0.3,
            "Bodies/block/Law parameters/Poisson ratio": 0,
            "Tractions/Names": "pull", "Tractions/pull/Face": "right",
            "Tractions/pull/Value": f"{P!r}*(t < {ramp} ? 0.5 - 0.5*cos(pi*t/{ramp}) : 1); 0",
            "Time/Step": 5e-3, "Time/End time": 2 * ramp, **more})
        kinetic = [k for k, t in zip(s["kinetic energy"], s["time"]) if t > ramp]
        return [max(kinetic) / max(s["strain energy"]),
                max(0, max(kinetic[len(kinetic) // 2:]) / max(kinetic[:len(kinetic) // 2]) - 1)]
    return measure


# --- Contact and splashing -----------------------------------------------------


def meeting(scene, bodies, speed, exact, cell, more=None):
    """Two bodies that fly towards each other along x: (momentum over sqrt(2 m E),
    energy gained, contact early by cells of approach, 0 if they fly apart)."""
    def measure(bench):
        # With a consistent mass momentum stays to Newton's tolerance.
        s = bench.run(BENCHMARKS / scene, {"Newton/Tolerance": 1e-10, **(more or {})})
        one, two = map(bench.probe, bodies)
        scale = math.sqrt(2 * s["kinetic energy"][0] * s["mass"][0])
        touch = next(t for t, v in zip(one["time"], one["velocity x"]) if abs(v / speed - 1) > 1e-3)
        return [max(worst(s["momentum " + axis], 0) for axis in "xy") / scale, gain(energy(s)),
                max(0, exact - touch) / cell, not one["velocity x"][-1] < 0 < two["velocity x"][-1]]
    return measure


def discs(more=None):
    """Sulsky's."""
    return meeting("colliding_discs.prm", ("lower", "upper"), 0.1,
                   (0.6 * math.sqrt(2) - 0.4) / (0.2 * math.sqrt(2)), 1 / 20 / 0.2, more)


def stack(bench):
    """Two blocks press on each other for 1000 steps: (overlap over h, energy gained
    over m g h of the upper block)."""
    s = bench.run(HERE / "stack.prm", {"Time/End time": 2})
    lower, upper = bench.probe("lower"), bench.probe("upper")
    overlap = [a - b + 1 / 32 for a, b in zip(lower["max y"], upper["min y"])]  # of points h / 4 inside
    total = energy(s)
    return [max(overlap) * 16, max(0, max(total) - total[0]) / (1000 / 16 * 9.81 / 4)]


def corner_impact(bench):
    """A disc flies along the diagonal into a corner: (farthest behind a wall over h,
    energy gained, difference of the momenta over their start, 0 if it comes back)."""
    s = bench.run(BLOCK, {
        "Effects": "inertia, probes, wall release", "Domain/Walls/left": "slip",
        "Domain/Walls/bottom": "slip", "Bodies/block/Shape": "disc(0.3125, 0.3125, 0.1875)",
        "Bodies/block/Initial velocity": "-1; -1", "Bodies/block/Law parameters/Young modulus": 1e5,
        "Probes/Names": "extent", "Probes/extent/Kind": "extent", "Time/Step": 2e-3,
        "Time/End time": 0.4})
    p, start = bench.probe("extent"), s["mass"][0]
    return [max(0, -min(p["min x"] + p["min y"])) * 16, gain(energy(s)),
            max(abs(a - b) for a, b in zip(s["momentum x"], s["momentum y"])) / start,
            not s["momentum x"][-1] > 0]


def jet(bench):
    """A jet along the floor runs into a corner: (energy gained, compression over
    Joukowsky's v / c, flow that is gone from the floor turns up: p_y > 0)."""
    v, K = 1., 2e6
    s = bench.run(DROP, {"Bodies/block/Shape": "box(0.125, 0, 0.875, 0.1875)",
                         "Bodies/block/Initial velocity": f"{v}; 0", "Time/Step": 2e-3,
                         "Transfer/FLIP fraction": 0.98, "Time/End time": 0.6})
    return [max(0, max(s["energy balance"])) / s["kinetic energy"][0],
            max(0, 1 - min(s["min J"])) / (v / math.sqrt(K / 1000)),
            not max(s["momentum y"]) > 0.2 * s["momentum x"][0]]


def splash(end, **more):
    """A dam break onto the far wall: (energy given by nobody, change of the points'
    volume, points lost)."""
    def measure(bench):
        s = bench.run(BENCHMARKS / "dam_break.prm", {
            "Domain/Cells": "24, 18", "Time/Step": 2e-3, "Time/End time": end, **more}, leaving=True)
        return [max(0, max(s["energy balance"])) / s["potential energy"][0],
                worst([V / s["volume"][0] for V in s["volume"]], 1),
                max(s["points removed"])]
    return measure


def cavity(end):
    """Water runs through a gap of two cells in a plate: (points in the plate, water
    below over that of Torricelli's law, energy given by nobody)."""
    def measure(bench):
        s = bench.run(DROP, {
            "Effects": "inertia, gravity", "Bodies/block/Shape": "box(0, 0.5625, 1, 0.875)",
            "Node sets/Names": "plate",
            "Node sets/plate/Shape": "box(-0.01, 0.43, 0.44, 0.51) + box(0.56, 0.43, 1.01, 0.51)",
            "Transfer/FLIP fraction": 0.98, "Time/Step": 2e-3, "Time/End time": end,
            "Output/Interval": end}, picture=True)
        last = sorted((bench.out / "solution").glob("particles_*.vtu"))[-1]
        x, V = vtu_array(last, ""), vtu_array(last, "reference volume")
        points = list(zip(x[::3], x[1::3], V))
        inside = sum(0.4375 < b < 0.5 and not 0.4375 < a < 0.5625 for a, b, _ in points)
        level, n = 0.375, 1000  # above the gap's lower edge, falling
        out = 0.
        for _ in range(n):
            rate = 0.125 * math.sqrt(2 * 9.81 * max(level, 0))
            out, level = out + rate * end / n, level - rate * end / n
        below = sum(v for _, b, v in points if b < 0.4375)
        return [inside, below / out, max(0, max(s["energy balance"])) / s["potential energy"][0]]
    return measure


# --- Fluid and solid -----------------------------------------------------------


def bounce(solid, water_top, solid_top=None, end=0.3, step=2e-3, cells=20, stiff=False):
    """A column of water and an elastic layer under it (solid_top None) or on it,
    gravity from one moment to the next; errors of interface and surface, over their
    largest displacements, against explicit differences in one dimension."""
    density, E = solid

    def measure(bench):
        h = 1 / cells
        bed = (density, coupled.solid(E, 0.3))
        if solid_top is None:
            layers = [(0.4, *bed), (water_top - 0.4, 1000., coupled.water(2e6))]
            shapes, rows = ("box(0, 0, 0.2, 0.4)", f"box(0, 0.4, 0.2, {water_top})"), (0.4, water_top)
            sides = (1, -1)  # the row of points next to it, above or below
        else:
            layers = [(water_top, 1000., coupled.water(2e6)), (solid_top - water_top, *bed)]
            shapes = (f"box(0, {water_top}, 0.2, {solid_top})", f"box(0, 0, 0.2, {water_top})")
            rows, sides = (water_top, solid_top), (1, -1)
        settings = {
            "Time/Step": step,
            "Domain/Cells": f"{cells // 5}, {cells}", "Bodies/bed/Shape": shapes[0],
            "Bodies/water/Shape": shapes[1], "Bodies/bed/Law parameters/Density": density,
            "Bodies/bed/Law parameters/Young modulus": E, "Time/End time": end}
        if bench.approximation == FEM:
            for name, y in zip(("interface", "surface"), rows):
                settings[f"Probes/{name}/Position"] = f"0.1, {y}"
            settings["Domain/Cells"] = f"{cells // 5}, {round(max(rows) * cells)}"
            settings["Domain/Upper corner"] = f"0.2, {max(rows)}"
        else:
            settings["Domain/Cells"] = f"{cells // 5}, {round(1.2 * cells)}"
            settings["Domain/Upper corner"] = "0.2, 1.2"
            for name, y, side in zip(("interface", "surface"), rows, sides):
                low, high = sorted((y, y + side * h / 2))
                settings[f"Probes/{name}/Kind"] = "region"
                settings[f"Probes/{name}/Shape"] = f"box(0, {low!r}, 0.2, {high!r})"
        bench.run(SCENES / "coupled_bed.prm", settings)
        times, curves = coupled.bounce(layers, 10., end) if not stiff else \
            coupled.bounce(layers[1:], 10., end)
        errors = []
        for name, exact in zip(("interface", "surface")[-len(curves):], curves):
            p = bench.probe(name)
            errors.append(max(abs(u - coupled.interpolate(times, exact, t))
                              for t, u in zip(p["time"], p["displacement y"])) / -min(exact))
        return errors
    return measure


def gate_between(bench):
    """A gate one point thick, clamped at its foot, between two equal columns of water:
    by symmetry it stays straight: (tip sideways over its length, energy gained)."""
    h, n = 1 / 16, 17
    s = bench.run(SCENES / "coupled_bed.prm", {
        "Effects": "inertia, gravity, hydrostatic start, probes",
        "Domain/Upper corner": f"{n * h!r}, 0.75", "Domain/Cells": f"{n}, 12",
        "Bodies/water/Shape": f"box(0, 0, {8 * h!r}, 0.5) + box({9 * h!r}, 0, {17 * h!r}, 0.5)",
        "Bodies/bed/Shape": f"box({8 * h!r}, 0, {9 * h!r}, 0.625)",
        "Bodies/bed/Points per direction": 1, "Node sets/Names": "foot",
        "Node sets/foot/Shape": f"box({7.9 * h!r}, -0.001, {9.1 * h!r}, 0.001)",
        "Probes/surface/Kind": "region", "Probes/surface/Shape": "box(0, 0, 1, 1)",
        "Probes/interface/Kind": "region",
        "Probes/interface/Shape": f"box({8 * h!r}, 0.5625, {9 * h!r}, 0.625)",
        "Time/Step": 2e-3, "Time/End time": 0.25})
    return [max(map(abs, bench.probe("interface")["displacement x"])) / 0.625,
            max(0, max(s["energy balance"])) / s["potential energy"][0]]


def thin_obstacle(bench):
    """A dam breaks on an elastic obstacle that is one cell across: peak of its tip."""
    h = 0.584 / 48
    bench.run(BENCHMARKS / "dam_break_obstacle.prm", {
        "Domain/Cells": "48, 36", "Domain/Upper corner": f"0.584, {36 * h!r}",
        "Node sets/foot/Shape": f"box({0.292 - 0.2 * h!r}, -1e-6, {0.304 + 0.55 * h!r}, 1e-6)",
        "Probes/tip/Shape": f"box(0.292, {0.08 - h!r}, 0.304, 0.08)", "Time/End time": 0.3},
        leaving=True)
    return [1e3 * max(bench.probe("tip")["displacement x"]) - 45]


# --- Time ----------------------------------------------------------------------


def tiny_step(scene, step):
    """20 steps of free fall: momentum over m g t."""
    def measure(bench):
        s = bench.run(scene, {"Effects": "inertia, gravity", "Time/Step": step,
                              "Time/End time": 20 * step})
        return [max(abs(-p / (s["mass"][0] * 9.81 * t) - 1)
                    for p, t in zip(s["momentum y"], s["time"]))]
    return measure


def courant(number, steps):
    """A still column with steps of so many sound crossings of a cell."""
    step = number * (H / 10) / math.sqrt(2e6 / water.RHO)
    return still(2e6, 0., periods=steps * step / (4 * H / math.sqrt(2e6 / water.RHO)),
                 **{"Time/Step": step})


def front(number, **more):
    """The dam break's front at t = 0.2 s with steps of so many sound crossings of a
    cell against that with two crossings and pure FLIP: difference over the way."""
    def measure(bench):
        ends = []
        for n, settings in ((2, {"Transfer/FLIP fraction": 1}), (number, more)):
            bench.run(BENCHMARKS / "dam_break.prm", {
                "Domain/Cells": "24, 18", "Time/Step": n * (0.584 / 24) / math.sqrt(2000),
                "Time/End time": 0.2, **settings})
            x = bench.probe("front")["front x"]
            ends.append((x[0], x[-1]))
        return [(ends[1][1] - ends[0][1]) / (ends[0][1] - ends[0][0])]
    return measure


def rest(steps):
    """A small column of water at rest: (pressure, speed, growth)."""
    return still(2e9, 0., periods=steps * 1e-3 / (4 * H / math.sqrt(2e9 / water.RHO)),
                 **{"Time/Step": 1e-3})


def quiet(steps):
    """A free block with a small disturbance: energy gained."""
    def measure(bench):
        s = bench.run(BLOCK, {
            "Bodies/block/Initial velocity": "1e-3*sin(37*x)*cos(41*y); 1e-3*cos(29*x)*sin(53*y)",
            "Domain/Cells": "8, 8", "Time/Step": 2e-3, "Time/End time": steps * 2e-3})
        return [gain(energy(s))]
    return measure


MASS, SPRING = 1000. * 0.5 * 0.5, 1e6 * 0.5  # of spring_foundation.prm
OMEGA = math.sqrt(SPRING / MASS)


def oscillator(force, exact, periods=5):
    """A stiff block on springs under an acceleration of it: largest error of its
    centre over its largest displacement; `exact` is a function of t."""
    def measure(bench):
        s = bench.run(COOKBOOKS / "spring_foundation.prm", {
            "Effects": "inertia, body force, spring foundation",
            "Body force/Acceleration": f"0; {force}",
            "Time/Step": 2e-3, "Time/End time": periods * 2 * math.pi / OMEGA})
        y = [exact(t) for t in s["time"]]
        found = [value - s["center of mass y"][0] + y[0] for value in s["center of mass y"]]
        return [max(abs(a - b) for a, b in zip(found, y)) / max(map(abs, y))]
    return measure


HALF = 0.5 * OMEGA

# --- Meshes --------------------------------------------------------------------


def breathing(bench):
    """A block swings in itself while it moves by a quarter of a cell and 1e-9 more in
    every step: nodes enter and leave with next to no mass. (Energy gained; energy less
    that of the same block that does not move, over that at the start)."""
    h, dt, curves = 1 / 16, 2e-3, []
    for V in (0, 0.25 * (1 + 1e-9) * h / dt):
        s = bench.run(BLOCK, {
            "Domain/Upper corner": "3, 1", "Domain/Cells": "48, 16",
            "Bodies/block/Initial velocity": f"{V!r} + 2*cos(2*pi*(x - 0.25)); 0",
            "Time/Step": dt, "Time/End time": 100 * dt})
        curves.append([e - 0.5 * s["mass"][0] * V * V for e in energy(s)])
    return [gain(curves[1]), max(abs(a - b) for a, b in zip(*curves)) / curves[0][0]]


SHARP = {"Transfer/Projection order": 4, "Inertia/Mass": "consistent"}


def ringing(**more):
    """A free block swings in itself, a wave of 16 cells, for seven periods: energy
    lost."""
    def measure(bench):
        s = bench.run(BLOCK, {"Bodies/block/Initial velocity": "0.02*cos(2*pi*(x - 0.25)); 0",
                              "Time/Step": 2e-3, "Time/End time": 0.2, **more})
        total = energy(s)
        return [1 - total[-1] / total[0]]
    return measure


GRADED = {"Domain/Cells": "8, 8", "Domain/Refinements/Names": "fine",
          "Domain/Refinements/fine/Shape": "box(0.5, 0.5, 0.55, 0.55)",
          "Domain/Refinements/fine/Levels": 4}


def graded_column(bench):
    """A still column on cells graded 1:16 towards a corner: rms of the pressure."""
    s = bench.run(COLUMN, {
        "Effects": FROM_REST,
        "Bodies/water/Law parameters/Bulk modulus": 2e9, "Domain/Refinements/Names": "corner",
        "Domain/Refinements/corner/Shape": "box(0, 0, 0.005, 0.005)",
        "Domain/Refinements/corner/Levels": 4, "Time/End time": 0.1, "Output/Interval": 0.1},
        picture=True)
    last = sorted((bench.out / "solution").glob("particles_*.vtu"))[-1]
    x, p = vtu_array(last, ""), vtu_array(last, "pressure")
    error = [(b - water.at_rest(H - a, 2e9)) / (water.RHO * water.G * H)
             for a, b in zip(x[1::3], p)]
    return [math.sqrt(sum(e * e for e in error) / len(error)),
            math.sqrt(2 * s["kinetic energy"][-1] / s["mass"][0] / water.G / H)]


def patch(steps, **more):
    """F = I + t A across hanging nodes: the largest error of J and of the volume."""
    def measure(bench):
        s = bench.run(SCENES / "hanging_nodes.prm", {
            "Time/Step": 0.02, "Time/End time": 0.02 * steps, **more})
        J = check.determinant([[(i == j) + s["time"][-1] * check.A[i][j] for j in (0, 1)]
                               for i in (0, 1)])
        error = max(abs(s[name][-1] / J - 1) for name in ("min J", "max J", "volume"))
        return [error, error / (s["time"][-1] * check.A[0][1])]
    return measure


# --- What must not matter ------------------------------------------------------


def mirror(scene, **more):
    """A symmetric scene for 500 steps: momentum across over sqrt(2 m E), way of the
    centre of mass across."""
    def measure(bench):
        s = bench.run(scene, {"Time/Step": 2e-3, "Time/End time": 1., **more})
        scale = math.sqrt(2 * s["mass"][0] * max(s["kinetic energy"]))
        return [worst(s["momentum x"], 0) / scale, worst(s["center of mass x"], 0.5),
                max(0, 500 - len(s["time"]))]
    return measure


TWO_COLUMNS = {"Domain/Cells": "12, 12", "Effects": "inertia, gravity", "Transfer/FLIP fraction": 0.98,
               "Bodies/block/Shape": "box(0, 0, 0.25, 0.5) + box(0.75, 0, 1, 0.5)"}
LANDING = {"Domain/Cells": "8, 8", "Effects": "inertia, gravity", "Domain/Walls/bottom": "slip",
           "Bodies/block/Law parameters/Young modulus": 1e5}


def shifted(bench):
    """A free bar whose ends lie 0, 1/4, 1/2 and 3/4 of a cell beside the nodes: the
    strain energy's largest difference over its largest."""
    h, v0, dt = 25 / 16, 0.1, 25 / 16 / 10 / 2
    curves = []
    for quarter in range(4):
        x0 = (-2 - quarter / 4) * h
        s = bench.run(BENCHMARKS / "vibrating_bar.prm", {
            "Domain/Lower corner": f"{x0!r}, 0", "Domain/Upper corner": f"{x0 + 22 * h!r}, {h!r}",
            "Domain/Cells": "22, 1", "Domain/Walls/left": "free",
            "Bodies/bar/Shape": f"box(0, 0, 25, {h!r})", "Bodies/bar/Points per direction": 4,
            "Bodies/bar/Initial velocity": f"{v0}*cos(pi*x/25); 0",
            "Time/Step": dt, "Time/End time": 64 * dt})
        curves.append(s["strain energy"])
    return [max(max(values) - min(values) for values in zip(*curves)) / max(curves[0])]


def ranks(scene, settings):
    """One, two and three ranks: the largest difference of any column of the
    statistics, as check.ranks measures it."""
    def measure(bench):
        one, *others = [bench.run(scene, settings, ranks=n) for n in (1, 2, 3)]
        by = check.scales(one)
        names = [name for name in one if name != "linear iterations" and "lambda" not in name]
        return [max(max(abs(a - b) for a, b in zip(one[name], other[name])) / by[name]
                    for name in names for other in others),
                max(abs(len(one["time"]) - len(other["time"])) for other in others)]
    return measure


COOK = [("rise of the tip of Cook's membrane / that of Q2-P1 elements - 1", 0.03,
         "tests/references/cook_q2_p1.cc, deal.II's code gallery; 3 %: practice")]

STILL = [("checkerboard index of the nodal pressure / (rho g H)", 0.02, "practice"),
         ("rms of the nodal pressure / (rho g H)", 0.02, "practice"),
         ("speed, rms of the second half, over sqrt(g H)", 0.01,
          "1 %, as the density of weakly compressible water")]
ONE_PERIOD = ("explicit differences, tests/scenes/coupled.py; a period that is wrong by 1 % "
              "(verification.md) is pi % of the amplitude off at its end")

CASES = [
    *(Case(f"cook_nu_{nu}", "Nearly incompressible", cook(nu),
           COOK, on=(LME, MPM, FEM), known={MPM: CROSSING},
           safe="`mixed pressure`; gamma 1.8 and 3 x 3 points where points bend",
           long=nu == 0.3) for nu in (0.3, 0.4999)),
    Case("cook_no_cure", "Nearly incompressible", cook(0.4999, ""),
         COOK, on=(FEM,), known={FEM: LOCKING}),
    *(Case(f"still_{name}_{lattice}", "Nearly incompressible", still(K, jitter),
           STILL, on=(LME, MPM) if jitter else (LME, MPM, FEM), long=K < 1e9 and not jitter,
           known={} if not jitter else
           {MPM: CROSSING} if K < 1e9 else {LME: CORRECTION, MPM: CORRECTION})
      for name, K in (("2e6", 2e6), ("2.2e9", 2.2e9))
      for lattice, jitter in (("regular", 0.), ("jittered", 0.3))),
    *(Case(f"still_2.2e9_no_correction{name}", "Nearly incompressible",
           still(2.2e9, 0.3, cells=cells, **{"Fluid pressure/Volume correction": 0}), STILL,
           safe="water at rest on disordered points: `Volume correction = 0`")
      for name, cells in (("", 10), ("_fine", 20))),

    Case("points_on_faces", "Where points are", flight(), FLIGHT, on=(LME, MPM, FEM)),
    Case("points_on_faces_3d", "Where points are",
         flight(steps=6, h=0.5, dimension=3, scene=HERE / "column_3d.prm",
                **{"Bodies/block/Shape": "box(-0.5, -0.5, 2, 0.5, 0.5, 3)"}), FLIGHT, on=(LME, MPM)),
    Case("points_near_faces", "Where points are", flight(share=0.25 * (1 + 4e-12)), FLIGHT,
         on=(LME, MPM)),
    *(Case("one_point_" + name, "Where points are", parabola(scene),
           [("fallen / (g t^2 / 2) - 1", 1e-10, "exact"), ("momentum / (m g t) - 1", 1e-10, "exact")],
           on=(LME, MPM)) for name, scene in SOLID_AND_WATER),
    *(Case("corner_pair_" + name, "Where points are", in_corner(scene),
           [("farthest behind a wall / h", 1e-9, "practice"),
            ("energy gained / (m g h)", 1e-3, GROWTH)], on=(LME, MPM))
      for name, scene in SOLID_AND_WATER),
    Case("near_walls", "Where points are", near_walls,
         [("force on the floor / weight - 1, points 1e-12 h from the walls", 0.01,
           "statics; 1 %: practice"),
          ("the same - with 1e-4 h", 1e-3, "continuity: ten times 1e-4"),
          ("kinetic energy / (rho g H V) - with 1e-4 h", 1e-3, "continuity: ten times 1e-4")]),
    *(Case(f"bar_{points}_points", "Where points are", vibrating(points), BAR, on=(LME, MPM))
      for points in (1, 6)),
    Case("thin_sheet", "Where points are", flight(share=0.3, **{
        "Bodies/block/Shape": "box(0.125, 0.5, 0.75, 0.5625)",
        "Bodies/block/Points per direction": 1}), FLIGHT, on=(LME, MPM)),
    Case("carried_bar", "Large motion", carried,
         [("strain energy of a bar carried over 20 cells - at rest, over its largest", 0.05,
           "Galileo; stress within 5 %: practice")], on=(LME, MPM, FEM)),
    Case("turn_360", "Large motion", turn,
         [("steps that are missing", 0, "all"), ("J / (1 + dt^2)^n - 1", 1e-10, "exact")],
         on=(LME, MPM)),
    *(Case("spinning_plate" + name, "Large motion", spin(**more),
           [("angular momentum, drift in one turn", 0.02, "conserved; 2 %: practice"),
            ("energy gained", 1e-3, GROWTH),
            ("J - 1, largest", 8e-3, "rho (w R)^2 / E bounds the strain")],
           on=on, known={} if more else {LME: TRANSFER},
           safe=safe)
      for name, more, on, safe in (("_flip", {}, (LME, FEM), ""),
                             ("_tpic", {"Transfer/Scheme": "tpic"}, (LME, MPM),
                                    "`Scheme = tpic` for bodies that turn"),
                                   ("_sharp", SHARP, (LME, MPM), SHARPER))),
    Case("ringing", "Large motion", ringing(),
         [("energy lost in seven periods", 0.02, "conserved; 2 %: practice")], on=(LME, MPM, FEM),
         known={LME: TRANSFER, MPM: TRANSFER}, safe="`q4 fem`; 64 cells a wave lose 1e-3"),
    Case("ringing_sharp", "Large motion", ringing(**SHARP),
         [("energy lost in seven periods", 0.02, "conserved; 2 %: practice")], on=(LME, MPM),
         safe=SHARPER),
    Case("twist", "Large motion", twist(),
         [("energy / start - 1", 0.02, "conserved; 2 %: practice"),
          ("smallest J below 0", 0, "no inversion")], on=(LME, FEM), known={LME: TRANSFER}, long=True,
         safe="`q4 fem`; gamma 0.8 loses 6 % instead of 28 %"),
    Case("twist_sharp", "Large motion", twist(**{**SHARP, "Transfer/Projection order": 10, "LME/Gamma": 1.8}),
         [("energy / start - 1", 0.02, "conserved; 2 %: practice"),
          ("smallest J below 0", 0, "no inversion")], long=True, known={LME: DISTORTION},
         safe="gamma 1.8, `Projection order` 10 and `Mass = consistent`"),
    *(Case(f"stretch_{100 * (to - 1):.0f}{name}", "Large motion", stretch(to, **more),
           [("way of the end / (l - 1) L - 1", 0.02, "P = G (l - 1/l); 2 %: practice"),
            ("strain energy / closed form - 1", 0.05, "closed form; 5 %: practice")],
           on=on, known={} if more else {LME: FRACTURE, MPM: FRACTURE},
           safe="gamma 0.8, for 200 % with 4 x 4 points; gamma 1.8 takes 4 x 4 for 100 %" if more else "")
      for to, name, more, on in (
          (2., "", {}, (LME, MPM, FEM)), (2., "_wide", {"LME/Gamma": 0.8}, (LME,)),
          (3., "_wide", {"LME/Gamma": 0.8, "Bodies/block/Points per direction": 4}, (LME,)))),
    *(Case("tension_disturbed" + name, "Large motion", tensile(**more),
           [("kinetic energy at rest / strain energy", 1e-3,
             "slow load: (period / ramp)^2 of it would be 1e-2"),
            ("kinetic energy, second half / first half - 1", 0.05, GROWTH)], on=on,
           known={} if more else {LME: FRACTURE, MPM: FRACTURE},
           safe="gamma 0.8 with 3 x 3 or 1.8 with 4 x 4 points" if more else "")
      for name, more, on in (("", {}, (LME, MPM)), ("_wide", {
          "LME/Gamma": 0.8, "Bodies/block/Points per direction": 3}, (LME,)))),

    *(Case(name, "Contact", measure,
           [("momentum / sqrt(2 m E)", 1e-10, "conserved"), ("energy gained", 1e-3, GROWTH),
            ("contact early by cells", early, "of the gap between points' edges" if early < 1 else
             "bodies meet through common nodes: two cells"),
            ("0 if they fly apart", 0, "Sulsky, Chen & Schreyer 1994; Gray et al. 2001")], on=on, long=long)
      for name, measure, early, on, long in (
          ("two_discs", discs(), 0.5, (LME,), False),
          ("two_discs_shared_nodes", discs({"Effects": "inertia, probes"}), 2, (LME, MPM), False),
          ("two_rings", meeting("colliding_rings.prm", ("left_ring", "right_ring"), 6.868,
                                1e-3 / 6.868, 2.5e-3 / 13.736), 0.5, (LME,), True))),
    Case("stack", "Contact", stack,
         [("overlap of the blocks / h", 0.1, "a fifth of the distance of points: practice"),
          ("energy gained / (m g h)", 1e-3, GROWTH)]),
    Case("corner_impact", "Contact", corner_impact,
         [("farthest behind a wall / h", 1e-9, "practice"), ("energy gained", 1e-3, GROWTH),
          ("momenta x - y, over start", 1e-9, "mirror symmetry"), ("0 if it comes back", 0, "elastic")],
         on=(LME, MPM), safe="`wall release`: without it a wall holds what touches it"),
    Case("jet_on_corner", "Contact", jet,
         [("energy given by nobody / start", 1e-3, GROWTH),
          ("compression / Joukowsky's v/c", 1, "Joukowsky: the strongest blow"),
          ("0 if it turns up", 0, "momentum")], on=(LME, MPM), known={MPM: CROSSING}),
    *(Case(f"splash_{name}", "Contact", splash(end),
           [("energy given by nobody / start", 1e-3, GROWTH),
            ("volume of the points / start - 1", 0.02, "(v/c)^2 < 1 %: practice"),
            ("points lost", 0, "none")], on=(LME, MPM), long=end > 1,
           safe="Newmark gamma 0.6, `FLIP fraction = 0.98`, `Points leaving = keep`" if end > 1 else "")
      for name, end in (("0.4s", 0.4), ("2s", 2.))),
    Case("narrow_gap", "Contact", cavity(0.4),
         [("points inside the plate", 0, "none"),
          ("water through the gap / Torricelli's", 1, "Torricelli, no contraction: an upper bound"),
          ("energy given by nobody / start", 1e-3, GROWTH)],
         safe="two cells in a gap are stable; its held nodes brake the flow: more cells for its rate"),

    *(Case(f"bed_{name}", "Fluid and solid",
           bounce((density, E), 1., end=end, step=step, stiff=E > 1e8),
           [(f"{what}: error / largest displacement", 0.01 * math.pi, ONE_PERIOD) for what in whats],
           on=(LME, FEM),
           safe="Newmark 1/4, 1/2 and 150 steps a period" if name == "density_0.1" else "")
      for name, density, E, end, step, whats in (
          ("density_1", 1000., 1e5, 0.3, 2e-3, ("interface", "surface")),
          ("density_0.1", 100., 1e5, 0.3, 2e-3, ("interface", "surface")),
          ("stiffness_1e6", 1500., 2e12, 0.054, 3.6e-4, ("surface",)))),
    *(Case(f"block_on_water_{name}", "Fluid and solid",
           bounce((500., 1e7), top, top + 0.2, end=0.06, step=4e-4),
           [(f"{what}: error / largest displacement", 0.01 * math.pi, ONE_PERIOD)
            for what in ("interface", "surface")],
           on=on) for name, top, on in (("on_faces", 0.5, (LME, FEM)), ("off_faces", 0.525, (LME,)))),
    Case("thin_gate", "Fluid and solid", gate_between,
         [("tip sideways / length", 1e-9, "mirror symmetry"),
          ("energy given by nobody / potential energy", 1e-3, GROWTH)], on=(LME, MPM)),

    Case("thin_obstacle", "Fluid and solid", thin_obstacle,
         [("peak of the tip of an obstacle one cell across - 45 mm (mm)", 4,
           "41 to 49 mm: six authors, doc/data/obstacle_tip.csv")], long=True),

    *(Case(f"courant_{number}", "Time", courant(number, steps),
           STILL, on=(LME, FEM), known=known, long=number == 1,
           safe="water at rest: fewer than 20 sound crossings a step" if number == 20 else "")
      for number, steps, known in (
          (0.1, 200, {}), (1, 100, {}), (5, 50, {}), (20, 30, {FEM: STABILISATION}),
          (100, 20, {LME: STABILISATION, FEM: STABILISATION}))),
    *(Case(f"front_courant_{number}{name}", "Time", front(number, **more),
           [("front of a dam break at 0.2 s (`Largest move` cuts the longest steps), "
             "difference / way", 0.05, "two crossings a step; 5 %: practice")], long=True,
           known={LME: PER_STEP} if number == 0.5 and not more else {}, safe=safe)
      for number in (0.5, 5, 20, 100)
      for name, more, safe in (
          ("", {}, ""),
          ("_flip", {"Transfer/FLIP fraction": 1}, "`FLIP fraction = 1` where steps are short"),
          ("_rate", {"Transfer/FLIP interval": 2e-3}, "a `FLIP interval`, that of the usual step"),
          ("_sharp", {"Transfer/Projection order": 4}, "`Projection order` 4"))),
    *(Case(f"tiny_step_{name}", "Time", tiny_step(scene, 1e-9),
           [("momentum / (m g t) - 1", 1e-6, "exact; Newton's tolerance 1e-9")], on=(LME, MPM))
      for name, scene in SOLID_AND_WATER),
    *(Case(f"rest_{name}", "Time", rest(steps),
           STILL, on=(LME, MPM), long=steps > 1000, known={MPM: CROSSING} if steps > 1000 else {})
      for name, steps in (("1e3", 1000), ("1e4", 10000))),
    *(Case(f"quiet_{name}", "Time", quiet(steps),
           [("energy gained", 3e-5, "trapezoidal rule: strain v/c of the linear energy")],
           on=(LME, MPM, FEM), long=steps > 500) for name, steps in (("500", 500), ("1e4", 10000))),
    Case("sudden_load", "Time", oscillator(
        "-9.81", lambda t: -9.81 / OMEGA**2 * (1 - math.cos(OMEGA * t)), 2),
         [("place - closed form, over the largest", 0.02, "one mass on one spring; 2 %")],
         on=(LME, FEM), long=True),
    Case("harmonic_load", "Time", oscillator(
        f"sin({HALF!r}*t)",
        lambda t: (math.sin(HALF * t) - 0.5 * math.sin(OMEGA * t)) / (OMEGA**2 - HALF**2)),
         [("place - closed form, over the largest", 0.1, "one mass on one spring; 10 %: practice")],
         on=(LME,), long=True),
    Case("resonance", "Time", oscillator(
        f"sin({OMEGA!r}*t)",
        lambda t: (math.sin(OMEGA * t) - OMEGA * t * math.cos(OMEGA * t)) / (2 * OMEGA**2)),
         [("place - closed form, over the largest", 0.1, "one mass on one spring; 10 %: practice")],
         on=(LME, FEM), safe="Newmark gamma 0.5 follows a resonance; 0.6 damps it"),

    Case("vanishing_mass", "Meshes", breathing,
         [("energy gained", 1e-3, GROWTH),
          ("energy - at rest, over start", 0.05, "Galileo; stress within 5 %: practice")],
         on=(LME, MPM), known={MPM: CROSSING}),
    Case("graded_flight", "Meshes", flight(dt=0.01, steps=20, h=1 / 128, **GRADED), FLIGHT,
         on=(LME, MPM)),
    Case("graded_column", "Meshes", graded_column,
         [("rms of the pressure / (rho g H)", 0.02, "practice"),
          ("speed, rms / sqrt(g H)", 0.01,
           "1 %, as the density of weakly compressible water")], known={LME: FINER}),
    Case("hanging_nodes", "Meshes", patch(1), [("J / det(I + t A) - 1, largest", 1e-10, "exact"),
                                               ("the same over the strain", 1e-8, "exact")],
         on=(MPM, FEM)),
    *(Case("hanging_nodes_lme" + name, "Meshes", patch(1, **more),
           [("J / det(I + t A) - 1, largest", 0.05 * 0.016, "5 % of the strain"),
            ("the same over the strain", 0.05, "stress within 5 %: practice")],
           known={} if more else {LME: FINER},
           safe="4 x 4 points where the fineness changes" if more else "")
      for name, more in (("", {}), ("_16_points", {"Bodies/block/Points per direction": 4}))),

    Case("mirror_water", "What must not matter", mirror(DROP, **TWO_COLUMNS),
         [("momentum across / sqrt(2 m E)", 1e-9, "mirror symmetry"),
          ("way of the centre across (m)", 1e-9, "mirror symmetry"),
          ("steps that are missing", 0, "all")],
         on=(LME, MPM)),
    Case("mirror_solid", "What must not matter", mirror(BLOCK, **LANDING),
         [("momentum across / sqrt(2 m E)", 1e-9, "mirror symmetry"),
          ("way of the centre across (m)", 1e-9, "mirror symmetry"),
          ("steps that are missing", 0, "all")],
         on=(LME, MPM)),
    Case("shifted_bar", "What must not matter", shifted,
         [("strain energy, difference / largest", 0.05, "translation; stress within 5 %: practice")],
         on=(LME, MPM)),
    Case("ranks_water", "What must not matter",
         ranks(DROP, {**TWO_COLUMNS, "Time/Step": 2e-3, "Time/End time": 0.01}),
         [("largest difference of the statistics", 1e-8, "same equations; solver's tolerance"),
          ("difference of the steps", 0, "same")]),
    Case("ranks_solid", "What must not matter",
         ranks(BLOCK, {"Bodies/block/Initial velocity": "-5*y; 5*x", "Time/End time": 0.005}),
         [("largest difference of the statistics", 1e-8, "same equations; solver's tolerance"),
          ("difference of the steps", 0, "same")], on=(LME, FEM), long=True),
]


class Result:
    """One case with one approximation, done."""

    def __init__(self, case, approximation, selkie):
        self.case, self.approximation = case, approximation
        self.name = case.named(approximation)
        self.known = case.known.get(approximation, "")
        self.broken, self.values = "", []
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with tempfile.TemporaryDirectory(prefix="selkie-hard-") as folder:
            try:
                signal.alarm(TIME_LIMIT[case.long])
                self.values = case.measure(Bench(selkie, folder, approximation))
            except Broken as error:
                self.broken = str(error)
            except TimeoutError:
                self.broken = f"not done after {TIME_LIMIT[case.long]} s"
            finally:
                signal.alarm(0)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.passed = not self.broken and all(
            abs(value) <= limit for value, (_, limit, _) in zip(self.values, case.figures))
        self.verdict = ("passed" if not self.known else "PASSED, known as failing") if self.passed \
            else ("known failure" if self.known else "FAILED")
        self.good = self.passed != bool(self.known)

    def rows(self):
        """(what, limit, source, value, margin) of each figure."""
        values = self.values or [math.nan] * len(self.case.figures)
        for (what, limit, source), value in zip(self.case.figures, values):
            margin = limit / abs(value) if value else math.inf
            yield what, limit, source, value, margin

    def show(self):
        print(f"{self.verdict:14} {self.name} ({self.seconds:.1f} s CPU)"
              + (f": {self.broken}" if self.broken else ""))
        for what, limit, _, value, _ in self.rows():
            print(f"    {what}: {value:.3e} (limit {limit:.1e})", flush=True)


INTRODUCTION = """# Hard cases

Generated by `tests/hard/battery.py SELKIE --full --markdown doc/hard-cases.md`; do not edit.

Simulations with material points are known to explode. These cases are made of what makes them: each is measured against theory, the literature or a converged reference, never against the program's own earlier output. Every run must also end with exit code 0 and keep all points, all mass (to 1e-12) and finite figures. The margin is limit / result; what is below 1 fails. `ctest -L hard` runs them, `-LE long` the quick part (LME-MPM, or the first approximation that applies).

*Practice* is the measure that the literature plots for a failure and what it calls good: pressure at rest within 2 % of rho g H after ten acoustic periods, tip of Cook's membrane within 3 %, energy and angular momentum of large motions within 2 %, stress of a body that is carried through the mesh within 5 %, front of a dam break within 5 % to a Courant number of 5, force on a wall within 1 %, no point behind a wall by more than 1e-9 h, a stretch of 100 % without a gap, resonance within 10 %.

Which time steps, shape functions and numbers of points a dam break and a loaded plate bear: [stability-map.md](stability-map.md).
"""


RECOVERY = """
## What happens to a step that fails

Which test shows it; tests by their names in `ctest -N`, those with a capital letter are parts of `unit`.

| what must happen | test |
| --- | --- |
| Newton that does not converge: taken again with a shorter step, then the end with checkpoint, message and exit code 2 | `failures.numerical.newton` |
| Newton that stagnates stops and says where; slow progress goes on | `Newton.StopsWhereItStagnatesAndSaysWhere`, `Newton.SlowProgressIsNoStagnation` |
| J <= 0 at a point, in any iterate | `failures.numerical.inverted_element`, `Stepper.AnInvertedPointLeavesNoTrace` |
| no shape functions (lambda not found), or a pressure that the law never reaches: on all ranks, though one rank meets it | `Lme/*.OutsideIsRefused`, `Lme/*.TooFewOrFlatNodes`, `failures.numerical.at_start_on_2_ranks` |
| the linear solver breaks down: iterative, direct, then a failure of the step | `LinearSolverMPI.ASingularMatrixIsATypedFailure` |
| a number that is not finite | `Newton.RefusesNumbersThatAreNotFinite`, `Stepper.ALoadThatIsNoNumberLeavesNoTrace` |
| energy from nothing above `Time/Largest energy jump` | `scene.energy_jump`, `failures.numerical.energy_jump` |
| a point leaves the domain | `failures.numerical.leaves_the_domain` |
| a failed step leaves positions and properties of all points as they were, to the bit | `Stepper.AFailedStepLeavesNoTrace`, `Stepper.AStepThatMakesEnergyLeavesNoTrace` |
| a cut halves the step and leaves the time; the step grows again after good ones, within the scene's limits; the log says what ruled | `TimeControl.*` |
| the message names node, body and the terms with the largest residual | `failures.numerical.newton_says_where`, `failures.numerical.ranks_without_unknowns` |
| a start that fails ends with reason, verdict and what to do | `failures.numerical.at_start` |
| a failure while the mesh is adapted ends with its reason, the last checkpoint stands | `SimulationMPI.AFailureWhileAdaptingKeepsTheLastCheckpoint` |
| resumed: the same to the last digit, on one to three ranks and adaptive meshes (but where a scene asks for MUMPS on several ranks and has more than 1000 unknowns: no two such runs are the same); on other ranks to 1e-8 | `resume.same_ranks.*`, `resume.other_ranks.*` |
| a checkpoint leaves no trace in the run that writes it: the same to the last digit with and without, on one to three ranks | `resume.leave_no_trace.*`, `CheckpointMPI.EachRankGetsItsCellsBack` |
| killed at 20 random times, damaged checkpoints, full disc, folder gone | `resume.killed.20`, `resume.damaged`, `failures.write.*` |
| nothing else: no crash, hang, lost point or silent end in random scenes | `hard.fuzz_500` |
"""


def number(value):
    return "-" if math.isnan(value) else f"{value:.3g}"


def ending(broken):
    """How a run failed, without what differs from run to run."""
    return re.split(r" The last good| the residual in units| Try ", broken.split(" Failed ")[-1])[0] \
        .replace("           ", " ").strip(" ;")


def markdown(results, version):
    """doc/hard-cases.md."""
    out = [INTRODUCTION]
    passed = sum(r.passed for r in results)
    out.append(f"{version}: {len(results)} cases, {passed} pass, "
               f"{len(results) - passed} do not and are explained below; "
               f"{sum(r.seconds for r in results):.0f} s CPU.\n")
    for group in dict.fromkeys(case.group for case in CASES):
        out.append(f"## {group}\n\n| case | approximation | what | limit | source | result | margin |\n"
                   "| --- | --- | --- | --- | --- | --- | --- |")
        for r in (r for r in results if r.case.group == group):
            name = f"`{r.case.name}`" if r.passed else f"**`{r.case.name}`**"
            for what, limit, source, value, margin in r.rows():
                shown = "exact" if margin == math.inf else "fails" if math.isnan(margin) else \
                    "> 1000" if margin > 1000 else f"{margin:.2g}"
                out.append(f"| {name} | {r.approximation} | {what} | {number(limit)} | {source} | "
                           f"{number(value)} | {shown} |")
                name = ""
        out.append("")
    out.append("## What cannot pass\n")
    for known in dict.fromkeys(k for case in CASES for k in case.known.values()):
        names = [r for r in results if r.case.known.get(r.approximation) == known and not r.passed]
        if names:
            out.append("**" + ", ".join(f"`{r.name}`" for r in names) + f"**: {known.reason.strip()}\n\n"
                       f"- State of the art: {known.art}\n- Plan: {known.plan}")
            out += [f"- `{r.name}` ends early: {ending(r.broken)}"
                    for r in names if r.broken]
            out.append("")
    out += [f"**`{r.name}`**: not explained. {r.broken}\n" for r in results
            if not r.passed and not r.known]
    out.append("## Which settings make a case safe\n\nThe defaults, where nothing is said.\n\n"
               "| case | settings |\n| --- | --- |")
    for safe in dict.fromkeys(case.safe for case in CASES if case.safe):
        names = ", ".join(f"`{case.name}`" for case in CASES if case.safe == safe)
        out.append(f"| {names} | {safe} |")
    out.append(RECOVERY.rstrip())
    return "\n".join(out) + "\n"


def as_json(results):
    return json.dumps([{
        "case": r.case.name, "approximation": r.approximation, "group": r.case.group,
        "verdict": r.verdict, "broken": r.broken, "cpu (s)": round(r.seconds, 2),
        "known": r.known and r.known.reason, "safe": r.case.safe,
        "figures": [{"what": what, "limit": limit, "source": source,
                     "result": value if math.isfinite(value) else None,
                     "margin": margin if math.isfinite(margin) else None}
                    for what, limit, source, value, margin in r.rows()]} for r in results], indent=1)


def timed_out(*_):
    raise TimeoutError


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("selkie", nargs="?")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--markdown")
    parser.add_argument("--json")
    parser.add_argument("--list", action="store_true")
    asked = parser.parse_args()
    chosen = [(case, approximation) for case in CASES for approximation in case.on
              if case.named(approximation).startswith(asked.only)]
    exact = [one for one in chosen if one[0].named(one[1]) == asked.only]
    chosen = exact or chosen
    if asked.list:
        for case, approximation in chosen:
            print(case.named(approximation) + (" long" if case.slow(approximation) else ""))
        return 0
    if not asked.selkie or not chosen:
        parser.error("no program" if not asked.selkie else f"no case '{asked.only}'")
    if not asked.full and not asked.only:
        chosen = [one for one in chosen if not one[0].slow(one[1])]
    signal.signal(signal.SIGALRM, timed_out)
    results = []
    for case, approximation in chosen:
        results.append(Result(case, approximation, asked.selkie))
        results[-1].show()
    if asked.markdown:
        version = subprocess.run([asked.selkie, "--version"], stdout=subprocess.PIPE,
                                 text=True).stdout.split("\n")[0]
        pathlib.Path(asked.markdown).write_text(markdown(results, version))
    if asked.json:
        pathlib.Path(asked.json).write_text(as_json(results))
    bad = [result.name for result in results if not result.good]
    print(f"{len(results)} cases, {sum(r.passed for r in results)} passed, "
          f"{sum(not r.passed and r.good for r in results)} known failures, "
          f"{sum(r.seconds for r in results):.0f} s CPU"
          + (f"; NOT GOOD: {', '.join(bad)}" if bad else ""))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
