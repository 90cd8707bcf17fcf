#!/usr/bin/python3
"""What each effect costs, counted: instructions, bytes, non-zeros, messages.

    count.py SELKIE SELKIE_BARE MESSAGES_LIBRARY [--markdown]

Instructions a step come from valgrind's callgrind on one rank, messages and
collectives from the preloaded library on two; each is the difference of a run
with 8 steps and one with 4, so that set-up and output do not count. The
programs must be built without instructions that valgrind does not know
(SELKIE_NATIVE=OFF). Exit code 1 unless the bare scene costs the same, to 0.5 %,
in the program without the other effects' sources, with the same digits.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SHORT, LONG = 4, 8
BARE, FLUID = HERE / "bare.prm", HERE / "fluid.prm"

# Name, scene, settings; a row is compared with the first one of its group.
PROBE = ("Probes/Names=tip", "Probes/tip/Kind=point", "Probes/tip/Position=0.5, 0.5")
POST = "box(0.2, 0.2, 0.3, 0.8)"
STANDING = ("Bodies/block/Shape=box(0.25, 0, 0.75, 0.5)",)
TWO = ("Bodies/Names=block, second", "Bodies/second/Law=neo hookean",
       "Bodies/second/Shape=box(0.25, 0.75, 0.75, 1)")
ADAPTED = ("Effects=inertia, adaptivity", "Adaptivity/Surface=true", "Adaptivity/Finer levels=0",
           "Adaptivity/Coarser levels=1", "Adaptivity/Buffer=1")
ISOCHORIC = ("Bodies/block/Law=isochoric neo hookean",)
GROUPS = [
    [
        ("bare solid", BARE, ()),
        ("no audit", BARE, ("Output/Audit=none",)),
        ("empty domain doubled", BARE, ("Domain/Upper corner=2, 1", "Domain/Cells=32, 16")),
        ("gravity", BARE, ("Effects=inertia, gravity",)),
        ("body force", BARE, ("Effects=inertia, body force",
                              "Body force/Acceleration=sin(X); t")),
        ("mean dilatation", BARE, ("Effects=inertia, mean dilatation",)),
        ("traction", BARE, ("Effects=inertia, traction", "Tractions/Names=pull",
                            "Tractions/pull/Face=right", "Tractions/pull/Value=1e3; 0")),
        ("spring foundation", BARE, ("Effects=inertia, spring foundation",
                                     "Spring foundation/Face=left")),
        ("rigid obstacles", BARE, ("Node sets/Names=post", f"Node sets/post/Shape={POST}")),
        ("prescribed motion", BARE, ("Effects=inertia, prescribed motion",
                                     "Node sets/Names=grip", f"Node sets/grip/Shape={POST}",
                                     "Node sets/grip/Condition=prescribed",
                                     "Node sets/grip/Velocity=0.1; 0")),
        ("probes", BARE, ("Effects=inertia, probes", *PROBE)),
        ("adaptivity, a look every other step", BARE, (*ADAPTED, "Adaptivity/Steps=2")),
    ],
    [
        ("two blocks that stick", BARE, TWO),
        ("contact", BARE, (*TWO, "Effects=inertia, contact", "Contact/Bodies=block, second")),
    ],
    [
        ("block at a free wall", BARE, STANDING),
        ("wall contact", BARE, (*STANDING, "Domain/Walls/bottom=slip")),
        ("wall contact and release", BARE, (*STANDING, "Domain/Walls/bottom=slip",
                                            "Effects=inertia, wall release")),
    ],
    [
        ("isochoric solid, MINRES", BARE, (*ISOCHORIC, "Linear solver/Solver=minres jacobi")),
        ("mixed pressure, MINRES", BARE, (*ISOCHORIC, "Linear solver/Solver=minres jacobi",
                                          "Effects=inertia, mixed pressure")),
    ],
    [
        ("bare fluid", FLUID, ()),
        ("gravity (fluid)", FLUID, ("Effects=inertia, gravity",)),
        ("viscosity", FLUID, ("Effects=inertia, viscosity",)),
        ("wall friction", FLUID, ("Effects=inertia, wall friction",
                                  "Wall friction/Walls=bottom",
                                  "Wall friction/Coefficient=1")),
        ("wall release (fluid)", FLUID, ("Effects=inertia, wall release",
                                         "Wall release/Bodies=water")),
        ("hydrostatic start", FLUID, ("Effects=inertia, gravity, hydrostatic start",)),
    ],
]
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
               "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def run(before, program, scene, settings, steps, folder, **environment):
    command = [*before, program, str(scene), "--output", str(folder),
               "--set", f"Time/End time={steps * 1e-3}"]
    for setting in settings:
        command += ["--set", setting]
    result = subprocess.run(command, capture_output=True, text=True,
                            env={**ENVIRONMENT, **environment})
    if result.returncode != 0:
        sys.exit(" ".join(command) + "\n" + result.stdout + result.stderr)
    return result.stderr


def instructions(program, scene, settings, folder):
    """A step's, and the statistics as text."""
    counts = []
    for steps in (SHORT, LONG):
        out = run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"],
                  program, scene, settings, steps, folder)
        counts.append(int(re.search(r"Collected\s*:\s*(\d+)", out).group(1)))
    return ((counts[1] - counts[0]) / (LONG - SHORT),
            (folder / "statistics.csv").read_text())


def messages(program, library, scene, settings, folder):
    """Messages, bytes and collective calls of a step on two ranks, the mean."""
    totals = []
    for steps in (SHORT, LONG):
        path = str(folder) + ".messages"
        run(["mpirun", "--oversubscribe", "--bind-to", "none", "-np", "2",
             "-x", "LD_PRELOAD=" + library, "-x", "SELKIE_MESSAGES=" + path],
            program, scene, settings, steps, folder)
        ranks = [[float(word) for word in open(f"{path}.{rank}").readline().split()]
                 for rank in (0, 1)]
        totals.append([sum(column) / 2 for column in zip(*ranks)])
    return [(b - a) / (LONG - SHORT) for a, b in zip(*totals)]


def main():
    selkie, bare, library = sys.argv[1:4]
    rows, failed = [], False
    with tempfile.TemporaryDirectory(prefix="selkie-effects-") as top:
        folder = pathlib.Path(top) / "run"
        for group in GROUPS:
            first = None
            for name, scene, settings in group:
                count, digits = instructions(selkie, scene, settings, folder)
                summary = json.loads((folder / "summary.json").read_text())
                first = first or count
                rows.append((name, count, count / first - 1,
                             summary["bytes per point"], summary["matrix nonzeros"],
                             *messages(selkie, library, scene, settings, folder)))
                if name == "bare solid":
                    failed = not same_without_sources(bare, scene, folder, count, digits)
    print("\n| scene | million instructions a step | against its group's first | "
          "bytes a point | non-zeros | messages a step | kB a step | collectives |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, count, more, size, nonzeros, sent, sent_size, collective in rows:
        print(f"| {name} | {count / 1e6:.2f} | {more:+.1%} | {size:.0f} | {nonzeros:.0f} "
              f"| {sent:.1f} | {sent_size / 1e3:.1f} | {collective:.1f} |")
    sys.exit(failed)


def same_without_sources(bare, scene, folder, count, digits):
    """Whether the bare scene costs and gives the same in the bare program."""
    alone, alone_digits = instructions(bare, scene, (), folder)
    print(f"bare solid: {count:.0f} instructions a step, "
          f"{alone:.0f} without the other effects' sources "
          f"({count / alone - 1:+.3%}, bound 0.5 %); digits "
          + ("equal" if digits == alone_digits else "DIFFER"))
    return abs(count / alone - 1) <= 5e-3 and digits == alone_digits


if __name__ == "__main__":
    main()
