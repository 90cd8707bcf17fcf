"""Pieces of an HTML page that needs nothing from outside: tables, bars, plots."""
import html
import io
import math
import re

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"svg.fonttype": "none", "font.size": 10, "axes.grid": True, "grid.linewidth": 0.3,
                         "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False,
                         "legend.fontsize": 9, "axes.titlesize": 10})
except ImportError:
    plt = None

NO_PLOTS = ("The plots and pictures need matplotlib (Debian: apt-get install "
            "--no-install-recommends python3-matplotlib).")
VIRIDIS = "#440154,#46327e,#365c8d,#277f8e,#1fa187,#4ac16d,#a0da39,#fde725"
STYLE = """
*{box-sizing:border-box} svg *{stroke-linejoin:round;stroke-linecap:butt}
body{margin:0 auto;padding:1.5rem 1rem 4rem;max-width:72rem;color:#1c2430;background:#fff;
 font:1rem/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",sans-serif;overflow-wrap:anywhere}
h1{font-size:1.8rem;line-height:1.2;margin:.2rem 0 1rem} h2{font-size:1.25rem;margin:2.6rem 0 .6rem}
h3{font-size:1rem;margin:1.4rem 0 .4rem} p{max-width:46rem;margin:.5rem 0}
section.part{border-top:2px solid #1c2430;margin-top:3.5rem;padding-top:1rem}
.verdict{padding:.6rem .9rem;border-left:4px solid;background:#f3f6f4;border-color:#2e7d4f}
.verdict.bad{background:#fbf0ee;border-color:#b03020} .quiet{color:#5d6878;font-size:.9rem}
.scroll{overflow-x:auto;margin:.6rem 0} table{border-collapse:collapse;font-size:.875rem;overflow-wrap:normal}
th,td{padding:.28rem .8rem .28rem 0;text-align:left;border-bottom:1px solid #e3e7ec;vertical-align:top}
th{font-weight:600} thead th{border-bottom:1px solid #9aa5b1;white-space:nowrap}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
tbody th{font-weight:400;white-space:nowrap} td.n+td{padding-left:.4rem}
.mark{display:inline-block;min-width:3.2rem;padding:0 .4rem;border-radius:.2rem;font-size:.8rem;text-align:center}
.ok{background:#dff0e5;color:#1d5c38} .warn{background:#fbe3c8;color:#7a3d00} .mark.bad{background:#f6d5d0;color:#8a1c10} .info{background:#e6ebf1;color:#3c4858}
.track{display:block;width:9rem;height:.7rem;margin-top:.32rem;background:#f0f2f5} .bar{display:block;height:100%;background:#4a7ba6}
.plots{display:grid;gap:1rem 1.5rem;grid-template-columns:repeat(auto-fill,minmax(min(100%,20rem),1fr))}
.plots.wide{grid-template-columns:repeat(auto-fill,minmax(min(100%,28rem),1fr))}
figure{margin:0;min-width:0} figure svg,figure img{display:block;width:100%;height:auto} figure img{border:1px solid #e3e7ec}
.line{white-space:nowrap} figcaption{font-size:.875rem;color:#5d6878}
.scale{display:flex;gap:.6rem;align-items:center;font-size:.875rem;color:#5d6878}
.ramp{flex:0 1 14rem;height:.7rem;background:linear-gradient(90deg,RAMP)}
pre{font:.8rem/1.45 ui-monospace,Menlo,Consolas,monospace;background:#f5f6f8;padding:.7rem .9rem;overflow-x:auto;margin:.3rem 0}
""".replace("RAMP", VIRIDIS)


def esc(value):
    return html.escape(str(value))


def number(value, digits=4):
    """A number for reading; other things as they are."""
    try:
        return f"{float(f'{float(value):.{digits}g}'):.10g}"  # no exponent for thousands
    except (TypeError, ValueError):
        return str(value)


class Raw(str):
    """Text that is HTML already; in a table it stands on the left."""


def words(value):
    """A value of a table that is text even if it looks like a number."""
    return Raw(esc(value))


def is_number(text):
    try:
        float(text)
        return not isinstance(text, Raw)
    except (TypeError, ValueError):
        return False


def cell(value, tag="td", attributes=""):
    right = ' class="n"' if is_number(value) else ""
    return f"<{tag}{attributes}{right}>{value if isinstance(value, Raw) else esc(value)}</{tag}>"


def table(head, rows):
    """A table in a box of its own that scrolls; the first column heads the rows."""
    right = [any(is_number(row[i]) for row in rows) for i in range(len(head))]
    heads = "".join(f'<th scope="col"{" class=n" if r else ""}>{esc(h)}</th>' for h, r in zip(head, right))
    body = "\n".join("<tr>" + cell(Raw(row[0] if isinstance(row[0], Raw) else esc(row[0])), "th", ' scope="row"')
                     + "".join(map(cell, row[1:])) + "</tr>" for row in rows)
    return (f'<div class="scroll" tabindex="0"><table>{f"<thead><tr>{heads}</tr></thead>" if any(head) else ""}\n'
            f"<tbody>{body}</tbody></table></div>")


def bar(share):
    share = min(max(share, 0.), 1.) if math.isfinite(share) else 0.
    return Raw(f'<span class="track"><span class="bar" style="width:{100 * share:.1f}%"></span></span>')


def mark(kind, text):
    return Raw(f'<span class="mark {kind}">{esc(text)}</span>')


def note(text):
    return f'<p class="quiet">{esc(text)}</p>'


def block(title, content):
    return f"<h2>{esc(title)}</h2>\n{content}\n"


def grid(figures, wide=False):
    return f'<div class="plots{" wide" if wide else ""}">\n' + "\n".join(figures) + "\n</div>"


def svg(figure, alt, caption=""):
    """The figure as SVG of its own in the page; ids are made unique."""
    text = io.StringIO()
    figure.savefig(text, format="svg")
    plt.close(figure)
    svg.count = getattr(svg, "count", 0) + 1
    text = re.sub(r"(?s)^.*?(?=<svg)|<metadata>.*?</metadata>|<style.*?</style>", "", text.getvalue())
    text = re.sub(r' xmlns(:xlink)?="[^"]*"', "", text)
    text = re.sub(r'(?<=id=")|(?<=href="#)|(?<=url\(#)', f"f{svg.count}-", text)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, 1), 1)
    text = text.replace("<svg", f'<svg role="img" aria-label="{esc(alt)}"', 1)
    return f"<figure>{text}" + (f"<figcaption>{esc(caption)}</figcaption>" if caption else "") + "</figure>"


def safely(what, make, *arguments):
    """A piece of the page; or a line that says why there is none."""
    if plt is None:
        return ""
    try:
        return make(*arguments)
    except (Exception, SystemExit) as error:  # a half-written file, a field that is not there
        return note(f"No {what}: {error or type(error).__name__}")
