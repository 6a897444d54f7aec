"""The engine of the path-independent springs: what it refuses, and what it is to YADE."""
import pytest

from . import plane
from .test_path_independent_shear import R1, R2, box_of_disks, engines, pair


class TestRefusals:
    """Each by its reason; the message names the remedy."""

    def refused(self, O, words):
        with pytest.raises(RuntimeError, match=words):
            O.step()

    def test_without_interaction_loop(self, O):
        pair(O, 1e-3)
        engines(O)
        O.engines = [e for e in O.engines if type(e).__name__ != "InteractionLoop"]
        self.refused(O, "no InteractionLoop before it.*right behind InteractionLoop")

    def test_dead_interaction_loop(self, O):
        pair(O, 1e-3)
        engines(O)
        O.engines[2].dead = True
        self.refused(O, "no InteractionLoop before it")

    def test_behind_the_integrator(self, O):
        pair(O, 1e-3)
        engines(O)
        O.engines = O.engines[:3] + O.engines[4:] + [O.engines[3]]
        self.refused(O, "NewtonIntegrator before it")

    def test_two_of_them(self, O):
        import cd_engine
        pair(O, 1e-3)
        engines(O)
        O.engines = O.engines[:4] + [cd_engine.PathIndependentShear()] + O.engines[4:]
        self.refused(O, "another one before it")

    def test_springs_of_another_kind(self, O):
        from yade import wrapper as w
        pair(O, 1e-3)
        engines(O)
        loop = w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_MindlinPhys()], [w.Law2_ScGeom_MindlinPhys_Mindlin()])
        O.engines = O.engines[:2] + [loop] + O.engines[3:]
        self.refused(O, "#0 and #1 has ScGeom and MindlinPhys")

    def test_disks_at_different_heights(self, O):
        pair(O, 1e-3)
        O.bodies[1].state.pos = (R1 + R2 - 1e-3, 0, 1e-4)
        engines(O)
        self.refused(O, "out of the plane")

    def test_turning_out_of_the_plane(self, O):
        pair(O, 1e-3)
        O.bodies[1].state.angVel = (1, 0, 0)
        engines(O)
        self.refused(O, "#1 turns out of the plane")

    def test_periodic_scene(self, O):
        O.periodic = True
        pair(O, 1e-3)
        engines(O)
        self.refused(O, "periodic")


class TestRegistration:
    """An engine of YADE's like any other."""

    def test_class_attributes_and_documentation(self, O):
        import cd_engine
        from yade import wrapper
        cls = cd_engine.PathIndependentShear
        assert cls is wrapper.PathIndependentShear and issubclass(cls, wrapper.GlobalEngine)
        assert "McNamara" in cls.__doc__
        assert set(cls().dict()) >= {"contacts", "slidingContacts", "label", "dead"}
        for name in ("contacts", "slidingContacts", "_pairIds", "_pairNormals", "_pairForces", "_lastStep"):
            assert ":ydefault:`" in getattr(cls, name).__doc__

    def test_results_cannot_be_set_and_unknown_names_are_refused(self, O):
        import cd_engine
        with pytest.raises(AttributeError, match="PathIndependentShear.contacts is a result"):
            cd_engine.PathIndependentShear(contacts=1)
        with pytest.raises(AttributeError, match="stifness"):
            cd_engine.PathIndependentShear(stifness=1)
        with pytest.raises(TypeError, match="keyword"):
            cd_engine.PathIndependentShear(1)

    @pytest.mark.parametrize("ending", [".xml", ".xml.gz", ".yade", ".yade.gz"])
    def test_saving_keeps_every_attribute(self, O, tmp_path, ending):
        box_of_disks(O, 9.81)
        engine = engines(O, dt=5e-5, gravity=9.81)
        O.run(50, True)
        before = plane.everything_in(engine)
        assert before["_pairForces"] and before["label"] == "shear"
        O.save(str(tmp_path / ("scene" + ending)))
        O.reset()
        O.load(str(tmp_path / ("scene" + ending)))
        assert plane.everything_in(O.engines[3]) == before
