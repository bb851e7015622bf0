"""Model directories with other networks than `train` makes: the file is written as docs/compensator-format.md describes it."""

import hashlib
import json

import numpy as np

RECURRENT = {"encoder": 6, "attention": 5, "reencoder": 4}
#: Kinds of networks: windows, carried state with and without attention, perceptrons.
KINDS = {
    "window": {"recurrent": {**RECURRENT, "memory": {"kind": "window", "timestep": 3}}},
    "carried": {"recurrent": {**RECURRENT, "memory": {"kind": "carried", "attended": 4}}},
    "carried without attention": {"recurrent": {**RECURRENT, "attention": None, "memory": {"kind": "carried", "attended": 1}}},
    "perceptron": {"perceptron": {"hidden": [7, 3], "timestep": 2}},
    "linear": {"perceptron": {"hidden": [], "timestep": 1}},
}


def rewrite(folder, architecture, rng):
    """Gives every unit of a model two random networks of an architecture, and a target that they fill."""
    path = folder / "compensator.safetensors"
    content = path.read_bytes()
    length = int.from_bytes(content[:8], "little")
    entries = json.loads(content[8 : 8 + length])
    header = json.loads(json.loads(entries.pop("__metadata__")["residyn"])["header"])
    data, tensors = content[8 + length :], {}
    for name, entry in entries.items():
        start, end = entry["data_offsets"]
        if ".members." not in name:
            tensors[name] = np.frombuffer(data[start:end], "<f4").reshape(entry["shape"])
    for i, unit in enumerate(header["units"]):
        unit.update(architecture=architecture, enabled=True, members=2)
        for member in range(2):
            for name, shape in _shapes(architecture, len(unit["columns"])):
                tensors[f"units.{i}.members.{member}.{name}"] = rng.uniform(-0.7, 0.7, shape).astype("<f4")
    header = json.dumps(header)
    digest = hashlib.sha256(header.encode())
    for name in sorted(tensors):
        for part in [name, *map(str, tensors[name].shape)]:
            digest.update(b"\0" + part.encode())
        digest.update(b"\0" + tensors[name].tobytes())
    envelope = {"format": "residyn/compensator", "version": 1, "sha256": digest.hexdigest(), "header": header}
    entries, place = {"__metadata__": {"residyn": json.dumps(envelope)}}, 0
    for name, tensor in tensors.items():
        entries[name] = {"dtype": "F32", "shape": tensor.shape, "data_offsets": [place, place + tensor.nbytes]}
        place += tensor.nbytes
    text = json.dumps(entries).encode()
    text += b" " * (-len(text) % 8)
    content = len(text).to_bytes(8, "little") + text + b"".join(t.tobytes() for t in tensors.values())
    path.write_bytes(content)
    model = json.loads((folder / "model.json").read_text())
    model["compensator"]["sha256"] = hashlib.sha256(content).hexdigest()
    (folder / "model.json").write_text(json.dumps(model))


def _shapes(architecture, columns):
    if "perceptron" in architecture:
        shape = architecture["perceptron"]
        widths = [columns * shape["timestep"], *shape["hidden"], 1]
        for k, (rows, out) in enumerate(zip(widths, widths[1:])):
            yield f"layer{k}.weight", (rows, out)
            yield f"layer{k}.bias", (1, out)
        return
    shape = architecture["recurrent"]
    h, a, s = shape["encoder"], shape["attention"], shape["reencoder"]
    yield "encoder.weight", (columns + h, 4 * h)
    yield "encoder.bias", (1, 4 * h)
    if a is not None:
        yield "attention.query", (s, a)
        yield "attention.key", (h, a)
        yield "attention.bias", (1, a)
        yield "attention.score", (1, a)
    yield "reencoder.weight", ((h if a is None else 2 * h) + s, 4 * s)
    yield "reencoder.bias", (1, 4 * s)
    yield "output.weight", (s, 1)
    yield "output.bias", (1, 1)
