#!/usr/bin/python3
"""A small study: interrupted in the middle and run again it gives the same table,
also when timings contradict each other until the end.

    check.py SELKIE
"""
import csv
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent


def study(selkie, folder, kill_at=None):
    """Runs the study, or kills it when KILL_AT is there."""
    process = subprocess.Popen([selkie, "study", str(HERE / "small.prm"), "--output", str(folder)],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    while kill_at and not (folder / kill_at).exists():
        time.sleep(0.01)
        if process.poll() is not None:
            sys.exit("the study ended before it could be killed")
    if kill_at:
        process.send_signal(signal.SIGKILL)
    text = process.communicate()[0]
    return process.returncode, text


def rows(folder):
    with open(folder / "study.csv", newline="") as file:
        return list(csv.DictReader(file))


def contradict(result_file):
    """A time that no run of the member can repeat."""
    result = json.loads(result_file.read_text())
    result["cpu"] = 1e-4
    result_file.write_text(json.dumps(result))


def expect(what, condition):
    print(("ok     " if condition else "FAILED ") + what)
    expect.failed |= not condition


expect.failed = False


def main():
    selkie = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="selkie-study-") as name:
        folder = pathlib.Path(name) / "study"
        study(selkie, folder, kill_at="fem-01.json")
        # The files that a member's run left; its time may be taken again.
        before = {path: path.read_text() for path in folder.glob("*/timing.csv")}
        code, text = study(selkie, folder)
        print(text)
        expect("exit code 0", code == 0)
        expect("what had been run was not run again",
               len(before) >= 3 and all(path.read_text() == text for path, text in before.items()))
        table = rows(folder)
        expect("five members", len(table) == 5)
        failed = [row for row in table if row["failure"]]
        expect("one of them failed, with its reason",
               [row["series"] for row in failed] == ["hopeless"] and "exit code 2" in failed[0]["failure"])
        expect("the others have errors and times",
               all(0 < float(row["error"]) < 0.1 and float(row["cpu (s)"]) > 0
                   and float(row["memory (MB)"]) > 0 for row in table if not row["failure"]))
        contradict(folder / "lme-02_again_1.json")
        code, text = study(selkie, folder)
        expect("timings that contradict are taken again", code == 0 and "(again" in text)
        table = rows(folder)
        code, text = study(selkie, folder)
        expect("but not for ever: another run changes nothing", code == 0 and "(again" not in text and rows(folder) == table)
        for file in ("study.json", "cheapest.prm"):
            expect(f"{file} is there", (folder / file).exists())
        plot = folder / "error_against_time.svg"
        expect("the plot is there, or what it needs is said",
               plot.exists() or "python3-matplotlib" in text)
    sys.exit(expect.failed)


main()
