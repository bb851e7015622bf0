"""Simulated recordings, and the programs that the package has to agree with."""

import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest


def pytest_configure(config):
    config.addinivalue_line("markers", "xdist_group(name): tests that one process runs, where there are several")


def pytest_collection_modifyitems(items):
    """A file is run by one process, and so are all that look at the same diagnosed cases."""
    for item in items:
        shared = "diagnosed" in item.fixturenames
        item.add_marker(pytest.mark.xdist_group("diagnosed" if shared else item.module.__name__))


@pytest.fixture(autouse=True)
def interruptible():
    """Ctrl-C is heard, even where the tests were started with it ignored, as in the background of a shell."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def program():
    """Runs a program of the workspace; its folder stands in RESIDYN_BIN."""
    folder = os.environ.get("RESIDYN_BIN")
    if folder is None:
        pytest.skip("RESIDYN_BIN does not name the folder of train, eval, diagnose and simulate")

    def run(name, *arguments):
        command = [str(Path(folder) / name), *map(str, arguments)]
        return subprocess.run(command, check=True, capture_output=True, text=True)

    # Of scripts that call the program by name.
    run.environment = {**os.environ, "RESIDYN": str(Path(folder) / "residyn")}
    return run


@pytest.fixture(scope="session")
def raw(program, tmp_path_factory):
    """A raw recording: folder with robot.urdf, train.csv, test.csv."""
    out = tmp_path_factory.mktemp("raw")
    program("simulate", "raw", "--out", out, "--cases", 1, "--seed", 5, "--quiet")
    return next(p.parent for p in out.rglob("robot.urdf"))


@pytest.fixture(scope="session")
def case(program, tmp_path_factory):
    """A sealed case of a diagnosis: folder with robot.urdf, train.parquet, test.parquet."""
    out = tmp_path_factory.mktemp("cases")
    program("simulate", "cases", "--out", out, "--cases", 1, "--seed", 5, "--quiet")
    return next(p.parent for p in out.rglob("robot.urdf"))


@pytest.fixture(scope="session")
def brief(case, tmp_path_factory):
    """`case` with ten seconds of each recording, where the answer does not matter."""
    import residyn

    out = tmp_path_factory.mktemp("brief")
    shutil.copy(case / "robot.urdf", out)
    for name in ("train", "test"):
        whole = residyn.Recording.read(case / f"{name}.parquet")
        residyn.Recording(whole.time[:3000], whole.q[:3000], whole.tau[:3000]).write(out / f"{name}.parquet")
    return out


@pytest.fixture(scope="session")
def diagnosed(program, tmp_path_factory):
    """Diagnoses a case of `arms` once, however many tests look at it."""
    from arms import Diagnosed

    known = {}

    def of(*case):
        if case not in known:
            known[case] = Diagnosed(program, tmp_path_factory.mktemp("case"), *case)
        return known[case]

    return of
