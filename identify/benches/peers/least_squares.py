"""Tall least squares, 200,000 x 60: this library against LAPACK through NumPy and SciPy, in one run.

    cargo build --release -p residyn-identify --bench identification
    python identify/benches/peers/least_squares.py

Both sides run on one thread, in turns, five rounds; the ratio is ours over theirs of the medians (below one: faster).
The Rust side times accumulation, solution and covariance; NumPy lstsq (gelsd) solves alone.
"""
import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import pathlib
import statistics
import subprocess
import time

import numpy as np
import scipy.linalg

root = pathlib.Path(__file__).resolve().parents[3]
target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", root / "target"))
found = [p for p in (target / "release" / "deps").glob("identification-*") if not p.suffix and os.access(p, os.X_OK)]
if not found:
    raise SystemExit("build the bench first: cargo build --release -p residyn-identify --bench identification")
bench = max(found, key=lambda p: p.stat().st_mtime)

rng = np.random.default_rng(1)
a, b = rng.normal(size=(200_000, 60)), rng.normal(size=200_000)
peers = {
    "numpy.linalg.lstsq": lambda: np.linalg.lstsq(a, b, rcond=None),
    "scipy.linalg.lstsq gelsy": lambda: scipy.linalg.lstsq(a, b, lapack_driver="gelsy"),
    "numpy.linalg.qr, r": lambda: np.linalg.qr(a, mode="r"),
}
ours, theirs = [], {name: [] for name in peers}
for _ in range(5):
    out = subprocess.run([bench, "least_squares"], capture_output=True, text=True, check=True).stdout
    ours.append(float(out.split(" ms ")[1]))
    for name, run in peers.items():
        start = time.perf_counter()
        run()
        theirs[name].append(1e3 * (time.perf_counter() - start))
mine = statistics.median(ours)
print(f"{'identify::least_squares':34} {mine:8.0f} ms")
for name, times in theirs.items():
    median = statistics.median(times)
    print(f"{name:34} {median:8.0f} ms  ratio {mine / median:.2f}")
