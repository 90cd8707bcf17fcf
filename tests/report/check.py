#!/usr/bin/python3
"""Makes the report of a small run, of two runs and of a study, and looks at the pages.

    check.py SELKIE_OR_SCRIPT [RUN_FOLDER [STUDY_FOLDER]]

With the program, a small scene and a small study are run first and the pages
are made by `selkie report`; with scripts/report the folders must be given.
Headless Chromium, if it is there, opens the page at laptop and phone width.
"""
import html.parser
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SCRIPT = ROOT / "scripts" / "report"
VOID = {"area", "base", "br", "col", "hr", "img", "input", "link", "meta", "source", "wbr"}


def expect(what, condition, more=""):
    print(("ok     " if condition else "FAILED ") + what + (f": {more}" if more and not condition else ""))
    expect.failed |= not condition


expect.failed = False


class Page(html.parser.HTMLParser):
    """Counts the elements of a page and finds tags that are not balanced."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.count, self.sources, self.ids, self.unnamed = [], [], {}, [], [], 0
        self.feed(text)
        self.wrong += [f"<{tag}> is not closed" for tag in self.open]

    def handle_starttag(self, tag, attributes, closed=False):
        self.count[tag] = self.count.get(tag, 0) + 1
        named = dict(attributes)
        self.sources += [v or "" for k, v in attributes if k in ("src", "href", "xlink:href")]
        self.ids += [named["id"]] if "id" in named else []
        self.unnamed += tag == "img" and not named.get("alt") or tag == "svg" and not named.get("aria-label")
        if tag not in VOID and not closed:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes, closed=True)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"</{tag}> at line {self.getpos()[0]}")


def check_page(name, path, words, plots, rows):
    """What every page must fulfil."""
    expect(f"{name}: the page is there", path.exists())
    if not path.exists():
        return
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    expect(f"{name}: its tags are balanced", not page.wrong, page.wrong[:5])
    for word in words:
        expect(f"{name}: it says '{word}'", word in text)
    expect(f"{name}: at least {plots} plots", page.count.get("svg", 0) >= plots, page.count.get("svg", 0))
    expect(f"{name}: at least {rows} rows of tables", page.count.get("tr", 0) >= rows, page.count.get("tr", 0))
    expect(f"{name}: it needs nothing from outside",
           all(s.startswith(("#", "data:")) for s in page.sources) and not re.search(r"@import|url\((?!['\"]?#)", text),
           [s[:60] for s in page.sources if not s.startswith(("#", "data:"))])
    expect(f"{name}: no id twice", len(page.ids) == len(set(page.ids)))
    expect(f"{name}: all pictures have a text", page.unnamed == 0)
    expect(f"{name}: no script", "script" not in page.count)
    check_in_browser(name, path, text)


def check_in_browser(name, path, text):
    """No error in the console and nothing wider than the window."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if not browser:
        print(f"skipped {name}: Chromium is not installed (Debian: apt-get install chromium)")
        return
    with tempfile.TemporaryDirectory(prefix="selkie-chromium-", ignore_cleanup_errors=True) as folder:
        for width in (1280, 390):
            inner, outer = (pathlib.Path(folder) / f"{kind}.html" for kind in ("inner", "outer"))
            inner.write_text(text.replace("</body>", "<script>addEventListener('load', () => parent.postMessage("
                             "[document.documentElement.scrollWidth, innerWidth, document.querySelectorAll('svg')"
                             ".length, [...document.images].every(i => i.naturalWidth > 0)].join(' '), '*'))"
                             "</script></body>"), encoding="utf-8")
            outer.write_text("<!DOCTYPE html><title>-</title><script>addEventListener('message', e => "
                             "document.body.append('FOUND ' + e.data + ' END'))</script><body><iframe "
                             f"src='inner.html' style='width:{width}px;height:900px;border:0'></iframe>")
            result = subprocess.run([browser, "--headless=new", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr",
                                     "--hide-scrollbars", f"--user-data-dir={folder}/profile", "--window-size=1400,1000",
                                     "--virtual-time-budget=5000", "--dump-dom", outer.as_uri()],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
            found = re.search(r"FOUND (\d+) (\d+) (\d+) (\w+) END", result.stdout)
            expect(f"{name}: Chromium renders it at {width} px", bool(found), result.stderr[-500:])
            if found:
                expect(f"{name}: nothing is wider than {width} px", int(found[1]) <= int(found[2]) == width, found[0])
                expect(f"{name}: all pictures are decoded", found[4] == "true")
            console = [line for line in result.stderr.splitlines() if "CONSOLE" in line]
            expect(f"{name}: the console is empty at {width} px", not console, console[:3])


def run(*command):
    """Exit code and text of a command."""
    result = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return result.returncode, result.stdout


def make_folders(selkie, folder):
    """A run, another with a longer step, one that fails, one of a strict audit, and a study."""
    scene = ROOT / "prm" / "benchmarks" / "dam_break.prm"
    coarse = ["--set", "Domain/Cells=16, 12", "--set", "Time/End time=0.05", "--set", "Output/Interval=0.01"]
    other = ["--set", "Time/Step=2e-3"]
    hopeless = ["--set", "Newton/Iterations=1", "--set", "Newton/Tolerance=1e-14", "--set", "Time/Smallest step=5e-4"]
    strict = ["--set", "Audit/Checkerboard=1e-6, 1e-5", "--set", "Audit/Smallest J=0.99999, 0.1"]
    for name, more, wanted in (("run", [], 0), ("<other> & run", other, 0), ("hopeless", hopeless, 2),
                               ("strict", strict, 0)):
        code, text = run(selkie, scene, "--output", folder / name, *coarse, *more)
        expect(f"the run '{name}' ends with exit code {wanted}", code == wanted, text[-1500:])
    code, text = run(selkie, "study", ROOT / "tests" / "study" / "small.prm", "--output", folder / "study")
    expect("the study is done", code == 0, text[-1500:])


def check_verdict(report, folder, output):
    """The page says what the program's own verdict in summary.json says, figure by figure."""
    page = output / "strict.html"
    code, text = run(*report, folder, "--output", page)
    expect("verdict: exit code 0", code == 0, text)
    audit, text = json.loads((folder / "summary.json").read_text())["audit"], page.read_text()
    expect("verdict: the run with strict limits has all three grades",
           {f["grade"] for f in audit["figures"]} == {"pass", "warn", "fail"} and audit["grade"] == "fail", audit)
    expect("verdict: that of the run stands on top", re.search(r'<p class="verdict bad">.*Audit: <[^>]*>fail<', text))
    for f in audit["figures"]:
        row = re.search(rf'<th scope="row">{f["figure"]}</th>(.*?)</tr>', text)
        cells = re.sub("<[^>]*>", " ", row[1]) if row else ""
        expect(f"verdict: the page has '{f['figure']}' and its grade", f["grade"] in cells.split(), cells)
        when = f.get("failed at (s)", f.get("warned at (s)"))
        expect("verdict: and since when", when is None or f"{when:.4g}" in cells, cells)


def check_run(report, folder, output):
    """The page of a run, without and with a reference, and without matplotlib."""
    page = output / "run.html"
    code, text = run(*report, folder, "--output", page)
    expect("run: exit code 0", code == 0, text)
    check_page("run", page, ("Done", "Audit", "energy gain", "Assembly, by effect"), 3, 30)
    probe = next(iter(sorted((folder / "probes").glob("*.csv"))))
    column = probe.read_text().split("\n")[0].split(",")[1].split(" (")[0]
    reference = output / "reference.csv"
    reference.write_text("# by hand\nt,x\n0,0.1\n0.05,0.2\n")
    code, text = run(SCRIPT, folder, "--output", page, "--reference", f"{probe.stem}:{column}={reference}")
    expect("run: a reference is drawn", code == 0 and "reference.csv" in page.read_text(), text)
    code, text = run(SCRIPT, folder, "--output", page, "--reference", f"nowhere:x={reference}")
    expect("run: a reference without a probe is said", "no probe curve nowhere:x" in page.read_text(), text)
    code, text = run("/usr/bin/python3", "-S", SCRIPT, folder, "--output", page)
    expect("run: without matplotlib there are tables, and it is said what to install",
           code == 0 and "python3-matplotlib" in page.read_text() and "<svg" not in page.read_text(), text)
    check_page("run without matplotlib", page, ("Done", "python3-matplotlib"), 0, 30)


def main():
    program = sys.argv[1]
    is_script = pathlib.Path(program).resolve() == SCRIPT
    report = [program] if is_script else [program, "report"]
    given = [pathlib.Path(path).resolve() for path in sys.argv[2:]]
    if is_script and not given:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory(prefix="selkie-report-") as name:
        folder = pathlib.Path(name)
        if not given:
            make_folders(program, folder)
            if "selkie report" not in run(program, "--help")[1]:
                print("skipped the command 'report': the program does not have it; scripts/report is used")
                report = [SCRIPT]
        first = given[0] if given else folder / "run"
        check_run(report, first, folder)
        study = given[1] if len(given) > 1 else folder / "study"
        if study.exists():
            code, text = run(*report, study, "--output", folder / "study.html")
            check_page("study", folder / "study.html", ("members", "Cheapest settings", "Pareto front"), 3, 5)
        if not given:
            code, text = run(*report, first, folder / "<other> & run", "--output", folder / "two.html")
            check_page("two runs", folder / "two.html", ("Side by side", "audit", "&lt;other&gt; &amp; run", "Time/Step"), 5, 60)
            code, text = run(*report, folder / "hopeless", "--output", folder / "failure.html")
            check_page("failure", folder / "failure.html", ("Failure", "End of the log"), 1, 20)
            check_verdict(report, folder / "strict", folder)
        code, text = run(*report, HERE)
        expect("a folder that is no run is refused", code == 1 and "summary.json" in text, text)
    sys.exit(expect.failed)


main()
