"""A fleet on a local Ray cluster of two nodes, one of which is killed in the middle."""

import json
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import residyn
import simulated_fleet

ray = pytest.importorskip("ray", reason="PyPI ray is not installed: fleets are not tested")
pytest.importorskip("pyarrow", reason="PyPI pyarrow is not installed: fleets are not tested")

from ray.cluster_utils import Cluster  # noqa: E402

from residyn import fleet  # noqa: E402
from residyn.fleet import work  # noqa: E402
from residyn.fleet.tables import robust_z  # noqa: E402

ROBOTS, RECORDINGS, SECONDS = 6, 4, 5.0


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A folder for each robot."""
    folder = tmp_path_factory.mktemp("recorded")
    simulated_fleet.make(folder, ROBOTS, RECORDINGS, SECONDS, seed=3)
    return folder


def still_alive(within=60):
    """Nodes alive; Ray takes its time to notice that one is not."""
    until = time.monotonic() + within
    while (alive := sum(node["Alive"] for node in ray.nodes())) > 1 and time.monotonic() < until:
        time.sleep(0.2)
    return alive


@pytest.fixture(scope="module")
def survived(recorded, tmp_path_factory):
    """The fleet as it came out of a cluster that lost a node, with how many parts were there when that happened."""
    out = tmp_path_factory.mktemp("fleet")
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    lost = cluster.add_node(num_cpus=1)
    at = []

    def kill():
        while len(list(out.glob("parts/*.pickle"))) < 3:
            time.sleep(0.02)
        at.append(len(list(out.glob("parts/*.pickle"))))
        cluster.remove_node(lost, allow_graceful=False)

    killer = threading.Thread(target=kill)
    try:
        ray.init(address=cluster.address, log_to_driver=False)
        cluster.wait_for_nodes()
        killer.start()
        found = fleet.run(fleet.in_folder(recorded, "ur5"), out)
        killer.join()
        yield found, at[0], still_alive()
    finally:
        ray.shutdown()
        cluster.shutdown()


def values(rows):
    return np.array([[row["value"], row["std"]] for row in rows])


def test_with_a_node_lost_it_is_one_process(recorded, survived):
    found, at, alive = survived
    assert at < ROBOTS * RECORDINGS and alive == 1, "the node was not lost in the middle"
    worst, count = simulated_fleet.apart(recorded, found.folder)
    assert worst <= 1e-9 and count == len(found.table("parameters")) > 50 * ROBOTS
    assert all(row["recordings"] == RECORDINGS and row["problem"] is None for row in found.table("robots"))


def test_the_worn_elbow_stands_out(survived):
    found, _, _ = survived
    worn = {simulated_fleet.name(n) for n in range(ROBOTS) if simulated_fleet.worn(n)}
    assert len(worn) == 1
    marked = [(row["robot"], row["parameter"]) for row in found.outliers()]
    assert (*worn, "coulomb elbow_joint") in marked and (*worn, "viscous elbow_joint") in marked
    over_time = [r for r in found.table("over_time") if r["robot"] in worn and r["parameter"] == "coulomb elbow_joint"]
    assert [r["place"] for r in over_time] == list(range(RECORDINGS))
    usual = simulated_fleet.FRICTION[1, simulated_fleet.ELBOW]
    assert all(r["value"] > 1.3 * usual for r in over_time)
    page = found.page.read_text()
    assert next(iter(worn)) in page and "<svg" in page and "coulomb elbow_joint" in page


def test_it_goes_on_where_it_stopped(recorded, survived, tmp_path, monkeypatch):
    found, _, _ = survived
    monkeypatch.chdir(recorded.parent)
    before = values(found.table("parameters"))
    parts = sorted(found.folder.glob("parts/*.pickle"))
    assert len(parts) == ROBOTS * RECORDINGS
    parts[0].unlink()
    broken = recorded / simulated_fleet.name(0) / "999.csv"
    broken.write_text("time,q1,tau1\n0,1,2\n")
    try:
        again = fleet.run(fleet.in_folder(recorded.name, "ur5"), found.folder)
    finally:
        broken.unlink()
    rows = again.table("recordings")
    assert sum(not row["cached"] for row in rows if row["problem"] is None) == 1
    (refused,) = [row for row in rows if row["problem"]]
    assert refused["recording"] == str(broken) and "999.csv" in refused["problem"]
    assert np.allclose(values(again.table("parameters")), before, rtol=1e-9, atol=0)
    with pytest.raises(residyn.InputError, match="two robots are called"):
        fleet.run([fleet.Member("a", "ur5", []), fleet.Member("a", "ur5", [])], tmp_path)
    with pytest.raises(residyn.InputError, match="no folder with recordings"):
        fleet.in_folder(tmp_path, "ur5")


def test_causes_are_counted(recorded, survived, tmp_path):
    """Two robots with the same files (the task of one serves the other), and one whose recordings are too few."""
    files = sorted((recorded / simulated_fleet.name(0)).iterdir())
    members = [fleet.Member("a", "ur5", files), fleet.Member("b/c", "ur5", files), fleet.Member("d", "ur5", files[:1])]
    found = fleet.run(members, tmp_path / "out", diagnose=True, fast=True, in_flight=1)
    (stored,) = (tmp_path / "out" / "diagnosed").iterdir()
    report = json.loads(stored.read_text())
    named = sorted({cause["effect"] for cause in report["causes"]})
    assert "friction_parameters" in named, "the description has no friction"
    assert sorted((c["effect"], c["robots"], c["of"], tuple(c["names"])) for c in found.table("causes")) == [
        (effect, 2, 2, ("a", "b/c")) for effect in named
    ]
    assert [row["verdict"] for row in found.table("robots")] == [report["verdict"], report["verdict"], None]
    assert "two recordings" in found.table("robots")[2]["problem"]
    assert all(row["z"] is None and not row["outlier"] for row in found.table("parameters")), "three robots are too few to compare"
    assert "friction_parameters" in found.page.read_text()


def test_a_description_is_the_same_wherever_it_lies(tmp_path, monkeypatch):
    scene = Path(__file__).resolve().parents[2] / "physics/tests/fixtures/mjcf/six_axis.xml"
    monkeypatch.chdir(tmp_path)
    for folder in ("cell-1", "cell-2"):
        Path(folder).mkdir()
        shutil.copy(scene, Path(folder) / "robot.xml")
        (Path(folder) / "monday.csv").touch()
    one, two = fleet.in_folder(".")
    assert (one.name, two.name) == ("cell-1", "cell-2")
    robots = [member.loaded() for member in (one, two)]
    assert [Path(robot.source) for robot in robots] == [tmp_path / name / "robot.xml" for name in ("cell-1", "cell-2")]
    assert work.described(robots[0]) == work.described(robots[1]) != work.described(residyn.Robot("ur5"))


def test_without_ray_it_says_what_to_install(recorded, tmp_path):
    hidden = "import sys; sys.modules['ray'] = None; import runpy; sys.argv = sys.argv[1:]; runpy.run_module('residyn.fleet', run_name='__main__')"
    command = [sys.executable, "-c", hidden, "fleet", recorded, "--robot", "ur5", "--out", tmp_path / "out"]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 2 and "pip install ray pyarrow" in ended.stderr
    assert not (tmp_path / "out").exists()


def test_outliers_are_robust_and_know_what_is_badly_known():
    values = np.array([1.0, 1.1, 0.9, 1.05, 0.95, 3.0, 3.0])
    std = np.array([0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 2.0])
    median, z = robust_z(values, std)
    # Distances from 1.05: 0.05 0.05 0.15 0 0.1 1.95 1.95, median 0.1; the last is known to 2 alone.
    assert median == 1.05
    assert np.isclose(z[5], 1.95 / (1.4826 * 0.1)) and np.isclose(z[6], 1.95 / 2.0)
    assert np.all(robust_z(np.ones(6), np.zeros(6))[1] == 0)
