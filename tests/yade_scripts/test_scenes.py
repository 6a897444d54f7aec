"""The small scenes by both methods: what is known exactly about them, and the energies the recorder computes."""
import math

import numpy as np
import pytest

from yade_scripts.results import schema

# The disk of slide_to_roll, 2600 kg/m^3, R = 0.01 m, 1 m deep, at 1 m/s.
MASS = 2600 * math.pi * 0.01**2


@pytest.mark.parametrize("method, tolerance", [("CD", 1e-9), ("MD", 2e-3)])
def test_sliding_into_rolling_dissipates_a_third_of_the_energy(yade60, method, tolerance):
    """m v0^2/6, from 2/3 v0 at the end. MD's slips are summed at speeds of half a step to a step and a half before, while the slip ends within 0.34
    s: each step is 4e-4 of the work. The tangential spring swings on undamped and keeps 1e-4."""
    with yade60.run(disks=1, scene="slide_to_roll", method=method) as file:
        history = file["history"]
        assert history["kinetic_energy"][0] == pytest.approx(MASS / 2, rel=1e-9)
        assert history["dissipated_energy"][-1] == pytest.approx(MASS / 6, rel=tolerance)
        assert np.isnan(history["gamma"][:]).all() and schema.problems(file) == []


@pytest.mark.parametrize("method, scene, row, quantity, tolerance", [
    ("CD", "incline", {"slope": -35}, "acceleration", 1e-11),
    ("MD", "incline", {}, "acceleration", 2e-3),             # the block starts with its tangential spring at rest and swings once
    ("MD", "incline", {"slope": 16}, "acceleration", 2e-3),
    # 7e-4 from the step (first order; 1e-2 at the default 0.2); at 1 m/s the overlap of 6 % of the radius would add 3e-3.
    ("MD", "bounce", {"md_dt_factor": 0.01, "speed": 0.01}, "restitution", 1e-3),
    ("CD", "stack", {"disks": 20}, "worst_force_error", 1e-8),
    ("MD", "stack", {"disks": 20}, "worst_force_error", 1e-8),
    ("CD", "loaded_box", {"disks": 25}, "worst_stress_error", 1e-8),
    ("MD", "loaded_box", {"disks": 25}, "worst_stress_error", 1e-8),
    ("MD", "loaded_box", {"disks": 25, "md_walls": "force"}, "worst_stress_error", 1e-8)])
def test_known_quantity(yade60, method, scene, row, quantity, tolerance):
    with yade60.run(**{"disks": 1} | row, scene=scene, method=method) as file:
        found = file[f"known/{quantity}"]
        assert found[()] == pytest.approx(found.attrs["exact"], abs=tolerance)


def test_a_scene_of_rigid_contacts_warns_of_nothing(yade60):
    done = yade60.script("run.py", "scene=incline", "method=CD")
    assert done.returncode == 0 and "ContactDynamics:" not in done.stdout + done.stderr


def test_incline_is_not_at_rest_everywhere(yade60):
    """The exact values themselves: a slope beyond the friction angle must give g (sin t - mu cos t), downhill."""
    with yade60.run(disks=1, scene="incline", slope=-35) as file:
        t = math.radians(35)
        assert file["known/acceleration"].attrs["exact"] == pytest.approx(-9.81 * (math.sin(t) - 0.3 * math.cos(t)), rel=1e-14)
