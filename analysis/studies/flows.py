"""What a mean of a flow costs by springs of any damping, by springs in Contact Dynamics, and by rigid contacts with few sweeps, with 500 disks."""
from analysis import flow_costs
from analysis.flow_costs import (COARSE, COARSER, DEFAULT, FEW, FINE, FINEST, IMPLICIT, KINDS, LIGHT, MD, MIDDLE, PROPOSED, QUANTITY, SMALL,
                                 SPRINGS, STIFF, STRICT, WORDS, draw, rows_of, settings, summarize)

__all__ = ["draw", "summarize"]

TITLE = "What does the mean of a flow cost by each method?"
QUESTION = ("Silo, drum, filling and collapse of 500 disks: MD's springs with two dampings, springs in Contact Dynamics, and rigid contacts solved to"
            " a tolerance or with a given small number of sweeps a step.")
ORDER = 29  # in the report
PART = "engine"
FEWER = [FINE | {"fixed_iterations": sweeps} for sweeps in (2, 5, 10, 20)]
COMPARED = [FINEST, FINE, COARSER, COARSE, *FEWER,
            *(IMPLICIT | {"kn": kn, "beta_n": beta} for kn, beta in ((5e6, 0.2), (2e7, 0.2), (2e7, 0.9))),
            *(LIGHT | {"kn": kn} for kn in (2e6, 5e6, 2e7)), MIDDLE, STIFF]
# What the defaults cost; the error of the step of springs; springs ten times as stiff, beside which the rigid answer is seen.
OTHERS = [COARSE | {"gap_correction": 0.1}, PROPOSED, DEFAULT, IMPLICIT | {"kn": 2e7, "beta_n": 0.2, "cd_dt": 2.5e-4}, LIGHT | {"kn": 2e8}]
SEEDS, PART_OF_THEM = {"hopper": 32, "drum": 16, "filling": 8, "collapse": 16}, 0.25  # numbers of seeds, and the share of them that OTHERS get
# All settings of a seed follow each other, and the scenes keep step, so that a run that is cut short has the same seeds in all settings.
ORDERED = sorted(((seed, scene) for scene in QUANTITY for seed in range(1, SEEDS[scene] + 1)), key=lambda one: (one[0] - 0.5) / SEEDS[one[1]])
ROWS = {"quick": rows_of("filling", SMALL, [FINE, FINE | {"fixed_iterations": 10}, LIGHT | {"kn": 5e6}], 1),
        "full": [row for seed, scene in ORDERED
                 for row in rows_of(scene, SMALL, COMPARED + (OTHERS if seed <= PART_OF_THEM * SEEDS[scene] else []), seed)]
        + [row for scene in QUANTITY for row in rows_of(scene, SMALL, [STRICT], (1, 2))]
        # Where springs of MD do not tend to the rigid answer: do springs in Contact Dynamics tend to theirs as the step falls?
        + [row for scene in ("filling", "collapse")
           for row in rows_of(scene, SMALL, [IMPLICIT | {"kn": 2e7, "beta_n": 0.2, "cd_dt": 5e-5}], range(1, 9))]}


def quantities(table):
    table = flow_costs.measured(table)
    rows = table.to_dict("records")
    counts = {kind: [scene for scene in QUANTITY if flow_costs.reaching(rows, scene, SMALL, kind)] for kind in KINDS}
    best = {kind: {scene: flow_costs.cheapest(rows, scene, SMALL, kind) for scene in QUANTITY} for kind in KINDS}
    gain = flow_costs.gains(rows, SMALL, FEW)
    least = flow_costs.spread(flow_costs.drawn_gains(rows, SMALL, FEW))[0]
    fine, coarser, coarse, proposed, strict = (
        flow_costs.of_setting(table, setting) for setting in (FINE, COARSER, COARSE, PROPOSED, STRICT))
    corrected = flow_costs.of_setting(table, COARSE, 0.1)
    judged = table[~table.is_rigid_answer & table.apply(flow_costs.is_judged, axis=1)]
    springs = table[table.kind == MD].set_index(["setting", "beta_n", "scene"]).sort_index()
    light, damped, stiffest = (springs.loc[kn, beta] for kn, beta in ((2e7, LIGHT["beta_n"]), (2e7, 0.9), (2e8, LIGHT["beta_n"])))
    column = [springs.loc[kn, LIGHT["beta_n"]].error.collapse for kn in (2e6, 5e6, 2e7, 2e8)]
    own = table[table.kind == SPRINGS].set_index(["step", "setting", "beta_n", "scene"]).sort_index()
    implicit, finer = (own.loc[step, 2e7, LIGHT["beta_n"]] for step in (IMPLICIT["cd_dt"], 5e-5))
    few = {sweeps: table[(table.kind == FEW) & (table.setting == sweeps)].set_index("scene") for sweeps in (2, 5, 10, 20)}
    gained = {scene: gain[scene] for scene in counts[FEW] if scene in counts[MD]}
    assert list(gained) == ["hopper", "filling"] and counts[MD] == ["hopper", "drum", "filling"]
    odd = table[(table.scene == "drum") & (table.step == 5e-4) & (table.setting == 1e-4) & (table.at_rest == 1e-4)].squeeze()
    return locals() | {"QUANTITY": QUANTITY, "WORDS": WORDS, "KINDS": KINDS, "settings": settings}
