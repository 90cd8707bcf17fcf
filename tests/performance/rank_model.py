#!/usr/bin/python3
"""What a step costs on many ranks: counts on 1 to 8, and a model made of them.

    rank_model.py SELKIE MESSAGES_LIBRARY [--bounds] [--ranks 1,2,4,8]
                  [--latency S] [--bandwidth B/S] [--reduction S]
                  [--factor S] [--substitution S]
    rank_model.py --coarse

Runs two short scenes on 1, 2, 4 and 8 ranks (oversubscribed: nothing is timed)
with the preloaded library that counts messages, and prints, as Markdown, the
counts, the constants of the model and what it predicts for 10 to 10 000 ranks.
--bounds: only the counts of two ranks against their bounds, which ctest checks;
exit code 1 when one of these passes its bound. --help says what the constants of
the machine are and where they come from; doc/performance.md, section "Ranks",
has the answer and what the model does not know.
"""
import argparse
import csv
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).resolve().parents[2] / "prm/benchmarks"
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
               "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
TIGHT, LOOSE = "1e-8", "1e-3"


class Scene:
    """A scene to count in. The plain solver exchanges the halo of a product
    once an iteration and nothing else: it shows the halo and the neighbours."""

    def __init__(self, name, file, points, step, solvers, values, seconds, coarse, *settings):
        self.name, self.file, self.points, self.step = name, file, points, step
        self.solver, self.plain_solver = solvers
        self.values = values  # unknowns of a node
        self.seconds = seconds  # CPU a point and Newton iteration: doc/performance.md
        self.coarse = coarse  # how many matrices have a V-cycle
        self.settings = settings


CANTILEVER = Scene("cantilever", "cantilever.prm", 16384, 0.01, ("cg hats", "cg jacobi"), 2,
                   6.5e-6, 1,
                   "Domain/Cells=160, 112", "Probes/tip/Shape=box(3.96875, 0, 4, 1)")
DAM = Scene("dam break on obstacle", "dam_break_obstacle.prm", 4910, 0.001,
            ("gmres block", "minres jacobi"), 3, 11e-6, 2)
BEAM = Scene("cantilever", "cantilever.prm", 1024, 0.01, ("cg hats", "cg jacobi"), 2, 6.5e-6, 1)
# Layers of nodes around a rank's own that its rows couple with: a row reaches a
# cell R away and that cell's points reach R further, 2 floor(R/h) + 1 with
# R = 2.6 h (gamma 2.06) and 2.1 h (gamma 3).
LAYERS = 5
POINTS_A_CELL = 4
# ML: unknowns of the coarsest matrix at most (it is collected on fewer ranks, see
# Multigrid); nodes of an aggregate; on a level two sweeps down and up, two
# residuals and the way to the next level, each an exchange with eight neighbours.
COARSEST, AGGREGATE, EXCHANGES = 500, 9, 7 * 8
# Of a step on two ranks (BEAM): messages, bytes, collectives. Without a matrix a
# product sends forces back as well, but its values reach less far: before, with
# 175 messages and 640 kB, the bounds were 220 and 800 kB.
BOUNDS = (260, 3.5e5, 420)


class Counts:
    """Of a run: those of each rank, and the iterations."""

    def __init__(self, arguments, scene, ranks, steps, solver, tolerance):
        with tempfile.TemporaryDirectory(prefix="selkie-ranks-") as top:
            settings = [*scene.settings, f"Linear solver/Solver={solver}",
                        f"Linear solver/Loosest tolerance={tolerance}",
                        f"Linear solver/Tolerance={TIGHT}",
                        f"Time/End time={steps * scene.step}",
                        f"Output/Interval={steps * scene.step}"]
            command = ["mpirun", "--oversubscribe", "--bind-to", "none",
                       "--mca", "mpi_yield_when_idle", "1", "-np", str(ranks),
                       "-x", "LD_PRELOAD=" + arguments.library,
                       "-x", "SELKIE_MESSAGES=" + top + "/messages",
                       arguments.selkie, str(SCENES / scene.file), "--output", top + "/run"]
            for setting in settings:
                command += ["--set", setting]
            result = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True)
            if result.returncode != 0:
                sys.exit(" ".join(command) + "\n" + result.stdout + result.stderr)
            self.ranks = [self.read(f"{top}/messages.{rank}") for rank in range(ranks)]
            pieces = sorted(pathlib.Path(top, "run/solution").glob("particles_0000*.vtu"))
            self.points = [int(re.search(rb'NumberOfPoints="(\d+)"', piece.read_bytes())[1])
                           for piece in pieces]
            with open(top + "/run/statistics.csv") as file:
                rows = list(csv.DictReader(file))
        self.steps = len(rows)
        self.newton = sum(int(row["newton iterations"]) for row in rows)
        self.krylov = sum(int(row["linear iterations"]) for row in rows)
        self.unknowns = int(rows[-1]["unknowns"])

    @staticmethod
    def read(path):
        """Messages, bytes, collectives, growing collectives, their bytes; and
        the messages to each rank."""
        with open(path) as file:
            lines = [[float(word) for word in line.split()] for line in file]
        return lines[0] + lines[1], lines[2]


def each(more, less, n):
    """What one of n steps or iterations adds: totals, and partners, by rank."""
    return [([(b - a) / n for a, b in zip(first[0], last[0])],
             sum(b > a for a, b in zip(first[1], last[1])))
            for first, last in zip(less.ranks, more.ranks)]


class Measured:
    """A scene on some ranks: of the rank that has most of each, a step's
    numbers, and those of an iteration of the linear solver."""

    def __init__(self, arguments, scene, ranks):
        def run(steps, solver, tolerance):
            return Counts(arguments, scene, ranks, steps, solver, tolerance)
        plain = [run(1, scene.plain_solver, tolerance) for tolerance in (LOOSE, TIGHT)]
        loose, tight, longer = (run(2, scene.solver, LOOSE), run(2, scene.solver, TIGHT),
                                run(4, scene.solver, LOOSE))
        self.ranks = ranks
        self.points = max(loose.points)
        self.imbalance = max(loose.points) * ranks / sum(loose.points)
        self.nodes = loose.unknowns / scene.values / ranks
        halo = each(plain[1], plain[0], plain[1].krylov - plain[0].krylov)
        self.partners = max(partners for _, partners in halo)
        self.halo = max(totals[1] for totals, _ in halo) / 8 / scene.values
        self.iteration = self.largest(each(tight, loose, tight.krylov - loose.krylov))
        n = longer.steps - loose.steps
        self.newton = (longer.newton - loose.newton) / n
        self.krylov = (longer.krylov - loose.krylov) / n
        step = self.largest(each(longer, loose, n))
        self.whole_step = step
        # without the iterations of its solves
        self.step = [a - self.krylov * b for a, b in zip(step, self.iteration)]

    @staticmethod
    def largest(by_rank):
        return [max(totals[k] for totals, _ in by_rank) for k in range(5)]


def show_measured(scene, measured):
    print(f"\n{scene.name}, {scene.points} points; of the rank that has most of each:\n")
    print("| ranks | points | imbalance | nodes (mean) | halo nodes | neighbours | Newton, "
          "linear iterations a step | messages a step | kB a step | collectives a step "
          "| of an iteration: messages | kB | collectives |")
    print("| --- " * 13 + "|")
    for m in measured:
        messages, size, collectives = m.whole_step[:3]
        print(f"| {m.ranks} | {m.points} | {m.imbalance:.2f} | {m.nodes:.0f} | {m.halo:.0f} "
              f"| {m.partners} | {m.newton:.1f}, {m.krylov:.1f} | {messages:.0f} "
              f"| {size / 1e3:.0f} | {collectives:.0f} | {m.iteration[0]:.0f} "
              f"| {m.iteration[1] / 1e3:.1f} | {m.iteration[2]:.1f} |", flush=True)


class Model:
    """Of one rank inside a square of ranks, from the counts on the most ranks."""

    def __init__(self, scene, measured):
        self.scene, self.krylov, self.newton = scene, measured.krylov, measured.newton
        self.imbalance, self.counted_on = measured.imbalance, measured.ranks
        self.messages = [counts[0] / measured.partners
                         for counts in (measured.step, measured.iteration)]
        self.bytes = [counts[1] / measured.halo for counts in (measured.step, measured.iteration)]
        self.collectives = [counts[2] for counts in (measured.step, measured.iteration)]
        self.gathers, self.gathered = measured.step[3:5]

    def of_step(self, a_step_and_an_iteration):
        step, iteration = a_step_and_an_iteration
        return step + self.krylov * iteration

    @staticmethod
    def halo(points):
        side = math.sqrt(points / POINTS_A_CELL)
        return 4 * LAYERS * (side + LAYERS)

    @staticmethod
    def partners(points, ranks):
        rings = math.ceil(LAYERS / math.sqrt(points / POINTS_A_CELL))
        return min(ranks - 1, (2 * rings + 1) ** 2 - 1)

    def seconds(self, points, ranks, machine):
        """Parts of a step's time."""
        depth = math.log2(ranks)
        messages = self.of_step(self.messages) * self.partners(points, ranks)
        size = self.of_step(self.bytes) * self.halo(points)
        collectives = self.of_step(self.collectives)
        n = COARSEST
        more_levels = max(0., math.log(ranks / self.counted_on) / math.log(AGGREGATE))
        exchange = (8 * n / machine.bandwidth + machine.reduction * depth
                    + more_levels * EXCHANGES * machine.latency)
        coarse = self.scene.coarse * (
            machine.factor * n ** 1.5
            + self.krylov * (machine.substitution * n * math.log2(n) + exchange))
        return {"points": self.imbalance * points * self.newton * self.scene.seconds,
                "messages": messages * machine.latency + size / machine.bandwidth,
                "reductions": collectives * machine.reduction * depth
                              + self.gathered * ranks / machine.bandwidth,
                "coarse": coarse}, messages, size, collectives


def show_constants(models):
    print("\n| constant | " + " | ".join(model.scene.name for model in models) + " |")
    print("| --- " * (len(models) + 1) + "|")
    rows = (("messages to each neighbour, a step and an iteration", "messages", 0),
            ("bytes for each halo node, a step and an iteration", "bytes", 0),
            ("collectives, a step and an iteration", "collectives", 0))
    for name, member, digits in rows:
        print(f"| {name} | " + " | ".join(
            f"{step:.{digits}f} + {iteration:.{digits}f}"
            for step, iteration in (getattr(model, member) for model in models)) + " |")
    print("| of them with an answer that grows with the ranks: a step, bytes of a rank | "
          + " | ".join(f"{model.gathers:.0f}, {model.gathered:.0f}" for model in models) + " |")


def show_prediction(model, title, points_of, machine):
    print(f"\n{model.scene.name}, {title}:\n")
    print("| ranks | points a rank | nodes | halo nodes | neighbours | messages a step | kB a step "
          "| collectives | ms: points | messages | reductions | coarse grid | all | efficiency |")
    print("| --- " * 14 + "|")
    for ranks in (10, 100, 1000, 10000):
        points = points_of(ranks)
        parts, messages, size, collectives = model.seconds(points, ranks, machine)
        total = sum(parts.values())
        alone = points * model.newton * model.scene.seconds  # on as many ranks, perfectly
        print(f"| {ranks} | {points:.0f} | {points / POINTS_A_CELL:.0f} "
              f"| {model.halo(points):.0f} | {model.partners(points, ranks)} | {messages:.0f} "
              f"| {size / 1e3:.0f} | {collectives:.0f} | "
              + " | ".join(f"{1e3 * part:.3g}" for part in parts.values())
              + f" | {1e3 * total:.3g} | {alone / total:.0%} |")


def measure_coarse():
    """Seconds of LU for the matrix of ML's coarsest grid, a square of nodes with
    3 unknowns and 9 neighbours: SuperLU stands for KLU."""
    import time
    import numpy
    from scipy.sparse import diags, eye, kron
    from scipy.sparse.linalg import splu
    print("| unknowns | factor (s) | /n^1.5 | substitution (s) | /(n log2 n) |\n" + "| --- " * 5 + "|")
    for side in (18, 32, 56, 100):
        line = diags([1, 1, 1], [-1, 0, 1], (side, side))
        neighbours = 9.1 * eye(side * side) - kron(line, line)
        matrix = kron(neighbours, numpy.ones((3, 3)) + 3 * numpy.eye(3))
        n = matrix.shape[0]
        start = time.process_time()
        factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3,
                       options={"SymmetricMode": True})
        middle = time.process_time()
        for _ in range(20):
            factors.solve(numpy.ones(n))
        factor, solve = middle - start, (time.process_time() - middle) / 20
        print(f"| {n} | {factor:.4f} | {factor / n ** 1.5:.2g} | {solve:.5f} "
              f"| {solve / n / math.log2(n):.2g} |")


def check_bounds(arguments):
    """Whether a step on two ranks stays below the bounds."""
    short, long = (Counts(arguments, BEAM, 2, steps, BEAM.solver, LOOSE) for steps in (2, 4))
    counts = Measured.largest(each(long, short, long.steps - short.steps))
    print("| of a step on two ranks, cantilever, 1024 points | measured | bound |\n"
          "| --- | --- | --- |")
    for name, count, bound in zip(("messages", "bytes", "collectives"), counts, BOUNDS):
        print(f"| {name} | {count:.0f} | ≤ {bound:.0f} |")
    return all(count <= bound for count, bound in zip(counts, BOUNDS))


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("selkie", type=os.path.abspath, nargs="?")
    add("library", type=os.path.abspath, nargs="?")
    add("--bounds", action="store_true", help="only the counts that ctest checks")
    add("--coarse", action="store_true",
        help="only time LU of a coarse grid on this machine (needs scipy)")
    add("--ranks", default="1,2,4,8", help="ranks to count on; the model is made of the last")
    add("--latency", type=float, default=2e-6,
        help="s a message, with the processor's part. Assumed: InfiniBand has 1 to 1.5")
    add("--bandwidth", type=float, default=4e8,
        help="B/s a rank. Assumed: a link of 25 GB/s for 64 ranks")
    add("--reduction", type=float, default=2e-6,
        help="s for each of log2(ranks) stages of a collective. Assumed: the latency")
    add("--factor", type=float, default=1.2e-7,
        help="s of LU of a coarse grid, for n^1.5. Measured: --coarse")
    add("--substitution", type=float, default=2e-8,
        help="s of a substitution with it, for n log2 n. Measured: --coarse")
    return parser.parse_args()


def main():
    arguments = read_arguments()
    if arguments.coarse:
        return measure_coarse()
    if arguments.bounds:
        sys.exit(not check_bounds(arguments))
    models = []
    for scene in (CANTILEVER, DAM):
        measured = [Measured(arguments, scene, int(n)) for n in arguments.ranks.split(",")]
        show_measured(scene, measured)
        models.append(Model(scene, measured[-1]))
    show_constants(models)
    for model in models:
        show_prediction(model, "10 000 points a rank", lambda _: 1e4, arguments)
        show_prediction(model, "1 000 000 points", lambda ranks: 1e6 / ranks, arguments)


if __name__ == "__main__":
    main()
