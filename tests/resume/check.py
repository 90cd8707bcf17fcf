#!/usr/bin/python3
"""Runs that are interrupted and resumed, against the same runs left alone.

    check.py CASE SELKIE [ARGUMENT]

CASE is a function of this file. Exit code 1 if anything differs.
"""
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = ROOT / "prm" / "benchmarks"
SCENES = {  # file, what makes it small; each carries something else along
    "dam_break": (BENCHMARKS / "dam_break.prm",  # pressure, Gauss points, volume correction
                  ["Time/End time=0.04", "Output/Interval=0.01"]),
    "adaptive": (BENCHMARKS / "dam_break.prm",  # another mesh, points with new ids
                 ["Time/End time=0.04", "Output/Interval=0.01",
                  "Effects=inertia, gravity, viscosity, probes, adaptivity",
                  "Adaptivity/Surface=true", "Adaptivity/Steps=7",
                  "Adaptivity/Coarser levels=1", "Adaptivity/Buffer=1"]),
    "uneven": (BENCHMARKS / "dam_break.prm",  # several ranks whose points run away
               ["Time/End time=0.24", "Output/Interval=0.06", "Domain/Cells=16, 12",
                "Time/Step=4e-3", "Domain/Balance steps=5"]),
    "cantilever": (BENCHMARKS / "cantilever.prm",  # F, lambda, tip probe
                   ["Time/End time=0.3", "Output/Interval=0.05"]),
    "elements": (BENCHMARKS / "cantilever.prm",  # nodes' fields and points of another mesh
                 ["Time/End time=0.3", "Output/Interval=0.05", "Approximation=q4 fem",
                  "Effects=inertia, gravity, probes, adaptivity", "Adaptivity/Steps=3",
                  "Adaptivity/Finer levels=2", "Adaptivity/Coarser levels=1",
                  "Adaptivity/Strain error=0.02"]),
    "mixed": (ROOT / "tests" / "scenes" / "mixed_beside.prm",  # pressures of two phases
              ["Time/End time=0.24", "Output/Interval=0.1"]),
    "membrane": (BENCHMARKS / "cook_membrane.prm", []),  # nodes of finite elements, static
    "falling_mesh": (ROOT / "tests" / "failures" / "imported_mesh.prm",  # a mesh from a file beside the scene's
                     ["Effects=inertia, gravity", "Output/Interval=0.05", "Domain/Mesh/Global refinements=2"]),
    "release": (ROOT / "tests" / "scenes" / "wall_release.prm", []),  # nodes let go by walls
    "contact": (ROOT / "tests" / "scenes" / "wall_release.prm",  # the same, two nodes a vertex
                ["Effects=inertia, wall release, contact", "Bodies/Names=block, stone",
                 "Bodies/stone/Law=neo hookean", "Bodies/stone/Shape=box(0.3, 0.4, 0.5, 0.6)",
                 "Bodies/block/Shape=box(0.3, 0, 0.6, 0.3)", "Domain/Cells=6, 6",
                 "Domain/Balance steps=7"]),
}


def selkie(program, *arguments, ranks=1, kill_after=None):
    """Exit code (negative: killed) and what was said."""
    command = [program, *map(str, arguments)]
    if ranks > 1:
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(ranks), *command]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          start_new_session=True) as process:
        try:
            said, _ = process.communicate(timeout=kill_after)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # mpirun and its ranks
            said, _ = process.communicate()
    return process.returncode, said


def without_times(summary):
    """What summary.json says of the run, not of the machine."""
    return {key: value for key, value in json.loads(summary.read_text()).items()
            if not any(word in key for word in ("time (s)", "timings", "by effect", "file"))
            or key == "final time (s)"}


def run(program, scene, folder, *settings, **options):
    file, small = SCENES[scene]
    arguments = [x for setting in (*small, *settings) for x in ("--set", setting)]
    return selkie(program, file, "--output", folder, *arguments, **options)


def expect(condition, what):
    print("  ok   " if condition else "  FAIL ", what)
    if not condition:
        sys.exit(1)


def tables(folder):
    return {p.relative_to(folder): p.read_text()
            for p in [folder / "statistics.csv", *sorted((folder / "probes").glob("*.csv"))]}


def largest_difference(a, b):
    """Of two tables, relative to the largest value of a column."""
    worst = 0.
    (names, *a), (other_names, *b) = csv.reader(a.splitlines()), csv.reader(b.splitlines())
    expect(names == other_names and len(a) == len(b), f"the same {len(a)} rows and {len(names)} columns")
    for i, name in enumerate(names):
        if "iterations" in name or "imbalance" in name:
            continue
        column = [(float(r[i]), float(s[i])) for r, s in zip(a, b)]
        scale = max((abs(x) for pair in column for x in pair if x == x), default=0.) or 1.
        worst = max([worst, *(abs(x - y) / scale for x, y in column if x == x or y == y)])
    return worst


def pictures(folder):
    """Times and files in particles.pvd."""
    text = (folder / "particles.pvd").read_text()
    return [line.strip() for line in text.splitlines() if "DataSet" in line]


def expect_same(whole, resumed):
    for name, text in tables(whole).items():
        expect(tables(resumed)[name] == text, f"{name}: the same to the last digit")
    expect(without_times(whole / "summary.json") == without_times(resumed / "summary.json"),
           "summary.json: the same but for times")
    expect(pictures(whole) == pictures(resumed), f"particles.pvd: the same {len(pictures(whole))} pictures")


def same_ranks(program, folder, scene="dam_break", ranks="1"):
    """A run that ends early and goes on gives the same as one that does not."""
    half = "Output/Checkpoint steps=5"
    ranks = int(ranks)
    expect(run(program, scene, folder / "whole", half, ranks=ranks)[0] == 0, "the whole run")
    end = float(tables(folder / "whole")[Path("statistics.csv")].splitlines()[-1].split(",")[1])
    # The first half is the whole run, killed and its later checkpoints taken away.
    shutil.copytree(folder / "whole", folder / "half")
    steps = sorted(p.name for p in (folder / "whole/checkpoint").iterdir() if p.is_dir())
    expect(len(steps) == 2, "the last two checkpoints are kept")
    (folder / "half/checkpoint/last_good").write_text(steps[0])
    shutil.rmtree(folder / "half/checkpoint" / steps[1])
    code, said = selkie(program, "resume", folder / "half", ranks=ranks)
    expect(code == 0, f"resumed from step {int(steps[0])} to t = {end:g} s")
    expect_same(folder / "whole", folder / "half")
    last = Path("checkpoint") / steps[1]
    for file in sorted(p.name for p in (folder / "whole" / last).iterdir()):
        if file not in ("run", "checkpoint.json"):  # these tell the time
            expect((folder / "whole" / last / file).read_bytes() == (folder / "half" / last / file).read_bytes(),
                   f"{last / file}: the same to the last byte")
    expect((folder / "half/log.txt").read_text().count("Resumed") == 1, "log.txt goes on")
    code, said = selkie(program, "resume", folder / "half", ranks=ranks)
    expect(code == 0 and "Nothing is left to do" in said, "a run at its end says so")


def leave_no_trace(program, folder, scene="dam_break", ranks="2"):
    """A run with checkpoints gives the same as one without: whenever the clock asks for one."""
    ranks = int(ranks)
    for name, steps in (("with", 3), ("without", 0)):
        code, said = run(program, scene, folder / name, f"Output/Checkpoint steps={steps}", ranks=ranks)
        expect(code == 0, f"the run {name} checkpoints")
    expect_same(folder / "without", folder / "with")


def other_ranks(program, folder, scene="dam_break"):
    """From one rank to two and three: to 1e-8."""
    settings = ("Output/Checkpoint steps=5", "Linear solver/Loosest tolerance=1e-10",
                "Linear solver/Tolerance=1e-10", "Newton/Tolerance=1e-11")
    expect(run(program, scene, folder / "whole", *settings)[0] == 0, "the whole run on one rank")
    steps = sorted(p.name for p in (folder / "whole/checkpoint").iterdir() if p.is_dir())
    for ranks in (2, 3):
        half = folder / f"half{ranks}"
        shutil.copytree(folder / "whole", half)
        (half / "checkpoint/last_good").write_text(steps[0])
        code, said = selkie(program, "resume", half, ranks=ranks)
        expect(code == 0, f"resumed on {ranks} ranks")
        for name, text in tables(folder / "whole").items():
            difference = largest_difference(text, tables(half)[name])
            expect(difference < 1e-8, f"{name}: differs by {difference:.1e}")


def killed(program, folder, times="4", scene="dam_break", ranks="1"):
    """SIGKILL at random times, in and out of a checkpoint (one after every step)."""
    every, ranks = "Output/Checkpoint steps=1", int(ranks)
    begin = time.time()
    expect(run(program, scene, folder / "whole", every, ranks=ranks)[0] == 0, "the whole run")
    span = time.time() - begin
    seed = int(os.environ.get("SEED", random.randrange(10**6)))
    print(f"       SEED={seed}")
    rng = random.Random(seed)
    resumed = folder / "resumed"
    code, kills = run(program, scene, resumed, every, ranks=ranks, kill_after=rng.uniform(0.4, 0.6) * span)[0], 1
    while not (resumed / "checkpoint/last_good").exists():
        code = run(program, scene, resumed, every, ranks=ranks, kill_after=rng.uniform(0.5, 0.8) * span)[0]
    while kills < int(times):
        code, said = selkie(program, "resume", resumed, ranks=ranks, kill_after=rng.uniform(0.25, 0.5) * span)
        expect(code in (0, -signal.SIGKILL), f"killed or done, not failed ({code})")
        kills += 1
        if code == 0:  # done: begin again
            shutil.rmtree(resumed)
            run(program, scene, resumed, every, ranks=ranks, kill_after=rng.uniform(0.6, 0.8) * span)
            if not (resumed / "checkpoint/last_good").exists():
                run(program, scene, resumed, every, ranks=ranks)
    code, said = selkie(program, "resume", resumed, ranks=ranks)
    expect(code == 0, f"after {kills} kills it comes to its end")
    expect_same(folder / "whole", resumed)


def damaged(program, folder):
    """Truncated files, nothing there, changed scenes: a message, and the earlier data intact."""
    expect(run(program, "dam_break", folder / "run", "Output/Checkpoint steps=5")[0] == 0, "the whole run")
    checkpoints = folder / "run/checkpoint"
    steps = sorted(p.name for p in checkpoints.iterdir() if p.is_dir())
    statistics = tables(folder / "run")
    victim = max((checkpoints / steps[1]).iterdir(), key=lambda p: p.stat().st_size)
    os.truncate(victim, victim.stat().st_size // 2)
    code, said = selkie(program, "resume", folder / "run")
    expect(code == 0 and "damaged" in said and victim.name in said, "a truncated checkpoint is passed over by name")
    expect(tables(folder / "run") == statistics, "and the one before serves")
    for step in sorted(p.name for p in checkpoints.iterdir() if p.is_dir()):
        (checkpoints / step / "run").unlink()
    code, said = selkie(program, "resume", folder / "run")
    expect(code == 1 and "is missing" in said, "no usable checkpoint is an error that says why")
    expect(tables(folder / "run") == statistics, "which leaves the data as they were")
    code, said = selkie(program, "resume", folder / "run", "--set", "Bodies/water/Shape=box(0, 0, 1, 1)")
    expect(code == 1 and "Bodies/water/Shape" in said and "allowed are" in said, "another scene is refused by name")
    code, said = selkie(program, "resume", folder)
    expect(code == 1 and "parameters.prm" in said, "a folder without a run is refused")


if __name__ == "__main__":
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                      OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    with tempfile.TemporaryDirectory() as temporary:
        globals()[sys.argv[1]](sys.argv[2], Path(temporary), *sys.argv[3:])
