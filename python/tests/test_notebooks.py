"""The notebooks run from top to bottom."""

from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat", reason="PyPI nbformat is not installed: notebooks are not run")
nbclient = pytest.importorskip("nbclient", reason="PyPI nbclient is not installed: notebooks are not run")
pytest.importorskip("ipykernel", reason="PyPI ipykernel is not installed: notebooks are not run")
pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: the notebooks record in it")

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"


@pytest.mark.parametrize("name", ["first_diagnosis", "to_mujoco"])
def test_a_notebook_runs(name):
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    said = "".join(o.get("text", "") for c in notebook.cells for o in c.get("outputs", []))
    assert "payload" in said if name == "first_diagnosis" else "corrected" in said, said
