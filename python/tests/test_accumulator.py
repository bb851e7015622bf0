"""Sums that workers fill apart, against one process and against `train --basic`."""

import json
import pickle
import random

import numpy as np
import pytest

import residyn
import simulated_fleet


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Five recordings of one robot."""
    folder = tmp_path_factory.mktemp("one-robot")
    simulated_fleet.make(folder, robots=1, recordings=5, seconds=6.0, seed=7)
    return sorted(folder.rglob("*.parquet"))


def numbers(found):
    return np.array([[p.value, p.std] for p in found.parameters])


def same(found, other):
    """Whether values and deviations agree to 1e-9 of the value's or the deviation's size."""
    a, b = numbers(found), numbers(other)
    size = np.abs(a).max(axis=1, keepdims=True)
    return found.joints == other.joints and np.all(np.abs(a - b) <= 1e-9 * size)


def test_any_tree_of_merges_is_one_process(recordings):
    one = residyn.Accumulator("ur5", cutoff_hz=8)
    for path in recordings:
        one.add(path)
    assert one.recordings == 5 and one.samples == 5 * 600
    whole = one.finish()
    assert whole.rank == len(whole.parameters) and len(whole.parameters) > 50
    rng = random.Random(1)
    for _ in range(3):
        # Each travels as it would to another machine, and two at a time are joined, whichever.
        parts = [residyn.Accumulator("ur5", cutoff_hz=8).add(path) for path in recordings]
        while len(parts) > 1:
            rng.shuffle(parts)
            a, b = parts.pop(), parts.pop()
            parts.append(pickle.loads(pickle.dumps(a)).merge(pickle.loads(pickle.dumps(b))))
        assert parts[0].recordings == 5 and same(parts[0].finish(), whole)
    # The comparison can tell: one recording less is no longer the same.
    assert not same(residyn.Accumulator("ur5", cutoff_hz=8).add(recordings[0]).finish(), whole)


def test_it_identifies_what_train_does(recordings, tmp_path):
    total = residyn.Accumulator("ur5", cutoff_hz=8)
    for path in recordings:
        total.add(path)
    residyn.identify("ur5", recordings, tmp_path / "m", basic=True, cutoff_hz=8)
    stored = json.loads((tmp_path / "m" / "model.json").read_text())
    found = total.finish()
    for theirs in stored["base_parameters"]:
        ours = found[theirs["name"]]
        assert ours.formula == theirs["formula"] and ours.unit == theirs["unit"]
        assert abs(ours.value - theirs["value"]) < 1e-3 * theirs["std"], theirs["name"]
        # Stretches are cut otherwise, so deviations differ a little.
        assert 0.5 < ours.std / theirs["std"] < 2.0, theirs["name"]


def test_parameters_lie_within_their_deviations(recordings):
    total = residyn.Accumulator("ur5", cutoff_hz=20)
    for path in recordings:
        total.add(path)
    found = total.finish()
    rng = np.random.default_rng([7, 0])
    rng.normal(size=len(residyn.Robot("ur5").parameters))
    friction = simulated_fleet.FRICTION * (1 + simulated_fleet.SPREAD * rng.normal(size=simulated_fleet.FRICTION.shape))
    for row, label in enumerate(("viscous", "coulomb")):
        for joint, truth in zip(found.joints, friction[row]):
            p = found[f"{label} {joint}"]
            assert abs(p.value - truth) < 4 * p.std + 0.02 * truth, p


def test_the_first_recording_decides_and_workers_are_given_it(recordings):
    first = residyn.Accumulator("ur5")
    assert first.preparation is None
    first.add(recordings[0])
    cutoff_hz, position_alone = first.preparation
    assert cutoff_hz > 0 and position_alone in (False, True)
    worker = pickle.loads(pickle.dumps(first.emptied()))
    assert worker.recordings == 0 and worker.preparation == first.preparation
    first.merge(worker.add(recordings[1]))
    assert first.recordings == 2
    other = residyn.Accumulator("ur5", cutoff_hz=cutoff_hz / 2).add(recordings[1])
    with pytest.raises(residyn.InputError, match="same cutoff_hz"):
        first.merge(other)


def test_what_does_not_belong_together_is_refused(recordings, tmp_path):
    total = residyn.Accumulator("ur5", cutoff_hz=8).add(recordings[0])
    before = total.finish()
    with pytest.raises(residyn.InputError, match="another robot"):
        total.merge(residyn.Accumulator(residyn.Robot("ur5", gravity=(0.0, 0.0, 9.81)), cutoff_hz=8))
    with pytest.raises(residyn.InputError, match="itself"):
        total.merge(total)
    read = residyn.Recording.read(recordings[1])
    with pytest.raises(residyn.InputError, match="tau"):
        total.add(residyn.Recording(read.time, read.q))
    with pytest.raises(residyn.InputError, match="missing.csv"):
        total.add(tmp_path / "missing.csv")
    with pytest.raises(residyn.InputError):
        residyn.Accumulator("kr300", cutoff_hz=8).add(residyn.Recording(read.time, read.q[:, :3], read.tau[:, :3]))
    assert total.recordings == 1 and same(total.finish(), before)
    # Arrays are as good as files.
    arrays = residyn.Accumulator("ur5", cutoff_hz=8).add(residyn.Recording(read.time, read.q, read.tau))
    assert same(arrays.finish(), residyn.Accumulator("ur5", cutoff_hz=8).add(recordings[1]).finish())
    with pytest.raises(residyn.InputError, match="no joint moves"):
        residyn.Accumulator("ur5", cutoff_hz=8).finish()


def test_broken_bytes_are_refused(recordings):
    robot = residyn.Robot("ur5")
    stored = residyn.Accumulator(robot, cutoff_hz=8).add(recordings[0])._inner.to_bytes()
    restore = residyn._residyn.Sums.from_bytes
    assert restore(robot, stored).to_bytes() == stored
    line = stored.index(b"\n") + 1
    for wrong in (b"", b"{}\n", stored[:line], stored[:-1], stored[:-8], stored + b"\0" * 8, stored.replace(b"sums/1", b"sums/9")):
        with pytest.raises(residyn.InputError, match="no stored sums"):
            restore(robot, wrong)
    nan = stored[:line] + b"\xff" * (len(stored) - line)
    with pytest.raises(residyn.InputError, match="no stored sums"):
        restore(robot, nan)
