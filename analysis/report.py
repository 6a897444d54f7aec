"""The report: one HTML page of the published files, images inlined; tables are linked files, nothing is loaded from elsewhere."""

import base64
import io
import os
import re
from pathlib import Path

import jinja2
from markupsafe import Markup, escape
from PIL import Image

from analysis import causes, charts, publish, studies
from analysis.definitions import DEFINITIONS
from yade_scripts.results import provenance
from yade_scripts.results.reader import ResultError

PAPER = ("R. García-Rojo, S. McNamara and H. J. Herrmann, Discrete element methods for the micro-mechanical investigation of granular ratcheting, "
         "ECCOMAS 2004")
# The short answer on top. README has the same sentences; a test holds their numbers against the published tables.
FINDINGS = (
    ("fig4", "Load a dense packing by 0.2 P0 and unload it: springs strain by 4.3e-4 and keep 1.2e-4, rigid contacts strain by 3.7e-8 "
             "(medians of 10 packings)."),
    ("stiffness", "The strain of MD comes from its springs: over such a cycle the largest strain goes as k_n to the power -0.94 to "
                  "-1.01, what remains as k_n to the power -0.87 to -0.98 (5 packings)."),
    ("tolerance", "Rigid grains far below yield do not move. The strain of CD is solver error: on one packing it falls from 7.8e-4 to "
                  "9.2e-11 as the tolerance falls from 1e-2 to 1e-10."),
    ("isostatic", "They rest as long as the contacts that they start with can carry the load. With friction of 0.1 that "
                  "ends at 1.40 to 1.60 P0 (5 packings). Without it, near the rigid limit, it ends at 1.01 to 1.04 P0, and "
                  "just beyond it rigid grains strain under the load 0.92 times as far as springs do (0.67 to 0.98; 8 "
                  "cases from 4 packings), but keep 0.06 times as much of it (0.001 to 1.3)."),
    ("fig3", "The static limit is the largest sigma2/sigma1 that the contacts of a packing can carry, by a linear "
             "programme. Whether a packing rests or yields under cycles depends on the largest sigma2/sigma1 over this "
             "limit, whether sigma1 or the mean stress is held. Well below it rigid grains rest while springs strain; above it, "
             "in cycles of 0.5 s, springs collapse in 39 and rigid grains in 35 of 55 pairs. The paper's loads reach a "
             "collapse only if the mean stress is held."),
    ("ratcheting", "Far below the limit springs strain from cycle to cycle because they are soft: at equal load over the "
                   "limit, up to 0.96 of it, the strain of a late cycle goes as k_n to the power -0.98 (standard error "
                   "0.13; 13 runs from 7 seeds), within the 4 seeds of several stiffnesses to the power -0.76 (0.09); "
                   "between 0.96 and the limit rearrangements add to it, and the power is -0.42 (0.17). Rigid contacts "
                   "rest below 0.98 of the limit in 19 of 19 cases; between 0.98 and the limit 3 of 7 yield."),
    ("collapse", "With the mean stress held, in cycles of 0.5 s, rigid grains stand 1.46 times as many cycles as springs "
                 "of k_n before they collapse (median of 12 pairs from 6 packings, more in all), and 1.06 times as many as "
                 "springs of 10 k_n (0.68 to 3.08), which six packings do not tell from 1; in cycles of 2 s 1.05 times."),
    ("laws", "The strain of springs under cycles does not come from the tangential law: one whose closed paths leave neither force nor "
             "energy strains 6 packings 0.995 to 1.000 times as far over 40 cycles."))
# What the page needs of the JSON files.
STUDY = {"extent": str, "runs_finished": int, "packings": int, "computing_seconds": (int, float), "commits": list, "yade": list, "run_command": str,
         "energy_balance": dict}
CHART = {"figures": dict, "commits": list, "extent": str, "measured": int, "processor": str, "run_command": str}
MOST_PIXELS, COLOURS = 1100, 48  # of an inlined picture, so that the page stays below 2 MB


def build(folder, path):
    """Write the page of what is published in `folder` to `path`. ResultError if there is nothing."""
    folder, path = Path(folder), Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    link = lambda file: os.path.relpath(file.resolve(), path.parent.resolve())
    found = [_study(name, folder, link) for name in studies.names() if (folder / f"{name}.json").is_file()]
    if not found:
        raise ResultError(folder, "holds no study", "make them with `make study`")
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=jinja2.StrictUndefined,
                                     trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"short": provenance.short, "number": lambda value: f"{value:.2g}", "duration": _duration, "symbols": symbols}
    there = {study["name"] for study in found}
    points = sorted(((place, quote, where, verdict, text, name) for name in studies.names() for place, quote, where, verdict, text in studies.module(name).POINTS))
    commits = sorted({commit for study in found for commit in study["commits"]})
    page = environment.get_template("report.html").render(
        paper=PAPER, findings=FINDINGS, there=there, studies=found, absent=[studies.module(name).TITLE for name in studies.names() if name not in there],
        charts=[_chart(name, folder / charts.FOLDER, link) for name in charts.ORDER if (folder / charts.FOLDER / f"{name}.json").is_file()],
        points=points, definitions=DEFINITIONS, causes=causes.table(folder), processes=causes.PROCESSES, commits=commits, published=all(study["extent"] == "full" for study in found))
    path.write_text(page, encoding="utf-8")
    return path


def _study(name, folder, link):
    """Return what the page shows of a study."""
    study, facts = studies.module(name), publish.read_json(folder / f"{name}.json", STUDY)
    if not all(isinstance(balance, dict) and all(isinstance(balance.get(key), (int, float)) for key in ("runs", "median", "largest"))
               for balance in facts["energy_balance"].values()) or not all(isinstance(word, str) for word in facts["commits"] + facts["yade"]):
        raise ResultError(folder / f"{name}.json", "holds values of another kind", "make it again")
    table = publish.read_table(folder / f"{name}.csv")
    failures = table[publish.STATUS].dropna().value_counts().to_dict() if publish.STATUS in table else {}
    more = sorted(folder.glob(f"{name}-*.png"))
    return facts | {"name": name, "title": study.TITLE, "question": study.QUESTION, "answer": study.ANSWER.split("\n\n"), "failures": failures, "rows": len(table),
                    "picture": _picture(folder / f"{name}.png"), "table": link(folder / f"{name}.csv"), "origin": link(folder / f"{name}.json"),
                    "more": [(link(file), file.stem) for file in more], "large": link(folder / f"{name}.png")}


def _chart(name, folder, link):
    """Return what the page shows of a chart: its one figure, or links where there are many."""
    chart, facts = charts.module(name), publish.read_json(folder / f"{name}.json", CHART)
    pictures = [(link(folder / file), title) for file, title in facts["figures"].items()]
    single = _picture(folder / next(iter(facts["figures"]))) if len(pictures) == 1 else None
    return facts | {"name": name, "title": chart.TITLE, "question": chart.QUESTION, "answer": chart.ANSWER.split("\n\n"), "picture": single, "maps": getattr(chart, "descriptions", list)(),
                    "pictures": pictures, "table": link(folder / f"{name}.csv"), "origin": link(folder / f"{name}.json")}


def _picture(path):
    """Return a picture as it stands in the page: no wider than a screen shows, with as many colours as a chart has."""
    try:
        with Image.open(path) as image:
            image = image.convert("RGB")
            image.thumbnail((MOST_PIXELS, 4 * MOST_PIXELS), Image.LANCZOS)
            small = io.BytesIO()
            image.quantize(COLOURS, dither=Image.Dither.NONE).save(small, "PNG", optimize=True)
    except OSError as error:
        raise ResultError(path, f"is no picture ({error})", "make it again") from None
    return f"data:image/png;base64,{base64.b64encode(small.getvalue()).decode()}"


# Words of plain text and what stands for them on the page; longer ones first.
_SYMBOLS = ((r"(\d)e(-?)0*(\d+)\b", lambda m: f"{m[1]}·10<sup>{'−' if m[2] else ''}{m[3]}</sup>"),
            (r"\bsigma([12])\b", r"σ<sub>\1</sub>"), (r"\bk_([nt])\b", r"k<sub>\1</sub>"), (r"\bN_I\b", "N<sub>I</sub>"), (r"\bP0\b", "P<sub>0</sub>"),
            (r"\bV0\b", "V<sub>0</sub>"), (r"\bdSigma\b", "Δσ"), (r"\bgamma\b", "γ"), (r"\bkappa\b", "κ"), (r"\bmu\b", "μ"), (r"\balpha\b", "α"),
            (r"\bomega\b", "ω"), (r"\bbeta\b", "β"))


def symbols(text):
    """Return plain text with the field's symbols for their names, and powers of ten as such."""
    html = str(escape(text))
    for pattern, symbol in _SYMBOLS:
        html = re.sub(pattern, symbol, html)
    return Markup(html)


def _duration(seconds):
    """Return the time in seconds, minutes or hours, whichever reads best."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
