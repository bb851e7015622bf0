"""Console, JSON, page and patch of a diagnosis, value by value: what is written is what is said."""

import html
import re

import pytest

mujoco = pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: written models are not loaded")
import numpy as np  # noqa: E402
from arms import CASES  # noqa: E402

#: Beside the cases of the written models two without a payload and two more.
MORE = [("bench", 0.0, "free"), ("crane", 0.0, "fixed"), ("desk", 0.1, "free"), ("wrist", 0.35, "free")]
NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
#: Console and page round to four digits, a deviation to two.
DIGITS, TWO = 6e-4, 6e-2


def close(a, b, rel, size=0.0):
    """Whether two numbers are the same but for rounding; `size` is what they are a part of."""
    return abs(float(a) - float(b)) <= rel * max(abs(float(a)), abs(float(b))) + 1e-9 * size + 1e-12


def estimates(text):
    """Every `name value ± deviation unit` of a text."""
    return re.findall(rf"(\w+) ({NUMBER}) ± ({NUMBER}) (\S+?)(?=[,;).\s]|$)", text)


def changes(text):
    """By link or joint, every `name from → to` of the console."""
    found = {}
    for kind, name, rest in re.findall(r"^  (link|joint) (\w+): (.*)$", text, re.M):
        of = re.findall(rf"(?:^|, )([a-z ]+?) ({NUMBER}) → ({NUMBER}) (\S+?)(?=,|$)", rest)
        assert len(of) == rest.count("→"), rest
        found[kind, name] = {what: (float(a), float(b)) for what, a, b, _ in of}
    return found


def link(model, names):
    """Mass, centre of mass in the first body's frame and principal moments of bodies that are fixed to each other."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    first = model.body(names[0]).id
    turn, place = data.xmat[first].reshape(3, 3), data.xpos[first]
    ids = [model.body(n).id for n in names]
    masses = np.array([model.body_mass[i] for i in ids])
    centre = sum(m * data.xipos[i] for m, i in zip(masses, ids)) / masses.sum()
    about = np.zeros((3, 3))
    for m, i in zip(masses, ids):
        axes, arm = data.ximat[i].reshape(3, 3), data.xipos[i] - centre
        about += axes @ np.diag(model.body_inertia[i]) @ axes.T + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    x, y, z = turn.T @ (centre - place)
    least, middle, largest = np.linalg.eigvalsh(about)
    return {
        "mass": masses.sum(), "centre of mass x": x, "centre of mass y": y, "centre of mass z": z,
        "least principal moment": least, "middle principal moment": middle, "largest principal moment": largest,
    }


def joint(model, name):
    """What a description holds of a joint."""
    at = model.joint(name).dofadr[0]
    return {"damping": model.dof_damping[at], "friction": model.dof_frictionloss[at], "armature": model.dof_armature[at]}


@pytest.mark.parametrize("arm, payload, gripper", CASES + MORE, ids=lambda v: str(v))
def test_what_is_written_is_what_is_said(diagnosed, arm, payload, gripper):
    case = diagnosed(arm, payload, gripper)
    report, said = case.report, case.said
    page = re.sub(r"<(script|style|svg).*?</\1>", " ", (case.folder / "r.html").read_text(), flags=re.S)
    page = re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", " ", page)))

    # Errors: console, page, JSON.
    steps = {s["step"]: s["mean_nrmse"] for s in report["ladder"]}
    ends = [report["ladder"][0]["mean_nrmse"], report["ladder"][-1]["mean_nrmse"]]
    for text in (said, page):
        given, explained = re.search(rf"held-out data ({NUMBER}) as given, ({NUMBER}) explained", text).groups()
        assert abs(float(given) - ends[0]) < 6e-4, (given, steps)
        assert any(abs(float(explained) - v) < 6e-4 for v in steps.values()), (explained, steps)

    # Causes: every number of console and page is the JSON's, and the table of values is the JSON.
    known = [p for c in report["causes"] for p in c["parameters"]]
    for text in (said, page):
        stated = [e for e in estimates(text) if e[0] in {p["name"] for p in known}]
        assert stated
        for name, value, std, unit in stated:
            assert any(
                p["name"] == name and p["unit"] == unit and close(value, p["value"], DIGITS, p["std"] or 0) and close(std, p["std"] or 0, TWO)
                for p in known
            ), (name, value, std, unit)
    table = (case.folder / "fixed.values.tsv").read_text().split("\n\n")[0].splitlines()[1:]
    rows = [row.split("\t") for row in table]
    listed = [(c["effect"], p["joint"], p["name"], p["value"]) for c in report["causes"] for p in c["parameters"]]
    assert [(r[0], r[1], r[2], float(r[3])) for r in rows] == listed

    # The file: from and to as the console says, and nothing else has changed.
    before, after = case.models()
    told = changes(said)
    groups = {f"l{k}": [f"l{k}"] for k in range(case.n)}
    groups[f"l{case.n - 1}"] += [f"l{k}" for k in range(case.n, len(case.links))]
    for kind, names, of in (("link", groups, link), ("joint", {f"j{k}": f"j{k}" for k in range(case.n)}, joint)):
        for name, parts in names.items():
            was, now, own = of(before, parts), of(after, parts), told.pop((kind, name), {})
            for what in was:
                from_, to = own.get(what, (was[what],) * 2)
                size = max(abs(v) for v in was.values())
                assert close(from_, was[what], DIGITS, size), (name, what, from_, was)
                assert close(to, now[what], DIGITS, size), (name, what, to, now)
    assert not told, told
    for what, at in (("damping", "dof_damping"), ("friction", "dof_frictionloss")):
        assert np.array_equal(getattr(before, at)[case.n :], getattr(after, at)[case.n :]), what

    # A load is said with what its body has.
    held = re.search(rf"payload, a body of its own on (\w+): ({NUMBER}) kg at \(({NUMBER}), ({NUMBER}), ({NUMBER})\) m", said)
    loads = [c for c in report["causes"] if c["effect"] == "payload"]
    assert bool(held) == bool(loads) == any(after.body(b).name == "payload" for b in range(after.nbody))
    for cause in loads:
        value = {p["name"]: p["value"] for p in cause["parameters"]}
        body = after.body("payload")
        data = mujoco.MjData(after)
        mujoco.mj_forward(after, data)
        frame = after.body(held[1]).id
        place = data.xmat[frame].reshape(3, 3).T @ (data.xipos[body.id] - data.xpos[frame])
        assert close(value["mass"], body.mass[0], 1e-9) and close(held[2], body.mass[0], DIGITS)
        for k, axis in enumerate("xyz"):
            assert close(value[f"com_{axis}"], place[k], 1e-6, 1.0) and close(held[3 + k], place[k], DIGITS, 1.0)

    # Every file that was written is named.
    named = {line.rsplit("/", 1)[-1].split(": ")[-1] for line in said.splitlines() if line.startswith("Written: ")}
    assert named == case.made
