"""Fits and counts of the study of ratcheting, from tables and snapshots whose answers are known."""
import numpy as np
import pandas
import pytest

from analysis.studies import ratcheting


def springs(power, noise=0.0):
    """Rows whose rate is k_n^power exp(5 load), of six seeds; stiffer packings are nearer to their limits. noise: of each seed, in log."""
    random = np.random.default_rng(1)
    shift = noise * random.standard_normal(6)
    rows = [(stiffer, seed, 0.8 + 0.01 * seed + 0.04 * np.log10(stiffer), shift[seed] * np.log(stiffer)) for stiffer in (1, 10, 100)
            for seed in range(6)]
    return pandas.DataFrame([{"k_n over the usual": stiffer, "seed": seed, "load over limit": load, "rate": stiffer**power * np.exp(5 * load + own)}
                             for stiffer, seed, load, own in rows])


def test_the_power_of_the_stiffness_is_told_from_that_of_the_load():
    found, error, slope = ratcheting.power(springs(-1.0), "rate")
    # Round-off of a least-squares fit.
    assert found == pytest.approx(-1, abs=1e-10) and error == pytest.approx(0, abs=1e-10) and slope == pytest.approx(5)


def test_seeds_that_differ_in_their_power_give_its_standard_error():
    """With a power of its own for each seed the error is near that of the mean of six; by how much, the load's fit decides."""
    found, error, _ = ratcheting.power(springs(-1.0, 0.3), "rate")
    expected = 0.3 * np.random.default_rng(1).standard_normal(6).std(ddof=1) / np.sqrt(6)
    assert 0.5 * expected < error < 2 * expected and abs(found + 1) < 4 * error


def test_contacts_that_open_or_close_or_lose_their_force_have_changed():
    def snapshot(**forces):
        return dict(contact_ids=np.array([list(map(int, pair.strip("c").split("_"))) for pair in forces]),
                    force_normal=np.array(list(forces.values())))

    first = snapshot(c1_2=1.0, c2_3=2.0, c3_4=0.5, c4_5=0.0)
    assert ratcheting.changed(first, first) == 0
    assert ratcheting.changed(first, snapshot(c2_1=7.0, c2_3=0.0, c3_4=0.1, c6_7=1.0)) == pytest.approx(2 / 3)
