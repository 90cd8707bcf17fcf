"""The page of a study: what accuracy costs in time."""
import csv
import json
import re

from page import Raw, block, esc, grid, is_number, mark, note, number, plt, safely, svg, table, words

MARKS = "os^Dv<>pP*"


def error_plot(rows, about, x, label, front):
    """Error against a column, one curve a series; failed members are crosses above."""
    figure, axis = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
    good = [r for r in rows if not r["failure"] and float(r["error"]) > 0]
    series = list(dict.fromkeys(r["series"] for r in rows))
    for i, name in enumerate(series):
        mine = sorted((float(r[x]), 100 * float(r["error"])) for r in good if r["series"] == name)
        if mine:
            axis.plot(*zip(*mine), marker=MARKS[i % len(MARKS)], color=f"C{i}", label=name)
    best = sorted((float(r[x]), 100 * float(r["error"])) for r in good if r["member"] in about.get("pareto front", []))
    if front and best:
        axis.plot(*zip(*best), color="0.8", linewidth=6, zorder=0, label="Pareto front")
    places = [float(r[x]) for r in good]
    for r in rows:
        if r["failure"] and good:
            place = float(r[x]) if float(r[x]) > 0 else min(places)
            axis.plot(place, 2 * max(100 * float(r["error"]) for r in good), "x", markersize=9,
                      color=f"C{series.index(r['series'])}")
    axis.set(xscale="log", yscale="log", xlabel=label, ylabel=f"error of {about.get('quantity', 'the quantity')} (%)")
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, 1.2), ncols=2)
    return svg(figure, f"Error against {label}", f"Error against {label}"
               + (": a cross is a member that failed." if any(r["failure"] for r in rows) else "."))


def phases_of(rows):
    """The columns with the times of the phases."""
    return [c for c in rows[0] if c.endswith(" (s)") and c not in ("wall (s)", "cpu (s)")]


def phase_plot(rows):
    """What the time of each member went into, as shares."""
    phases = phases_of(rows)
    good = [r for r in rows if not r["failure"] and all(is_number(r[p]) for p in phases)]
    figure, axis = plt.subplots(figsize=(7, 1.2 + 0.27 * len(good)), layout="constrained")
    sums = [sum(float(r[p]) for p in phases) or 1. for r in good]
    left = [0.] * len(good)
    for i, phase in enumerate(phases):
        wide = [100 * float(r[phase]) / s for r, s in zip(good, sums)]
        axis.barh([r["member"] for r in good], wide, left=left, color=f"C{i}", label=phase[:-4], height=0.75)
        left = [a + b for a, b in zip(left, wide)]
    for i, s in enumerate(sums):
        axis.text(101, i, f"{s:.2g} s", va="center", fontsize=9)
    axis.set(xlim=(0, 112), xlabel="share of the phases' time (%)", ylim=(len(good) - 0.4, -0.6))
    axis.grid(False)
    axis.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4)
    return f'<div style="max-width:48rem">{svg(figure, "Shares of the phases in the time of each member")}</div>'


def members(rows):
    """The table of all members; what all have set is said once."""
    parts = [r["settings"].split(" & ") for r in rows]
    common = [p for p in parts[0] if all(p in other for other in parts)]
    phases = phases_of(rows) if plt else []  # else the plot shows them
    columns = [c for c in rows[0] if c not in ("series", "member", "settings", "failure", *phases)]
    show = lambda c, v: v if c in ("unknowns", "points", "steps") else number(v, 3 if c[-3:] == "(s)" else 4)
    body = [(r["member"], Raw(mark("warn", "failed") + " " + esc(r["failure"])) if r["failure"] else mark("ok", "done"),
             *[show(c, r[c]) for c in columns],
             Raw(f'<span class="line">{esc(" & ".join(p for p in own if p not in common))}</span>'))
            for r, own in zip(rows, parts)]
    return ((note("All members have: " + " & ".join(common)) if common else "")
            + table(["member", "", *columns, "settings"], body))


def readings(about, series):
    """"1 % error: fem 3.1 s, lme not reached", as a table."""
    lines = about.get("time to error (CPU s)", [])
    pattern = "(.*) error: " + ", ".join(re.escape(s) + r" (not reached|\S+ s)" for s in series)
    found = [re.fullmatch(pattern, line) for line in lines]
    if not lines:
        return note("No series reaches any of the errors that are compared.")
    if not all(found):
        return "<ul>" + "".join(f"<li>{esc(line)}</li>" for line in lines) + "</ul>"
    return table(["error", *series], [tuple(f.groups()) for f in found])


def study_part(folder):
    about = json.loads((folder / "study.json").read_text())
    path = folder / "study.csv"
    rows = list(csv.DictReader(path.open(newline=""))) if path.exists() else []
    failed = sum(bool(r["failure"]) for r in rows)
    text = (f'<p class="verdict{" bad" if failed == len(rows) else ""}"><strong>{len(rows)} members</strong>, '
            f'{failed or "none"} failed. Error of {esc(about.get("quantity", "?"))}.</p>'
            + note(f'Study {about.get("study", "?")}, scene {about.get("scene", "?")}, {about.get("ranks", "?")} rank(s), '
                   f'median of {about.get("repetitions", "?")} repetition(s); folder {folder}.'))
    if not rows:
        return text + note("There is no study.csv yet.")
    series = list(dict.fromkeys(r["series"] for r in rows))
    if plt:
        text += block("Error against cost", grid(
            [safely("Pareto plot", error_plot, rows, about, "cpu (s)", "CPU time (s)", True),
             safely("plot over the unknowns", error_plot, rows, about, "unknowns", "unknowns", False)], wide=True))
    text += block("CPU time to reach an error", readings(about, series))
    text += block("Observed orders", "<ul>" + "".join(f"<li>{esc(l)}</li>" for l in about.get("orders", [])) + "</ul>"
                  if about.get("orders") else note("None."))
    text += block("Members", members(rows))
    if plt:
        text += block("What the time went into", safely("phases", phase_plot, rows))
    best = folder / "cheapest.prm"
    blocks = re.split(r"\n# (?=error)", best.read_text())[1:] if best.exists() else []
    return text + block("Cheapest settings that reach an error", "".join(
        "<h3>{}</h3><pre>{}</pre>".format(*map(esc, b.strip().split("\n", 1))) for b in blocks if "\n" in b.strip())
        or note("There is no cheapest.prm, or no member reaches any of the errors."))
