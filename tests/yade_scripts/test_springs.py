"""The longest step for springs: the limit from their matrices against cases solved by hand."""
import pytest

from yade_scripts.theory import spring_limits


def test_limit_of_two_free_disks_and_of_a_held_one(yade_elsewhere):
    """Two equal disks on each other: the pair swings along the normal with w^2 = 2 k_n/m and turns with w^2 = k_t (2/m + 2 R^2/I) = 6 k_t/m
    (I = m R^2/2). With the lower one fixed and the upper one free to move along the normal and to turn: md_contact's limit."""
    pair, held, law = yade_elsewhere.code("""
import math
from yade import O
from yade_scripts import parameters
from cd_engine import springs
from yade_scripts.running import bodies, hooks, md
from yade_scripts.theory import spring_limits
found = []
full = parameters.complete({"friction": 0.5, "beta_n": 0.3, "kt_over_kn": 0.25})
R, k = full["radius_mean"], parameters.stiffness(full)
m = bodies.disk_mass(R, full)
for below, above in (("zXY", "zXY"), ("xyzXYZ", "xzXY")):
    O.reset()
    bodies.append_material("disk", full["friction"], full)
    bodies.append_disk((0, 0), R, m, "disk", blocked=below)
    bodies.append_disk((0, 2 * R * (1 - 1e-9)), R, m, "disk", blocked=above)
    O.engines = md.contact_engines(full) + [md.integrator(full)]
    O.dt = 1e-12
    hooks.simulate(1)
    found.append(springs.limit() * math.sqrt(k / m))
print(json.dumps(found + [spring_limits.contact_limit(0.3, 0.25)]))
""")
    # The dashpot of the pair has 2 beta sqrt(k m/2), so its mode has the damping ratio beta.
    expected = min(spring_limits.oscillator_limit(0.3) / 2**0.5, 2 / (6 * 0.25)**0.5)
    assert pair == pytest.approx(expected, rel=2e-4) and held == pytest.approx(law, rel=2e-4)  # what the search for the limit resolves


def test_a_light_wall_counts(yade60):
    """A wall of a tenth of a disk's mass on ten contacts asks for a shorter step than any disk."""
    heavy, light = yade60.code("""
from yade import O
from yade_scripts import parameters
from yade_scripts.preparing import prepare
from cd_engine import springs
from yade_scripts.running import bodies, walls
found = []
for ratio in (20, 0.05):
    O.load(str(prepare.ensure(parameters.complete({"disks": 60}), "results")[0]))
    walls.set_free(ratio * bodies.mean_mass())
    found.append(springs.limit())
print(json.dumps(found))
""")
    assert light < 0.5 * heavy
