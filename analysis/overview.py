"""The short answer on top of the report: what of the paper's divergence between the methods is tolerance, stiffness, indeterminacy.

One or two sentences a topic from the rows of one study each, plainer and shorter than the study's own answer.
"""

import re

import numpy as np

from analysis import cycles
from analysis.studies import fig3, indeterminacy, influence, laws, summary

# Headings, and the studies whose sentences stand under each.
TOPICS = (("The figures, repeated", ("fig4", "fig3", "fig5", "influence")), ("What is tolerance", ("tolerance",)),
          ("What is stiffness", ("stiffness", "chain")), ("What is indeterminacy", ("critical_load", "indeterminacy")),
          ("What is the tangential spring", ("closed_path", "laws")))


def headline(name, rows, answer):
    """The sentences of a study; the first one of its answer where it has none of its own, or too few rows for them."""
    try:
        return HEADLINES[name](rows)
    except (KeyError, IndexError, ValueError, ZeroDivisionError):
        return first_sentence(answer)


def lead(name, rows):
    """What the study adds to the answer in one sentence, or '' where its rows do not bear that sentence out."""
    try:
        return LEADS[name](rows)
    except (KeyError, IndexError, ValueError, ZeroDivisionError):
        return ""


# Characters below which a sentence says too little alone, such as "Yes."
SHORT = 60


def first_sentence(text):
    """Up to the first full stop that ends a sentence, or the second where the first says too little."""
    sentences = re.split(r"(?<=\.)\s+(?=[A-Z])", text)
    taken = sentences[0]
    for sentence in sentences[1:]:
        if len(taken) >= SHORT:
            break
        taken += f" {sentence}"
    return taken


def _fig4(rows):
    by = {method: [row["largest |gamma|"] for row in rows if row["method"] == method] for method in ("MD", "CD")}
    packings = len({row["seed"] for row in rows})
    ordered = min(by["MD"]) > max(by["CD"])
    return (f"One load and back ({summary.count(packings, 'packing')}): |gamma| reaches {summary.spread(by['MD'])} with springs and "
            f"{summary.spread(by['CD'])} with rigid contacts" + (", in the order of the paper's Fig. 4." if ordered else ", not always in the order of "
                                                                 "the paper's Fig. 4."))


def _fig3(rows):
    count = {method: {name: sum(row["method"] == method and row["regime"] == name for row in rows)
                      for name in (cycles.SHAKEDOWN, cycles.RATCHETING, cycles.COLLAPSE)} for method in ("MD", "CD")}
    def words(method):
        return ", ".join(f"{name} {number}" for name, number in count[method].items())
    return f"Under repeated loading, runs end as follows. MD: {words('MD')}; CD: {words('CD')}. {fig3.paired(rows)}"


def _fig5(rows):
    slowest = min(row["ramp rate"] for row in rows)
    name = "load at |gamma| = 0.01"
    ratio = summary.finite(summary.paired_ratio([row for row in rows if row["method"] == "CD" and row["ramp rate"] == slowest],
                                                [row for row in rows if row["method"] == "MD" and row["ramp rate"] == slowest],
                                                ("seed", "preparation friction"), name))
    if not len(ratio):
        raise ValueError(name)
    alike = "both yield at nearly the same load" if np.all(np.abs(ratio - 1) < 0.1) else "they do not always yield at the same load"
    drift, rest = ([row["load at |gamma| = 0.0001"] for row in rows if row["method"] == method and row["ramp rate"] == slowest] for method in ("MD", "CD"))
    return (f"Under the ramp MD passes |gamma| = 1e-4 at {summary.spread(drift, 3)} P0 and CD at {summary.spread(rest, 3)} P0, but {alike}: at |gamma| = 0.01 "
            f"CD carries {summary.spread(ratio, 3)} times what MD does.")


def _tolerance(rows):
    solved = sorted((row for row in rows if row["effort"] == "tolerance"), key=lambda row: row["value"])
    best, worst = solved[0], solved[-1]
    if best is worst:
        raise ValueError("one tolerance")
    falling = all(small["largest"] < large["largest"] for small, large in zip(solved, solved[1:]))
    range_of = (f"the largest |gamma| goes from {summary.number(worst['largest'])} at a tolerance of {worst['value']:.0e} to "
                f"{summary.number(best['largest'])} at {best['value']:.0e}")
    if not falling:
        return f"Much of CD's loop below yield: {range_of}, though not downwards at every step."
    return (f"All of CD's loop below yield: {range_of}, and no limit above zero is seen. Solved to the end, rigid grains below yield do not move.")


def _stiffness(rows):
    springs = {row["springs_over_kn"]: row for row in rows if row["medium"] == "MD" and not row["comparison"]}

    def ratios(medium, name):
        return summary.spread(row[f"scaled_{name}"] / springs[row["springs_over_kn"]][f"scaled_{name}"] for row in rows
                              if row["medium"] == medium and not row["comparison"])
    softest, stiffest = springs[min(springs)], springs[max(springs)]
    return (f"CD left with few sweeps a step is an elastic medium. Where its contacts part as springs do, it strains {ratios('CD, parting as springs', 'largest')} "
            f"times as far as MD of that stiffness and keeps {ratios('CD, parting as springs', 'remanent')} times the remanent strain; where they part as rigid "
            f"grains do, {ratios('CD, parting as rigid', 'largest')} and {ratios('CD, parting as rigid', 'remanent')} times: what is left "
            f"of the loop hangs on where contacts part. MD's own largest |gamma| goes from {summary.number(softest['largest'])} at {min(springs):g} k_n to "
            f"{summary.number(stiffest['largest'])} at {max(springs):g} k_n.")


def _critical_load(rows):
    cd = [row for row in rows if row["method"] == "CD"]
    ratio = summary.finite(row["load at 0.0001"] / row["limit load"] for row in cd)
    if not len(ratio):
        raise ValueError("no ramp")
    place = next((row["preparation mu"], row["seed"]) for row in cd if row["network"] > 0)
    same = summary.finite(row["load at 0.0001"] for row in cd if (row["preparation mu"], row["seed"]) == place)
    alike = np.ptp(same) < 0.01 * same.mean()
    return (f"From {summary.count(len(same), 'initial force network')} of one packing CD yields at {summary.spread(same, 4)} P0, and over all packings at "
            f"{summary.spread(ratio, 4)} times the static limit of their geometry and friction: " + (
                "indeterminacy decides which forces are carried below the limit, and not where the packing breaks." if alike else
                "the initial network matters."))


def _chain(rows):
    elastic = [row for row in rows if "swing_period_measured" in row]
    off = max(abs(row["swing_period_measured"] / row["swing_period_theory"] - 1) for row in elastic)
    return (f"The known proof of that elasticity, a row of 50 rigid disks: with {min(row['sweeps'] for row in elastic)} to "
            f"{max(row['sweeps'] for row in elastic)} sweeps a step it swings like a rod of that stiffness, its period within {100 * off:.1f} % of theory.")


def _closed_path(rows):
    most = {law: [max(abs(row[name]) for row in rows if row["law"] == law) for name in ("left_force", "loop_work")]
            for law in ("standard", "avoid_ratcheting", "path_independent")}
    return (f"A closed path of two grains leaves up to {most['standard'][0]:.2g} of the shear force under the standard law; YADE's avoidGranularRatcheting "
            f"mends the force ({most['avoid_ratcheting'][0]:.0e}) and leaves up to {most['avoid_ratcheting'][1]:.2g} of the energy; the law with alpha in forces and arms "
            f"leaves neither ({most['path_independent'][0]:.0e} and {most['path_independent'][1]:.0e}).")


def _indeterminacy(rows):
    mu, eta = indeterminacy.medians(rows, indeterminacy.OWN, "eta")
    top = int(np.argmax(eta))
    inside = np.median([row["springs within range"] for row in rows if row["packing"] == indeterminacy.OWN and row["mu"] > 0])
    return (f"Near the rigid limit the forces that a packing admits scatter by {summary.number(eta[top])} of the mean force where they do most, at mu = {mu[top]:g} "
            f"(published: near 0.1), and by {summary.number(eta[0])} at mu = {mu[0]:g}; the springs' own forces lie within the range met at "
            f"{100 * inside:.0f} % of the contacts (median).")


def _laws(rows):
    strain = summary.finite(row["strain over standard"] for row in rows if row["law"] == "path_independent" and "strain over standard" in row)
    if not len(strain):
        raise ValueError("laws missing")
    return f"Under the path-independent law samples strain {summary.spread(strain, 3)} times as far as under the standard one. {laws.steady(rows)}"


def _influence(rows):
    return f"{influence.strongest(rows, 1)} {influence.verdict(rows)}"


HEADLINES = {"fig4": _fig4, "fig3": _fig3, "fig5": _fig5, "influence": _influence, "tolerance": _tolerance, "stiffness": _stiffness,
             "critical_load": _critical_load, "indeterminacy": _indeterminacy, "chain": _chain, "closed_path": _closed_path,
             "laws": _laws}


def _md_strain_is_the_springs(rows):
    springs = [(row["springs_over_kn"], row["largest"]) for row in rows if row["medium"] == "MD" and not row["comparison"]]
    if len(springs) < 2:
        return ""
    stiffness, strain = np.array(springs).T
    slope = np.polyfit(np.log(stiffness), np.log(strain), 1)[0]
    # Elastic strain goes with 1/k_n; a tenth off that power still leaves a fifth of the strain per decade to something else.
    return (f"Dense packings far below yield (0.2 P0): MD strains because its contacts are springs, |gamma| goes as k_n to the power {slope:.2f}."
            if abs(slope + 1) < 0.1 else "")


def _cd_strain_is_the_tolerance(rows):
    solved = sorted((row for row in rows if row["effort"] == "tolerance"), key=lambda row: row["value"])
    falling = len(solved) > 1 and all(small["largest"] < large["largest"] for small, large in zip(solved, solved[1:]))
    return (f"CD strains there because its equations are left unsolved by the tolerance: solved further it strains less, down to {solved[0]['largest']:.0e} "
            f"at the smallest tolerance tried, {solved[0]['value']:.0e}." if falling else "")


def _strength_is_alike(rows):
    slowest = min(row["ramp rate"] for row in rows)
    by = {method: [row for row in rows if row["method"] == method and row["ramp rate"] == slowest] for method in ("MD", "CD")}
    ratio = {name: summary.finite(summary.paired_ratio(by["CD"], by["MD"], ("seed", "preparation friction"), name))
             for name in ("load at |gamma| = 0.01", "largest load")}
    alike = all(len(values) and np.all(np.abs(values - 1) < 0.2) for values in ratio.values())
    return (f"Where packings break the methods agree within a fifth: CD carries {summary.spread(ratio['load at |gamma| = 0.01'], 3)} times MD's load at "
            f"|gamma| = 0.01, and {summary.spread(ratio['largest load'], 3)} times before collapse." if alike else "")


def _network_is_no_cause(rows):
    cd = [row for row in rows if row["method"] == "CD"]
    places = summary.groups([row for row in cd if np.isfinite(row["load at 0.0001"])], lambda row: (row["preparation mu"], row["seed"]))
    ensembles = [[row["load at 0.0001"] for row in same] for same in places.values() if any(row["network"] > 0 for row in same)]
    alike = ensembles and all(np.ptp(loads) < 0.01 * np.mean(loads) for loads in ensembles)
    return "That the forces of rigid grains are indeterminate does not decide at which load the packing yields." if alike else ""


def _ratcheting_is_of_the_springs(rows):
    name = f"regime after {fig3.COMPARED}"
    pairs = summary.pairs(rows, ("preparation friction", "dSigma", "seed"))
    md, cd = (sum(pair[which][name] == cycles.RATCHETING for pair in pairs) for which in (0, 1))
    return (f"Under repeated loading MD ratchets in {md} of {len(pairs)} cases and CD in {cd}: ratcheting is the springs', not the rigid grains'."
            if md > 2 * cd else "")


LEADS = {"stiffness": _md_strain_is_the_springs, "tolerance": _cd_strain_is_the_tolerance, "fig3": _ratcheting_is_of_the_springs,
         "fig5": _strength_is_alike, "critical_load": _network_is_no_cause}
