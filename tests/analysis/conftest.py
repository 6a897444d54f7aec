"""Result files made up with known answers, so that each number the analysis reads can be checked."""

import io
import json

import h5py
import numpy as np
import pytest

from yade_scripts import parameters, results
from yade_scripts.results import reader, schema, sealed

SIDE = 0.2  # [m] of the made-up square sample
PER_CYCLE = 20  # samples of `cyclic`


def lattice(columns, method, seed=5):
    """A snapshot: disks on a triangular lattice, forces from a spread-out distribution.

    MD and CD get the same contacts, and normal forces that differ by a tenth.
    """
    rng = np.random.default_rng(seed)
    spacing = SIDE / columns
    points = [((i + 0.5 * (j % 2)) * spacing + spacing / 4, (j + 0.5) * spacing * np.sqrt(0.75))
              for j in range(int(columns / np.sqrt(0.75))) for i in range(columns)]
    position = np.array(points) + rng.normal(0, 0.02 * spacing, (len(points), 2))
    offset = position[None] - position[:, None]
    distance = np.linalg.norm(offset, axis=2)
    first, second = np.nonzero(np.triu((distance < 1.3 * spacing) & (distance > 0)))
    keep = rng.random(len(first)) < 0.65
    first, second = first[keep], second[keep]
    normal = offset[first, second] / distance[first, second][:, None]
    force = rng.gamma(1.5, 8.0, len(first))
    if method == "CD":
        force *= np.abs(1 + 0.1 * rng.standard_normal(len(first)))
    friction = np.full(len(first), 0.1)
    share = np.where(np.arange(len(first)) % 10 == 0, 1.0, rng.uniform(-0.9, 0.9, len(first)))
    ids = np.stack([first, second], axis=1) + 6  # YADE's walls are bodies 0 to 5
    wall = np.array([[2, 6]])
    return dict(
        position=position, angle=np.zeros(len(position)), radius=np.full(len(position), spacing / 2),
        body_ids=np.arange(len(position)) + 6, contact_ids=np.concatenate([ids, wall]),
        contact_point=np.concatenate([(position[first] + position[second]) / 2, [[position[0, 0], 0.0]]]),
        contact_normal=np.concatenate([normal, [[0.0, 1.0]]]), contact_friction=np.append(friction, 0.0),
        force_normal=np.append(force, 12.0), force_tangential=np.append(share * friction * force, 0.0),
        box=np.array([0.0, SIDE, 0.0, SIDE]))


def history(method, samples=201, scale=1e-3):
    """One triangular cycle: the stress goes up by a fifth of P0 and back, gamma keeps scale/4.

    Loading: gamma = -scale x^2; unloading: gamma = -scale (1/4 + 3/4 x), with x in [0, 1] the share of the load.
    """
    cycle = np.linspace(0, 1, samples)
    share = 1 - np.abs(1 - 2 * cycle)
    pressure = 1200.0
    gamma = -scale * np.where(cycle <= 0.5, share**2, 0.25 + 0.75 * share)
    columns = {name: np.zeros(samples) for name, field in schema.HISTORY.items() if method in field.methods}
    sigma2 = pressure * (1 + 0.2 * share)
    columns |= dict(time=cycle, cycle=cycle, gamma=gamma, strain2=gamma / 2, strain1=-gamma / 2,
                    sigma1=np.full(samples, pressure), sigma2=sigma2, sigma1_goal=np.full(samples, pressure),
                    sigma2_goal=sigma2 * (1 + 1e-4), dissipated_energy=np.linspace(0, 2e-3, samples))
    if method == "CD":
        columns |= dict(residual=np.full(samples, 1e-7), unconverged_steps=np.arange(samples) // 50)
    return columns


def write(path, method="MD", columns=None, snapshots=None, row=None, **attributes):
    """A result file; by default a finished run of `history` and `lattice`."""
    columns = history(method, scale=1e-3 if method == "MD" else 2e-6) if columns is None else columns
    root = dict(schema_version=schema.SCHEMA_VERSION, scene="biaxial", method=method, state_sha256="ab" * 32,
                parameters=json.dumps(parameters.complete(dict(method=method) | (row or {}))), git_commit="c" * 40,
                yade_version="2023.02a", seed=1, pressure=1200.0, depth=1.0, finished=True, status=schema.STATUS_FINISHED,
                outcome=schema.OUTCOME_COMPLETED) | attributes
    snapshots = {time: lattice(20, method) for time in (0.0, 0.5, 1.0)} if snapshots is None else snapshots
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        file.attrs.update(root)
        for name, values in columns.items():
            file.create_dataset(f"history/{name}", data=values).attrs["unit"] = schema.HISTORY[name].unit
        for number, (time, fields) in enumerate(snapshots.items()):
            group = file.create_group(f"snapshots/{number}")
            group.attrs.update(time=time, cycle=time)
            for name, values in fields.items():
                group.create_dataset(name, data=values).attrs["unit"] = schema.SNAPSHOT[name].unit
    sealed.write(path, content.getvalue())
    return path


def write_row(folder, row, **more):
    """The result file of a row, under its name."""
    full = parameters.complete(row)
    return write(results.path_of(full, folder), full["method"], row=row, **more)


def cyclic(path, rates, first=0.0, **row):
    """A finished MD run whose gamma changes by rates[n] over cycle n; sliding contacts come and go in each cycle."""
    cycle = np.arange(PER_CYCLE * len(rates) + 1) / PER_CYCLE
    gamma = np.interp(cycle, np.arange(len(rates) + 1), np.concatenate([[first], first + np.cumsum(rates)]))
    columns = history("MD", len(cycle)) | dict(
        time=cycle, cycle=cycle, gamma=gamma, strain2=gamma / 2, strain1=-gamma / 2, sigma2=np.full(len(cycle), 1200.0),
        contacts=np.full(len(cycle), 800.0), dissipated_energy=cycle * 1e-3, sliding_contacts=80 * np.sin(np.pi * cycle)**2)
    return reader.load(write(path, columns=columns, row=dict(loading="cosine", cycles=len(rates), records_per_cycle=PER_CYCLE) | row))


@pytest.fixture
def md(tmp_path):
    """The path of a finished MD run."""
    return write_row(tmp_path, {"method": "MD"})


@pytest.fixture
def cd(tmp_path):
    """The path of a finished CD run comparable with `md`."""
    return write_row(tmp_path, {"method": "CD"})
