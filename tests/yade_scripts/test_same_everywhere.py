"""Every scene has the same bits in all processes, repeats, instruction sets and releases of Debian and, by CD, with any number of threads.

MD's sums of forces depend on the number of threads, so its runs use one.
"""
import json
import pathlib

import pytest

import cd_engine
from cd_engine import core
from yade_scripts import scenes

from .conftest import SCRIPTS, Yade

WITHOUT_AVX512 = dict(GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD", OPENBLAS_CORETYPE="Haswell",
                      NPY_DISABLE_CPU_FEATURES="AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL")
STORED = pathlib.Path(__file__).with_name("digests.json")  # the first 16 digits of each
PROGRAM = SCRIPTS.parent / "tests" / "yade_scripts" / "digests.py"


@pytest.fixture(scope="module")
def digests(yade60):
    """A function that runs all scenes in a process of its own: what digests.py prints."""
    def run(threads, *options, **environment):
        # Waiting threads should sleep: on a busy machine spinning ones take a hundred times as long.
        return Yade(yade60.folder, forks=False).printed(PROGRAM, f"-j{threads}", *options, OMP_WAIT_POLICY="passive", **environment)
    return run


@pytest.fixture(scope="module")
def reference(digests):
    """By one thread and the fastest instruction set."""
    return digests(1, "MD,CD")


def test_same_bits_as_stored(reference):
    """On every release the same, but for what tests/releases.md explains: digests.json holds all, and a version's own where they differ. A scene
    that is not in it, as one of a user's own, is not compared.

    A change that is meant to change bits writes them anew: `yade -n -x -j1 tests/yade_scripts/digests.py MD,CD`, on each release.
    """
    if reference["yade"] not in cd_engine.TESTED:
        pytest.skip(f"nothing is known of the bits of YADE {reference['yade']}")
    stored = json.loads(STORED.read_text())
    expected = stored["all"] | stored.get(reference["yade"], {})
    found = {name: digest[:16] for name, (digest, _) in reference["digests"].items()}
    assert {name: found.get(name) for name in expected} == expected


def differing(found, reference):
    """Names of the scenes whose digests are others."""
    return [name for name, digest in found["digests"].items() if digest != reference["digests"][name]]


def test_every_scene_and_method_is_compared(reference):
    """No two scenes have the same digest, as empty ones would. Nor have two solvers: they differ within the tolerance."""
    wanted = {f"{scene} {method}" for scene in scenes.names() for method in scenes.module(scene).METHODS}
    found = reference["digests"]
    assert wanted <= set(found) and reference["threads"] == 1
    assert len({found[name][0] for name in wanted}) == len(wanted)
    by_solver = {name: digest for name, (digest, _) in found.items() if " by " in name}
    assert len(set(by_solver.values())) == len(by_solver) == len(core.methods())


def instruction_set(reference, number):
    """The name of one that is not what all tests use, as far as this processor has others."""
    return reference["instruction_sets"][min(number, len(reference["instruction_sets"]) - 1)]


def test_same_bits_in_another_process_after_other_scenes_by_less_of_the_processor(digests, reference):
    """The scenes run in the opposite order: earlier scenes must leave no trace. They run by four contacts at once instead of eight: the lanes are
    independent and no product is fused with a sum, so not even round-off differs.

    The whole process is made to run as on a processor that has no AVX-512: C library, numpy and BLAS choose their code, too. One without FMA
    (built before 2013) is another matter: glibc's sin, tan and pow then differ in the last bit, and so do the masses of some disks.
    """
    name = instruction_set(reference, 1)
    found = digests(1, "MD,CD", "backwards", name, **WITHOUT_AVX512)
    assert found["instruction_set"] == name
    assert differing(found, reference) == []


def test_same_bits_by_two_threads_and_two_contacts_at_once(digests, reference):
    """tests/plugin/test_threads.py has more threads, with eight contacts at once."""
    name = instruction_set(reference, 2)
    found = digests(2, "CD", name)
    assert found["threads"] == 2 and found["instruction_set"] == name
    assert differing(found, reference) == []
