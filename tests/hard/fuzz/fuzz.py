#!/usr/bin/python3
"""Runs random small scenes: none may crash, hang, lose matter or end without a word.

    fuzz.py SELKIE [--count N] [--seed S] [--keep DIR] [--shrink]

Scene i has the seed S + i, which alone decides what it is (random_scene.py);
--count 1 repeats one. Every run must end within 60 s with one of

    0   done: end time reached, points and mass accounted for, all figures finite
    1   refused: one line that names the file and the parameter, nothing written
    2   failed: the reason on the screen and in summary.json, a checkpoint unless
        it was at the start

Prints a tally and, for each violation, the command that repeats it; exit code 1 if
there is one. --keep keeps the folders of all scenes; --shrink takes away from a
violating scene whatever does not matter and prints what is left.
"""
import argparse
import collections
import csv
import json
import math
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from random_scene import random_scene  # noqa: E402

TIME_LIMIT = 60  # s
MEMORY = 6 << 30  # bytes of address space, a process
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


def command_of(scene, selkie):
    launch = [os.environ.get("SELKIE_MPIEXEC", "mpirun"), "--oversubscribe", "--bind-to", "none", "-np",
              str(scene.ranks)] if scene.ranks > 1 else []
    return [*launch, str(selkie), "scene.prm", "--output", "out"]


def execute(scene, selkie, folder):
    """(exit code, None if it hangs; standard output; standard error)"""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "scene.prm").write_text(scene.text())
    process = subprocess.Popen(command_of(scene, selkie), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, errors="replace", env={**os.environ, **ENVIRONMENT}, start_new_session=True,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)))
    try:
        out, err = process.communicate(timeout=TIME_LIMIT)
        return process.returncode, out, err
    except subprocess.TimeoutExpired:
        process.terminate()  # mpirun ends its ranks
        try:
            out, err = process.communicate(timeout=5)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            out, err = process.communicate()
        return None, out, err


def table(path):
    with open(path, newline="") as file:
        head, *rows = list(csv.reader(file))
    if any(len(row) != len(head) for row in rows):
        raise ValueError("a row is cut off")
    return {name.split(" (")[0]: [float(row[i]) for row in rows] for i, name in enumerate(head)}


def gone(out):
    """Whether points were removed."""
    try:
        return json.loads((out / "summary.json").read_text())["material points"]["removed"] > 0
    except (OSError, ValueError):
        return False


def figures(out):
    """What is wrong with statistics.csv and probes/*.csv. Not a number, there, are the
    height of nobody, the volume ratio of no point and the force on a wall before the
    first step: not known."""
    for file in [out / "statistics.csv", *sorted((out / "probes").glob("*.csv"))]:
        try:
            columns = table(file)
        except (OSError, ValueError) as error:
            yield f"figures: {file.name}: {error}"
            continue
        for name, values in columns.items():
            known = values[1:] if name.startswith(("force", "moment")) else [] if name.startswith("height") else values
            if file.parent.name == "probes" and gone(out):  # nowhere is a mean of points that were removed
                while known and math.isnan(known[-1]):
                    known = known[:-1]
            if name in ("min J", "max J"):
                known = [value for value, points in zip(values, columns["points"]) if points]
            if not all(map(math.isfinite, known)):
                yield f"not finite: '{name}' in {file.name}"
    try:
        statistics, summary = table(out / "statistics.csv"), json.loads((out / "summary.json").read_text())
    except (OSError, ValueError) as error:
        yield f"figures: {error}"
        return
    points = summary["material points"]
    removed = statistics.get("points removed", [0] * len(statistics["points"]))
    # An adaptive mesh splits points and merges them.
    gained = [s - m for s, m in zip(statistics.get("points split", [0] * len(removed)),
                                    statistics.get("points merged", [0] * len(removed)))]
    if any(n + r - g != points["seeded"] for n, r, g in zip(statistics["points"], removed, gained)):
        yield f"points: {statistics['points']}, removed {removed} and gained {gained} of {points['seeded']}"
    for mass, r in zip(statistics.get("mass", []), removed):
        lost = points["removed mass"] if r == removed[-1] else 0 if r == 0 else points["seeded mass"] - mass
        if not abs(mass + lost - points["seeded mass"]) <= 1e-10 * points["seeded mass"]:
            yield f"mass: {mass} kg and {lost} kg removed of {points['seeded mass']} kg"
            break


def done(scene, folder):
    if scene.wrong:
        yield f"accepted: {scene.wrong}"
    yield from figures(folder / "out")
    if (folder / "out" / "summary.json").exists():
        summary = json.loads((folder / "out" / "summary.json").read_text())
        end = float(scene.get("Time/End time", "1"))
        if summary["verdict"] != "done" or abs(summary["final time (s)"] - end) > 1e-9 * end:
            yield f"verdict: '{summary['verdict']}' at {summary['final time (s)']} s of {end} s"


def refused(folder, out, lines):
    if len(lines) != 1 or not lines[0].startswith("selkie: error: "):
        yield f"message: {len(lines)} lines: {' | '.join(lines)[:300]}"
    elif not re.search(r"scene\.prm.*\b[A-Z]\w+", lines[0]):
        yield f"message: names no parameter of the file: {lines[0]}"
    if out.strip() or (folder / "out").exists():
        yield f"late refusal: {lines[0][:200] if lines else ''}"


def failed(folder, out, lines):
    if not (folder / "out" / "summary.json").exists():
        yield f"no summary: {' | '.join(lines)[:300]}"
        return
    failure = json.loads((folder / "out" / "summary.json").read_text())["failure"]
    if not failure or "".join(failure.split()) not in "".join((out + "".join(lines)).split()):
        yield f"message: the screen does not say '{failure}'"
    if "Failed    at the start:" in (folder / "out" / "log.txt").read_text():
        return
    if not any((folder / "out" / "checkpoint").glob("*/*")):
        yield f"no checkpoint: {' | '.join(lines)[:300]}"
    if (folder / "out" / "statistics.csv").stat().st_size > 0:  # of a step, at least
        yield from figures(folder / "out")


def judge(scene, selkie, folder):
    """(kind of end, violations as "kind: what")"""
    code, out, err = execute(scene, selkie, folder)
    (folder / "stdout").write_text(out)
    (folder / "stderr").write_text(err)
    text = re.sub(r"^-----+\n.*?^-----+\n", "", err, flags=re.M | re.S)  # mpirun adds notes
    lines = [line for line in text.splitlines() if line.strip()]
    if code is None:
        return "hang", [f"hang: {(out.splitlines() or [''])[-1][:200]}"]
    if code == 0:
        return "0 done", [*done(scene, folder)]
    if code == 1:
        return "1 refused", [*refused(folder, out, lines)]
    if code == 2:
        return "2 failed", [*failed(folder, out, lines)]
    number = -code if code < 0 else code - 128  # of the signal; mpirun's way
    name = signal.Signals(number).name if number in set(signal.Signals) else f"exit code {code}"
    return name, [f"crash: {name} after {len(re.findall('^.*step ', out, re.M))} steps: {' | '.join(lines[-3:])[:300]}"]


def kinds(violations):
    return {v.split(":")[0] for v in violations}


def shrink(scene, selkie, folder, kind):
    """The scene without what the violation of this kind does not need."""
    def still(smaller):
        return kind in kinds(judge(smaller, selkie, folder)[1])

    again = True
    while again:
        again, i = False, 0
        while i < len(smaller := list(scene.smaller())):
            if still(smaller[i]):
                scene, again = smaller[i], True
            else:
                i += 1
    still(scene)
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("selkie", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--shrink", action="store_true")
    options = parser.parse_args()
    selkie, tally, bad = options.selkie.resolve(), collections.Counter(), 0
    with tempfile.TemporaryDirectory() as temporary:
        for seed in range(options.seed, options.seed + options.count):
            folder = (options.keep or pathlib.Path(temporary)).resolve() / str(seed)
            scene = random_scene(seed)
            end, violations = judge(scene, selkie, folder)
            tally[end] += 1
            bad += bool(violations)
            if violations:
                print(f"VIOLATION of scene {seed} ({scene.ranks} ranks), {end}: " + "\n    ".join(violations),
                      f"    {shlex.join([sys.argv[0], str(options.selkie), '--count', '1', '--seed', str(seed)])}"
                      " --keep DIR", sep="\n", flush=True)
                for kind in sorted(kinds(violations)) if options.shrink else []:
                    smallest = shrink(scene, selkie, folder.with_name(f"{seed}_{kind.replace(' ', '_')}"), kind)
                    print(f"    smallest with this violation ('{kind}', {smallest.ranks} ranks):",
                          *["    | " + line for line in smallest.text().splitlines()], sep="\n", flush=True)
            if not options.keep:
                shutil.rmtree(folder, ignore_errors=True)
    print(f"{options.count} scenes: " + ", ".join(f"{n} {end}" for end, n in sorted(tally.items()))
          + f"; {bad} with violations")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
