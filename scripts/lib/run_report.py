"""The page of a run, and what is said of several runs side by side."""
import base64
import csv
import importlib.machinery
import io
import json
import math
import pathlib
import re
import time
import types

from page import (Raw, bar, block, esc, grid, is_number, mark, note, number, plt, safely, svg, table,
                  words)

if plt:
    import numpy as np

GRADES = {"pass": "ok", "warn": "warn", "fail": "bad"}  # of the audit, and how they look
SCRIPTS = pathlib.Path(__file__).resolve().parents[1]


def read_table(path):
    """A CSV file as {name with unit: column of floats}; {} if it is not there."""
    if not path.exists():
        return {}
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    head, *rows = list(csv.reader(lines)) or [[]]
    value = lambda row, i: float(row[i]) if i < len(row) and is_number(row[i]) else math.nan
    return {name: [value(row, i) for row in rows] for i, name in enumerate(head)}


def bare(name):
    """A column's name without its unit."""
    return name.split(" (")[0]


def column(columns, name):
    return next((values for key, values in columns.items() if name in (key, bare(key))), [])


def read_prm(path):
    """{(section, name): value} of a .prm file, in its order."""
    values, sections = {}, []
    if path.exists():
        for line in re.sub(r"\\\n\s*", "", path.read_text()).splitlines():
            line = line.split("#")[0].strip()
            if line.startswith("subsection"):
                sections.append(line[len("subsection"):].strip())
            elif line == "end":
                sections = sections[:-1]
            elif line.startswith("set") and "=" in line:
                name, value = (" ".join(part.split()) for part in line[3:].split("=", 1))
                values["/".join(sections), name] = value
    return values


def read_defaults():
    """[(pattern of a section, name, default)] as doc/parameters.md lists them."""
    path, defaults, section = SCRIPTS.parent / "doc" / "parameters.md", [], None
    for line in path.read_text().splitlines() if path.exists() else []:
        if line.startswith("#"):
            found = re.match(r"## `(.*)`", line)
            section = re.sub(r"<[^>]*>", "[^/]*", found[1]) if found else "" if line == "## Top level" else None
        found = re.match(r"- \*\*(.*)\*\* \(default `(.*?)`[;)]|- \*\*(.*)\*\* \(default empty", line)
        if found and section is not None:
            defaults.append((section, found[1] or found[3], found[2] or ""))
    return defaults


def same(a, b):
    """Whether two values of parameters are the same; a default may have more components."""
    a, b = ([part.strip() for part in text.split(",")] for text in (a, b))
    equal = lambda x, y: float(x) == float(y) if is_number(x) and is_number(y) else x == y
    return len(a) <= len(b) and all(map(equal, a, b)) and (len(a) == len(b) or is_number(a[0]))


class Run:
    """What is in the output folder of a run."""

    def __init__(self, folder):
        self.folder = folder
        path = folder / "summary.json"
        self.summary = json.loads(path.read_text()) if path.exists() else {
            "title": folder.name, "verdict": "unfinished", "failure": "there is no summary.json: the run was killed"}
        self.title = self.summary.get("title") or folder.resolve().name
        self.stats = read_table(folder / "statistics.csv")
        self.probes = {p.stem: read_table(p) for p in sorted((folder / "probes").glob("*.csv"))}
        self.parameters = read_prm(folder / "parameters.prm")
        self.original = read_prm(folder / "original.prm")
        self.date = time.strftime("%Y-%m-%d %H:%M", time.localtime((path if path.exists() else folder).stat().st_mtime))

    def last(self, name, default=math.nan):
        return (column(self.stats, name) or [default])[-1]

    def changed(self):
        """{(section, name): (value, who set it)} of the parameters that are not at their defaults."""
        defaults, result = read_defaults(), {}
        for (section, name), value in (self.parameters or self.original).items():
            default = next((d for s, n, d in defaults if n == name and re.fullmatch(s, section)), None)
            given = (section, name) in self.original
            if (section, name) == ("Output", "Directory") or (
                    same(value, default) if default is not None else not given or not value):
                continue
            in_file = given and same(value, self.original[section, name])
            result[section, name] = value, ("file" if in_file else "command line" if given else
                                            "command line, or follows from the scene")
        return result


def verdict(run):
    s = run.summary
    made = ", ".join([run.date, *(f"{k} {v}" for k, v in s.get("versions", {}).items()), f"{s.get('ranks', '?')} rank(s)"])
    made = note(made) + (note("Effects: " + ", ".join(s["effects"])) if s.get("effects") else "")
    if s.get("verdict") == "done":
        grade = s.get("audit", {}).get("grade")
        return (f'<p class="verdict{" bad" if grade == "fail" else ""}"><strong>Done</strong>: {s.get("steps", "?")} '
                f'steps to t = {number(s.get("final time (s)"))} s in {number(s.get("wall time (s)"), 3)} s.'
                + (f' Audit: {mark(GRADES[grade], grade)}' if grade else "") + '</p>' + made)
    path = run.folder / "log.txt"
    tail = path.read_text(errors="replace").splitlines()[-12:] if path.exists() else []
    return (f'<p class="verdict bad"><strong>{esc(str(s.get("verdict", "?")).capitalize())}</strong>: '
            f'{esc(s.get("failure", ""))}</p>' + made + (f"<h3>End of the log</h3><pre>{esc(chr(10).join(tail))}</pre>"
                                                  if tail else ""))


def facts(run):
    """The plain figures of summary.json, those of later versions too."""
    s = run.summary
    rows = [("folder", str(run.folder))]
    for key, value in s.items():
        if key in ("title", "verdict", "failure", "versions", "ranks", "effects",
                   "final figures", "audit", "material points"):
            continue
        if isinstance(value, dict):
            rows += [(f"{key}: {k}", number(v, 6)) for k, v in value.items() if not isinstance(v, (dict, list))]
        elif not isinstance(value, list):
            rows.append((key, str(value) if isinstance(value, int) else number(value, 6)))
        elif all(isinstance(v, str) for v in value):
            rows.append((key, ", ".join(value)))
    return table(["", ""], [(k, words(v)) for k, v in rows])


def play(run):
    """The energy in play, as the program's log has it."""
    first = sum(v[0] for k, v in run.stats.items() if v and bare(k) in
                ("kinetic energy", "strain energy", "compression energy", "potential energy"))
    return max(abs(first), run.last("kinetic energy", 0) + run.last("strain energy", 0),
               abs(run.last("potential energy", 0)))


def judged(run):
    """The audit's verdict, figure by figure."""
    rows = []
    for f in run.summary["audit"]["figures"]:
        limits = [f'{word} {f["bad"]} {number(f[limit], 3)}' for word, limit in (("warns", "warning"), ("fails", "failure"))
                  if f[limit]]
        first = f.get("failed at (s)" if f["grade"] == "fail" else "warned at (s)")
        rows.append((f["figure"], number(f["worst"], 3), mark(GRADES[f["grade"]], f["grade"]),
                     "" if first is None else words(number(first, 4)), ", ".join(limits)))
    return table(["figure", "worst", "", "from t (s) on", "limits"], rows)


def audit(run):
    """The figures that say whether the run can be trusted."""
    points, rows = run.summary.get("material points", {}), []

    def row(what, value, kind, word):
        rows.append((what, words(value), mark(kind, word)))

    scale, balance = play(run), run.last("energy balance")
    if math.isfinite(balance) and scale > 0:
        row("energy balance at the end", f"{number(balance, 3)} = {number(100 * balance / scale, 2)} % of the energy in play",
            "info", "figure")
    low, high = column(run.stats, "min J"), column(run.stats, "max J")
    if low and high:
        row("volume ratio J", f"{number(min(low), 5)} to {number(max(high), 5)}", "info", "figure")
    figures = run.summary.get("final figures", {})
    for name in ("momentum", "angular momentum"):
        if isinstance(figures.get(name), dict):
            row(name + " at the end", ", ".join(f"{k} {number(v, 5)}" for k, v in figures[name].items()), "info", "figure")
    removed, kept = points.get("removed", 0), points.get("kept at wall", 0)
    row("points removed", f"{removed} of {points.get('seeded', '?')}", *(("warn", "warn") if removed else ("ok", "ok")))
    row("points kept at walls", kept, *(("info", "note") if kept else ("ok", "ok")))
    cuts = sum(column(run.stats, "step cuts")[-1:])
    row("step cuts", number(cuts), *(("info", "note") if cuts else ("ok", "ok")))
    return (judged(run) if "audit" in run.summary else note("No verdict: Output/Audit = none, or the run is not done.")
            ) + table(["figure", "value", ""], rows)


def energies(run):
    t = column(run.stats, "time")
    names = [n for n in run.stats if "energy" in n or bare(n) == "external work"]
    names = [n for n in names if any(v for v in run.stats[n])]
    if not t or not names:
        return note("No energies: the run wrote none (Output/Audit = none).")
    figure, axis = plt.subplots(figsize=(6.4, 4), layout="constrained")
    for i, name in enumerate(names):
        style = dict(color="black", linestyle="--") if bare(name) == "energy balance" else dict(color=f"C{i % 10}")
        axis.plot(t, run.stats[name], marker="." if len(t) < 3 else "", label=bare(name), **style)
    unit = re.search(r"\((.*)\)", names[0])
    axis.set(xlabel="time (s)", ylabel=f"energy ({unit[1]})" if unit else "energy")
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, 1.28), ncols=3, fontsize=8)
    return svg(figure, f"Energies of {run.title} over time", "Energies; the balance should stay near zero.")


def iterations(run):
    steps, dt = column(run.stats, "step"), column(run.stats, "dt")
    newton, linear = column(run.stats, "newton iterations"), column(run.stats, "linear iterations")
    if not steps or not newton:
        return note("No iterations: there is no statistics.csv.")
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(6.4, 4), sharex=True, layout="constrained")
    style = dict(marker="." if len(steps) < 3 else "")
    upper.plot(steps, newton, label="Newton", drawstyle="steps-mid", **style)
    if any(linear):
        upper.plot(steps, [l / max(n, 1) for l, n in zip(linear, newton)], label="linear per Newton iteration", **style)
    upper.set(ylabel="iterations", ylim=(0, None))
    upper.legend(ncols=2)
    lower.plot(steps, dt, drawstyle="steps-mid", color="C2", **style)
    lower.set(xlabel="step", ylabel="step size (s)", ylim=(0, 1.15 * max(dt, default=1)))
    return svg(figure, f"Iterations and step size of {run.title}", "Iterations and step size, step by step.")


def probe_plot(runs, probe, name, references):
    """One column of a probe, of all runs, with its reference."""
    figure, axis = plt.subplots(figsize=(4.2, 2.7), layout="constrained")
    for i, run in enumerate(runs):
        columns = run.probes.get(probe, {})
        t, values = column(columns, "time"), columns.get(name)
        if values and any(math.isfinite(v) for v in values):
            axis.plot(t, values, color=f"C{i}", marker="." if len(t) < 3 else "",
                      label=run.folder.name if len(runs) > 1 else "this run")
    for file, t, values in references.get((probe, bare(name)), []) + references.get((probe, name), []):
        axis.plot(t, values, "k--o", markersize=3, linewidth=1, label=file)
    if len(axis.lines) > 1:
        axis.legend(fontsize=8)
    axis.set(title=f"{probe}: {name}", xlabel="time (s)")
    return svg(figure, f"{name} of probe {probe} over time")


def probes(runs, references):
    names = list(dict.fromkeys((probe, name) for run in runs for probe, columns in run.probes.items()
                               for name in list(columns)[1:]))
    lines = [note(f"There is no probe curve {p}:{c} for the reference.") for p, c in references
             if not any(p == q and c in (n, bare(n)) for q, n in names)]
    if not names:
        return "".join(lines) + note("The run has no probes.")
    asked = [n for n in names if (n[0], n[1]) in references or (n[0], bare(n[1])) in references]
    shown = (asked + [n for n in names if n not in asked])[:60]
    if len(shown) < len(names):
        lines.append(note(f"The first {len(shown)} of {len(names)} curves; all are in probes/*.csv."))
    return "".join(lines) + grid([probe_plot(runs, p, n, references) for p, n in shown])


def fluid_bodies(run):
    """The numbers of the bodies that are fluids."""
    names = [n.strip() for n in run.parameters.get(("Bodies", "Names"), "").split(",")]
    return [i for i, n in enumerate(names) if "fluid" in run.parameters.get((f"Bodies/{n}", "Law"), "")]


def pictures(run, count=4):
    """The particles at a few times: fluids by pressure, solids grey; without fluids by speed."""
    if not (run.folder / "particles.pvd").exists():
        return note("No pictures: the run wrote no VTU files (Output/Interval = 0).")
    reader = types.ModuleType("picture")
    importlib.machinery.SourceFileLoader("picture", str(SCRIPTS / "picture")).exec_module(reader)
    series = reader.read_pvd(run.folder / "particles.pvd")
    wanted = np.linspace(series[0][0], series[-1][0], min(count + 1, len(series)))[-count:]
    frames = list(dict.fromkeys(min(series, key=lambda s: abs(s[0] - t)) for t in wanted))
    data = [reader.read_vtu(file) for _, file in frames]
    fluids = fluid_bodies(run)
    field = next((f for f in (["pressure"] if fluids else []) + ["velocity", "displacement", "pressure"]
                  if f in data[0]), None)
    if field is None:
        return note("No pictures: the particles have neither pressure nor velocity nor displacement.")
    for d in data:
        d["grey"] = ~np.isin(d["body"], fluids) if fluids and "body" in d else np.zeros(len(d["points"]), bool)
        d["colour"] = np.linalg.norm(d[field], axis=1) if d[field].ndim == 2 else d[field]
    coloured = np.concatenate([d["colour"][~d["grey"]] for d in data])
    least, most = np.percentile(coloured[np.isfinite(coloured)], [1, 99]) if len(coloured) else (0, 1)
    least = min(0, least)
    dim = 3 if run.parameters.get(("", "Dimension"), "2") == "3" else 2
    pull = [abs(float(g)) if is_number(g) else 0 for g in run.parameters.get(("Gravity", "Acceleration"), "").split(",")]
    up = 2 if dim == 3 and len(pull) == 3 and pull[2] > pull[1] else 1
    places = np.concatenate([d["points"] for d in data])[:, [0, up]]
    low, high = places.min(axis=0), places.max(axis=0)
    margin = 0.03 * max(high - low)
    low, high = low - margin, high + margin
    aspect = min(max((high[1] - low[1]) / (high[0] - low[0]), 0.12), 1.6)
    size = np.median(data[0]["reference volume"]) ** (1 / dim) if "reference volume" in data[0] else \
        math.sqrt(np.prod(high - low) / len(data[0]["points"]))
    width = 4.6
    dot = (1.3 * size * 72 * min(width / (high[0] - low[0]), width * aspect / (high[1] - low[1]))) ** 2
    what = {"pressure": "pressure (Pa)", "velocity": "speed (m/s)", "displacement": "displacement (m)"}[field]
    figures = []
    for (t, _), d in zip(frames, data):
        figure = plt.figure(figsize=(width, width * aspect))
        axis = figure.add_axes((0, 0, 1, 1), xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axis.axis("off")
        order = np.argsort(-d["points"][:, 3 - up]) if dim == 3 else np.arange(len(d["points"]))
        x, grey, colour = d["points"][order][:, [0, up]], d["grey"][order], d["colour"][order]
        axis.scatter(*x[~grey].T, c=colour[~grey], s=dot, lw=0, vmin=least, vmax=most, cmap="viridis")
        axis.scatter(*x[grey].T, c="#8a8f96", s=dot, lw=0)
        png = io.BytesIO()
        figure.savefig(png, format="png", dpi=120, pil_kwargs={"optimize": True})
        plt.close(figure)
        figures.append(f'<figure><img alt="{esc(f"Particles of {run.title} at t = {t:.3g} s, coloured by {what}")}" '
                       f'src="data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}">'
                       f"<figcaption>t = {t:.3g} s</figcaption></figure>")
    scale = (f'<p class="scale"><span>{number(least, 3)}</span><span class="ramp"></span><span>{number(most, 3)}</span>'
             f'<span>{esc(what)}{"; solids grey" if any(d["grey"].any() for d in data) else ""}</span></p>')
    return scale + grid(figures, wide=True)


def timings(run):
    path = run.folder / "timing.csv"
    rows = list(csv.DictReader(path.open(newline=""))) if path.exists() else []
    if not rows:
        return note("There is no timing.csv.")
    indent = lambda p: Raw("&#160;" * 4 * p.count("/") + ("" if p == "total" else "&#160;&#160;") + esc(p.split("/")[-1]))
    return table(["section", "calls", "wall (s)", "cpu (s)", "%", "share"],
                 [(indent(r["path"]), r["calls"], number(r["wall (s)"], 3), number(r["cpu (s)"], 3),
                   f'{float(r["share (%)"]):.1f}', bar(float(r["share (%)"]) / 100)) for r in rows])


def effects(run):
    parts = run.summary.get("assembly by effect", [])
    if not parts:
        return note("The run did not say what its effects cost.")
    return table(["part of the assembly", "seconds", "%", "share"],
                 [(p["part"], number(p["seconds"], 3), f'{100 * p["share"]:.1f}', bar(p["share"])) for p in parts])


def settings(run):
    changed = run.changed()
    if not changed:
        return note("There is no parameters.prm, or all parameters are at their defaults.")
    return table(["section", "parameter", "value", "set by"],
                 [(s or "top level", words(n), words(v), who) for (s, n), (v, who) in changed.items()])


def run_part(run, references, alone):
    plots = grid([safely("energy plot", energies, run), safely("iteration plot", iterations, run)], wide=True)
    return (verdict(run) + block("Audit", audit(run))
            + (block("Particles", safely("pictures", pictures, run)) if plt else "")
            + (block("Energy and iterations", plots) if plt else "")
            + (block("Probes", safely("probe curves", probes, [run], references)) if plt and alone else "")
            + block("Time, by section", timings(run)) + block("Assembly, by effect", effects(run))
            + block("Parameters that are not at their defaults", settings(run)) + block("The run", facts(run)))


def comparison(runs, references):
    """Several runs side by side."""
    s = [run.summary for run in runs]
    get = lambda key, inner=None: [words(number(x.get(key, "-") if inner is None else x.get(key, {}).get(inner, "-"), 5))
                                   for x in s]
    balance = [f"{100 * r.last('energy balance') / play(r):.2g} %" if play(r) else "-" for r in runs]
    rows = [("verdict", *get("verdict")), ("audit", *get("audit", "grade")), ("title", *get("title")), ("steps", *get("steps")),
            ("final time (s)", *get("final time (s)")), ("wall time (s)", *get("wall time (s)")),
            ("points", *get("points")), ("unknowns", *get("unknowns")), ("ranks", *get("ranks")),
            ("energy balance", *balance), ("points removed", *get("material points", "removed")),
            ("min J", *get("final figures", "min J")), ("max J", *get("final figures", "max J")),
            ("git", *get("versions", "git")), ("date", *[run.date for run in runs])]
    keys = dict.fromkeys(key for run in runs for key in run.changed())
    value = lambda run, key: (run.parameters or run.original).get(key, "-")
    other = [("/".join(filter(None, key)), *[words(value(run, key)) for run in runs]) for key in keys
             if len({value(run, key) for run in runs}) > 1]
    names = [run.folder.name for run in runs]
    return (block("Side by side", table(["", *names], rows))
            + block("Parameters that differ", table(["parameter", *names], other) if other else note("None."))
            + (block("Probes", safely("probe curves", probes, runs, references)) if plt else ""))
