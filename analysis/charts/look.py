"""Colours and markers of the series: MD full lines in cold colours, CD dashed in warm ones; no two share a marker."""

# Okabe and Ito's palette and black, told apart by marker and line as well.
STYLES = {
    "MD step": ("#0072B2", "o"), "MD stiffness": ("#56B4E9", "s"), "MD stiffness, fine step": ("#009E73", "D"), "MD damping": ("#1A1A1A", "*"),
    "MD law avoid_ratcheting": ("#009E73", "<"), "MD law path_independent": ("#1A1A1A", ">"),
    "CD step": ("#E69F00", "^"), "CD accelerated": ("#D55E00", "v"), "CD nsgs": ("#CC79A7", "P"), "CD sweeps": ("#8C564B", "p"), "CD accuracy": ("#000000", "X"),
}
SPARE = (("#7F7F7F", "h"), ("#4B0082", "8"), ("#556B2F", "d"))  # series of solvers that came later
ENVELOPE = {"MD": "#0072B2", "CD": "#D55E00"}


# Of scenes, which are more than a palette holds: as many markers as have no divisor in common with the colours, so that no pair comes twice.
MARKERS = "ov^<>sPDX*hpd"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#1A1A1A")


def colour(number):
    """Of the scene number `number`."""
    return COLOURS[number % len(COLOURS)]


def of(series):
    """Keywords of a series' line."""
    spare = SPARE[sum(map(ord, series)) % len(SPARE)]
    colour, marker = STYLES.get(series, spare)
    return {"color": colour, "marker": marker, "linestyle": "-" if series.startswith("MD") else "--", "markersize": 5}
