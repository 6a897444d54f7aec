"""Writes the report: one HTML page with all figures in it; tables are linked files, and nothing is loaded from the web."""
import base64
import io
import os
import re
from pathlib import Path

import jinja2
import markdown
from markupsafe import Markup, escape
from PIL import Image

from analysis import charts, publish, studies, style, texts
from yade_scripts.results import provenance, schema, sealed
from yade_scripts.errors import ResultError

PAPER = ("R. García-Rojo, S. McNamara and H. J. Herrmann, Discrete element methods for the micro-mechanical investigation of granular ratcheting, "
         "ECCOMAS 2004")
# Names and types that the page needs in the JSON files.
STUDY = {"extent": str, "runs_finished": int, "packings": int, "commits": list, "yade": list, "run_command": str,
         "energy_balance": dict, "parameters": dict, "varied": dict}
CHART = {"figures": dict, "commits": list, "extent": str, "measured": int, "processor": str, "run_command": str}
MOST_PIXELS, COLOURS = 1100, 96  # of an inlined picture, so that the page stays below 2 MB
PARTS = ("page", "appendix")  # of the studies that the page has, in this order


def build(folder, path, published=False, faults=None):
    """Write the page of the studies and charts in `folder` to `path`. Raise ResultError if there are none.

    published: these are the results of which the texts speak. faults: {study, or charts/chart: why its figure could not be made now}.
    """
    folder, path = Path(folder), Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    link = lambda file: os.path.relpath(file.resolve(), path.parent.resolve())
    broken, unread, faults = [], [], faults or {}
    names = [name for name in studies.names(broken) if studies.module(name).PART in PARTS]
    studied = _readable(names, folder, unread, lambda name: _study(name, folder, link))
    if not studied:
        raise ResultError(folder, "holds no study", "; ".join(["make them with `make study`", *unread]))
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=jinja2.StrictUndefined,
                                     trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"short": provenance.short, "number": lambda value: f"{value:.2g}", "symbols": symbols, "block": block}
    there, points = {study["name"] for study in studied}, []
    for name in names:
        try:
            points += [(*point, name) for point in texts.points(name)]
        except ResultError as error:
            unread.append(str(error))
    (words, short_answer), (note, processes, causes) = texts.findings(), texts.causes()
    page = environment.get_template("report.html").render(
        paper=PAPER, findings=short_answer, words=words, there=there,
        parts={part: [study for study in studied if study["part"] == part] for part in PARTS},
        studies=studied, faults=faults,
        absent=[studies.module(name).TITLE for name in names if not (folder / f"{name}.json").is_file()],
        charts=_readable(charts.ORDER, folder / charts.FOLDER, unread, lambda name: _chart(name, folder / charts.FOLDER, link)),
        broken=[*broken, *dict.fromkeys(unread)],
        points=sorted(points),
        balance={method: max(errors, key=lambda one: one[0]) for method in ("MD", "CD")
                 if (errors := [(one["energy_balance"][method]["largest"], one) for one in studied if method in one["energy_balance"]])},
        sliding_margin=f"{schema.SLIDING_MARGIN:g}", causes=causes, processes=processes, note=note,
        commits=sorted({commit for study in studied for commit in study["commits"]}),
        yade=sorted({one for study in studied for one in study["yade"]}),
        published=published)
    sealed.replace(path, page.encode())
    return path


def _readable(names, folder, unread, shown):
    """Return shown(name) of all names that have a file in the folder. Of one whose files cannot be read `unread` gets the message."""
    found = []
    for name in names:
        if (folder / f"{name}.json").is_file():
            try:
                found.append(shown(name))
            except ResultError as error:
                unread.append(str(error))
    return found


def _study(name, folder, link):
    study, facts = studies.module(name), publish.read_json(folder / f"{name}.json", STUDY)
    if not all(isinstance(balance, dict) and all(isinstance(balance.get(key), (int, float)) for key in ("runs", "median", "largest"))
               for balance in facts["energy_balance"].values()) or not all(isinstance(word, str) for word in facts["commits"] + facts["yade"]):
        raise ResultError(folder / f"{name}.json", "holds values of another kind", "make it again")
    table = publish.read_table(folder / f"{name}.csv")
    failures = table[publish.STATUS].dropna().value_counts().to_dict() if publish.STATUS in table else {}
    more = [(link(file), file.stem) for file in sorted(folder.glob(f"{name}-*.png"))]
    return facts | _head(name, study, texts.answer(name), folder, link) | {
        "failures": failures, "rows": len(table), "other_rows": publish.of_other_rows(name, facts, table), "more": more, "part": study.PART,
        "large": link(folder / f"{name}.png")} | _figure(folder / f"{name}.png")


def _chart(name, folder, link):
    """Return what the page shows of a chart: its one figure, or links where there are many."""
    chart, facts = charts.module(name), publish.read_json(folder / f"{name}.json", CHART)
    pictures = [(link(folder / file), title) for file, title in facts["figures"].items()]
    single = _figure(folder / next(iter(facts["figures"]))) if len(pictures) == 1 else {"picture": None}
    return facts | _head(name, chart, texts.answer(f"{charts.FOLDER}/{name}"), folder, link) | {"pictures": pictures} | single


def _head(name, module, answer, folder, link):
    """Return what the page shows of a study as of a chart."""
    return {"name": name, "title": module.TITLE, "question": module.QUESTION, "answer": answer.split("\n\n"),
            "table": link(folder / f"{name}.csv"), "origin": link(folder / f"{name}.json")}


def _figure(path):
    """Return a picture for the page, with fewer pixels and colours than the file, and its caption, which the page shows as text instead."""
    try:
        with Image.open(path) as image:
            caption, foot = (image.info.get(name, "") for name in (style.CAPTION, style.FOOT))
            image = image.convert("RGB").crop((0, 0, image.width, image.height - int(foot or 0)))
            image.thumbnail((MOST_PIXELS, 4 * MOST_PIXELS), Image.LANCZOS)
            small = io.BytesIO()
            # This method and one step of k-means keep the colours of thin lines.
            image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE).save(small, "PNG", optimize=True)
    except (OSError, ValueError) as error:
        raise ResultError(path, f"is no picture ({error})", "make it again") from None
    return {"picture": f"data:image/png;base64,{base64.b64encode(small.getvalue()).decode()}", "caption": caption}


# Words of the plain texts and the symbols that replace them on the page; longer ones first. The word joiners around gamma keep |gamma| on one line.
_SYMBOLS = ((r"\*\*([^*]+)\*\*", r"<b>\1</b>"), (r"`(.+?)`", r"<code>\1</code>"), (r"\|gamma\|", "|\u2060gamma\u2060|"),
            (r"(?:(?<![\d.])1|(\d))e(-?)0*(\d+)\b", lambda m: f"{m[1] + '·' if m[1] else ''}10<sup>{'−' if m[2] else ''}{m[3]}</sup>"),
            (r"\bsigma([123])\b", r"σ<sub>\1</sub>"), (r"\bk_([nt])\b", r"k<sub>\1</sub>"), (r"\bN_I\b", "N<sub>I</sub>"),
            (r"\b([PV])0\b", r"\1<sub>0</sub>"), (r"\bdSigma\b", "Δσ"), (r"\bgamma\b", "γ"), (r"\bkappa\b", "κ"), (r"\bmu\b", "μ"),
            (r"\balpha\b", "α"), (r"\bomega\b", "ω"), (r"\bbeta\b", "β"), (r"\^(\d+)", r"<sup>\1</sup>"))


def symbols(text):
    """Return a line of plain text with the field's symbols for their names, powers of ten as such, and what stands between ** in bold letters."""
    return _symbols(escape(text))


def block(text):
    """Return a paragraph, list or table in Markdown as HTML, with the same symbols."""
    return _symbols(markdown.markdown(text, extensions=["tables", "sane_lists"]))


def _symbols(html):
    for pattern, symbol in _SYMBOLS:
        html = re.sub(pattern, symbol, str(html))
    return Markup(html)
