"""The report: one self-contained HTML page from the studies' published files, images inlined, nothing loaded from elsewhere."""

import base64
import math
import re
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

from analysis import charts, comparison, publish, studies, style
from analysis.definitions import DEFINITIONS
from analysis.load import ResultError
from analysis.overview import LEADS, TOPICS

QUESTION = ("Load a dense packing of disks, unload it, and some strain remains. How much depends on the method: with springs at the contacts "
            "(Molecular Dynamics, MD) the loop is wide, with rigid contacts (Contact Dynamics, CD) narrow. Is that the physics of rigid grains, or "
            "the solver?")
PAPER = ("R. García-Rojo, S. McNamara and H. J. Herrmann, Discrete element methods for the micro-mechanical investigation of granular ratcheting, "
         "ECCOMAS 2004")

# What the page needs of the files of a study and of a chart.
COMMON = dict.fromkeys(("title", "question", "answer", "extent", "python", "processor", "run_command", "figure_command"), str) | dict.fromkeys(
    ("commits", "yade"), list) | dict.fromkeys(("runs_finished", "runs_failed"), int) | {"computing_seconds": (int, float)}
CHART = COMMON | {"chart": str, "figures": list}
STUDY = COMMON | dict.fromkeys(("study", "headline", "lead", "numpy"), str) | dict.fromkeys(("points", "tables"), list) | dict.fromkeys(
    ("energy_balance", "parameters", "varied"), dict) | dict.fromkeys(("runs_missing", "runs_collapsed", "packings"), int)
POINT, BALANCE = {"order", "quote", "where", "verdict", "measured"}, {"runs", "median", "largest"}


def build(folder, path):
    """Write the page of the studies published in `folder` to `path`. ResultError if there is none."""
    found = {name: _study(Path(folder) / name) for name in studies.names()}
    there = {name: study for name, study in found.items() if study}
    if not there:
        raise ResultError(folder, "holds no study", "make them with `make study`")
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=jinja2.StrictUndefined,
                                     trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"short": style.short, "number": _number, "duration": _duration, "symbols": _symbols}
    commits = sorted({commit for study in there.values() for commit in study["commits"]})
    page = environment.get_template("report.html").render(
        question=QUESTION, paper=PAPER, leads=[there[name]["lead"] for name in LEADS if name in there and there[name]["lead"]], topics=[(heading, [there[name] for name in names if name in there]) for heading, names in TOPICS],
        studies=list(there.values()), absent=[studies.module(name).TITLE for name, study in found.items() if not study],
        charts=[chart for name in charts.names() if (chart := _chart(Path(folder) / charts.FOLDER / name))],
        points=_points(there.values()), definitions=DEFINITIONS, commits=commits,
        dirty=[commit for commit in commits if commit.endswith("-dirty")], extents=sorted({study["extent"] for study in there.values()}))
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page)
    return path


def _study(stem):
    """What was published of a study, with its figure as a data URL and its table; None where there is nothing."""
    files = [stem.with_suffix(suffix) for suffix in (".json", ".csv", ".png")]
    if not files[0].is_file():
        return None
    try:
        study = publish.read_json(files[0], STUDY)
        if not all(isinstance(point, dict) and point.keys() >= POINT and point["order"] in range(len(comparison.POINTS)) for point in study["points"]):
            raise ValueError("points of another kind")
        if not all(isinstance(balance, dict) and balance.keys() >= BALANCE for balance in study["energy_balance"].values()):
            raise ValueError("energy_balance of another kind")
        headings, rows = publish.read_csv(files[1])
        picture = _data_url(files[2])
    except (OSError, ValueError) as error:
        raise ResultError(stem, f"is incomplete or damaged ({error})", f"make it again: /usr/bin/python3 -m analysis study {stem.name}") from None
    failures = [row[publish.STATUS] for row in rows if row.get(publish.STATUS)]
    return study | {"headings": headings, "rows": rows, "picture": picture,
                    "failures": {reason: failures.count(reason) for reason in dict.fromkeys(failures)}}


def _chart(stem):
    """What was published of a chart of speed against accuracy or a map of stability; None where there is nothing."""
    if not stem.with_suffix(".json").is_file():
        return None
    try:
        chart = publish.read_json(stem.with_suffix(".json"), CHART)
        headings, rows = publish.read_csv(stem.with_suffix(".csv"))
        pictures = [(figure["title"], _data_url(stem.with_name(figure["file"]))) for figure in chart["figures"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ResultError(stem, f"is incomplete or damaged ({error})", "make it again: /usr/bin/python3 -m analysis charts") from None
    return chart | {"headings": headings, "rows": rows, "pictures": pictures}


def _data_url(picture):
    """A picture as it stands in the page."""
    return f"data:image/png;base64,{base64.b64encode(picture.read_bytes()).decode()}"


def _points(found):
    """The paper's statements in its order, each with the study that judged it; those whose study is absent stay open."""
    judged = {point["order"]: point | {"study": study["study"], "title": study["title"]} for study in found for point in study["points"]}
    return [judged.get(number, {"quote": point.quote, "where": point.where, "verdict": comparison.OPEN, "measured": "Not run yet.",
                                "study": None, "title": None})
            for number, point in enumerate(comparison.POINTS)]


# Words of plain text and what stands for them on the page; longer ones first.
_SYMBOLS = ((r"(\d)e([+-]?)0*(\d+)\b", lambda m: f"{m[1]}·10<sup>{'−' if m[2] == '-' else ''}{m[3]}</sup>"),
            (r"\bsigma([12])\b", r"σ<sub>\1</sub>"), (r"\bk_([nt])\b", r"k<sub>\1</sub>"), (r"\bN_I\b", "N<sub>I</sub>"), (r"\bP0\b", "P<sub>0</sub>"),
            (r"\bV0\b", "V<sub>0</sub>"), (r"\bdSigma\b", "Δσ"), (r"\bgamma\b", "γ"), (r"\bkappa\b", "κ"), (r"\beta\b", "η"), (r"\bmu\b", "μ"),
            (r"\balpha\b", "α"), (r"n\^(-?[\d.]+\d)", r"n<sup>\1</sup>"), (r"mu\^([\d.]+\d)|μ\^([\d.]+\d)", r"μ<sup>\1\2</sup>"))


def _symbols(text):
    """Plain text with the field's symbols for their names, and powers of ten as such."""
    html = str(escape(text))
    for pattern, symbol in _SYMBOLS:
        html = re.sub(pattern, symbol, html)
    return Markup(html)


def _number(text):
    """A table's cell: numbers to four digits, the rest as it is."""
    try:
        value = float(text)
    except (TypeError, ValueError):
        return text
    if not math.isfinite(value):
        return "–" if math.isnan(value) else text
    return f"{value:.4g}"


def _duration(seconds):
    """Seconds, minutes or hours, whichever reads best."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
