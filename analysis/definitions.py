"""What each measured number means: name, equation, words, and the function that computes it. The report prints this list.

Equations are HTML; numbers in brackets are those of the paper's equations.
"""
from collections import namedtuple

from yade_scripts.results import schema


Definition = namedtuple("Definition", "name equation words code")
DEFINITIONS = (
    Definition("Stress", "σ<sub>1</sub> = F<sub>x</sub>/(L<sub>y</sub> depth), σ<sub>2</sub> = F<sub>y</sub>/(L<sub>x</sub> depth)",
               "Contact forces on opposite walls, their mean; compression positive.", "yade_scripts/running/walls.py"),
    Definition("Load", "σ<sub>1</sub> = P<sub>0</sub>; σ<sub>2</sub> = P<sub>0</sub>[1 + ½Δσ(1 − cos 2πt/t<sub>0</sub>)] (7), "
               "P<sub>0</sub>(1 + αt) (1), or linear up and down", "Δσ is delta_sigma, α ramp_rate.", "yade_scripts/running/loading.py"),
    Definition("Springs", "R = k<sub>n</sub>δ<sub>n</sub> − 2β√(k<sub>n</sub>m<sub>eff</sub>) δ̇<sub>n</sub> (5), "
               "|T| = min(k<sub>t</sub>|δ<sub>t</sub>|, μR) (6)", "Unlike the paper's (6) without a tangential dashpot; the normal force is not cut off where "
               "the dashpot pulls. Damping works on the normal motion only.", "yade_scripts/running/md.py"),
    Definition("Strain", "ε<sub>1</sub> = L<sub>x</sub>/L<sub>x0</sub> − 1, ε<sub>2</sub> = L<sub>y</sub>/L<sub>y0</sub> − 1",
               "Between the walls; extension positive. The paper's (2) and (3) lack the −1, which its γ does not notice.", "yade_scripts/results/schema.py"),
    Definition("γ", "γ = ε<sub>2</sub> − ε<sub>1</sub> (4)", "Negative when the sample shortens along the loaded axis.", "yade_scripts/results/schema.py"),
    Definition("Permanent strain", "γ<sub>n</sub> = γ(n t<sub>0</sub>)",
               "At the end of cycle n, where the load is back at P<sub>0</sub>. The remanent strain of one cycle is γ<sub>1</sub> − γ<sub>0</sub>.",
               "analysis/cycles.py, observables.permanent_strain"),
    Definition("Strain rate per cycle", "Δγ<sub>n</sub> = γ<sub>n</sub> − γ<sub>n−1</sub>", "Curves show means over windows of cycles.", "analysis/cycles.py"),
    Definition("Contact at Coulomb's limit", f"|T| ≥ μR(1 − {schema.SLIDING_MARGIN:g}), R &gt; 0, μ &gt; 0",
               "Section 2.2; the margin is above rounding. Such a contact need not slip. Walls without friction never count.", "yade_scripts/results/schema.py, is_sliding"),
    Definition("Bound on sliding contacts", "2M − 3N − 2",
               "Unknown forces less equations: M contacts (one unknown where there is no friction), N disks without rattlers, two free walls "
               "(McNamara and Herrmann 2004). At more, the sample moves.", "yade_scripts/theory/statics.py, degrees_of_freedom"),
    Definition("Coordination number", "Z = (2M<sub>disks</sub> + M<sub>walls</sub>)/N", "Loaded contacts on disks that are no rattlers. Curves through "
               "the cycles show 2M/N with all disks and contacts instead.", "observables.coordination"),
    Definition("Dissipated energy", "D = Σ over contacts and steps",
               "By friction, dashpots (MD) and impacts (CD). In units of P<sub>0</sub>V<sub>0</sub>, V<sub>0</sub> the sample's volume at the start.", "yade_scripts/running/recorder.py"),
    Definition("Error of the energy balance", "(W − ΔE<sub>stored</sub> − ΔE<sub>kinetic</sub> − D)/max|W|",
               "W: work of the walls. D is summed where it happens, contact by contact and step by step: by the engine in CD, friction and dashpots in MD.", "observables.balance_error"),
    Definition("Critical load", "σ<sub>2</sub>/P<sub>0</sub> at which |γ| passes a threshold", "Always given with the threshold.",
               "observables.critical_load"),
    Definition("Slip", "s = Δu<sub>t</sub> − Δδ<sub>t</sub>", "What the surfaces of two disks move past each other from snapshot to snapshot, less what "
               "the springs stretch. Added up over a cycle, times μR, it is the work of friction.", "analysis/slip.py"),
    Definition("Late rate", "(γ<sub>n</sub> − γ<sub>n/2</sub>)/(n/2)", "Mean change of γ a cycle over the last half of the cycles.", "cycles.late_rate"),
)
