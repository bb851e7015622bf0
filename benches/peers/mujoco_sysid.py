#!/usr/bin/env python3
"""The fit of examples/replay_fit.rs by MuJoCo's own system identification, and both weighed by MuJoCo.

    pip install 'mujoco[sysid]' pyarrow
    cargo run --release --workspace --example replay_fit -- --robot so101.xml --joints … --data multisine.parquet --out ours.json
    python benches/peers/mujoco_sysid.py --robot so101.xml --data multisine.parquet --ours ours.json --iterations 15

The same recording, blocks with their recorded starts, parameters, start, step and number of threads. Cost of an iterate: sum over samples
and joints of ((q_sim - q) / tracking)^2, tracking = RMS(q_ref - q) by joint. Each fit minimises it in its own simulator: MuJoCo's dry friction
creeps, so that the same values cost something else there. Printed: seconds and processor seconds until an iterate costs at most 1.01 times the
fit's own best, and what the other fit's best values cost in MuJoCo. Where other programs run, processor seconds are the fairer ones.
"""

import argparse
import json
import time

import mujoco
import numpy as np
import pyarrow.parquet
from mujoco import sysid

#: Name, attribute of the file, and where the search may go. The drive's own damping stays as given: without commanded velocities it
#: and the joint's damping are one number.
BOUNDS = {"kp": (0.5, 2000.0), "damping": (0.0, 20.0), "frictionloss": (0.0, 5.0), "armature": (1e-5, 1.0)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("--robot", "--data", "--ours"):
        parser.add_argument(name, required=True)
    parser.add_argument("--iterations", type=int, default=15)
    a = parser.parse_args()
    with open(a.ours) as file:
        ours = json.load(file)
    problem = Problem(a.robot, a.data, ours)
    theirs = problem.optimize(a.iterations)
    own = [(i["seconds"], i["processor"], i["cost"]) for i in ours["iterates"]]
    rows = {"residyn": own, "mujoco.sysid": [(seconds, used, problem.cost(x)) for seconds, used, x in theirs]}
    print(f"{len(problem.names)} joints, {problem.start.size} parameters, {len(problem.chunks)} blocks, step {1e3 * ours['step']:g} ms, {ours['threads']} threads")
    for name, all_ in rows.items():
        best = min(c for *_, c in all_)
        seconds, used, _ = next(row for row in all_ if row[2] <= 1.01 * best)
        print(f"{name}: as given {all_[0][2]:.1f}, best {best:.1f}; 1.01 times that after {seconds:.2f} s ({used:.2f} s of processor time)")
    print(f"residyn's last values in MuJoCo: {problem.cost(list(problem.vectors(ours))[-1][2]):.1f}")


class Problem:
    """Recording, blocks and parameters, in MuJoCo."""

    def __init__(self, robot, data, ours):
        self.names = ours["joints"]
        self.threads = ours["threads"]
        spec = mujoco.MjSpec.from_file(robot)
        spec.option.timestep = ours["step"]
        for geom in spec.geoms:
            geom.contype = geom.conaffinity = 0
        self.actuators = {}
        for actuator in spec.actuators:
            self.actuators[actuator.target] = actuator.name
        for name in self.names:
            spec.add_sensor(name=f"{name}_q", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=name)
        self.spec = spec
        model = spec.compile()
        self.parameters = sysid.ParameterDict()
        for name in self.names:
            for what, (low, high) in BOUNDS.items():
                own = float(model.actuator(self.actuators[name]).gainprm[0]) if what == "kp" else float(getattr(model.joint(name), what)[0])
                self.parameters.add(sysid.Parameter(f"{what}_{name}", own, low, high, modifier=self.modifier(what, name)))
        self.start = self.parameters.as_vector()
        self.read(data, ours, model)

    def damping(self, model, name):
        """Of the drive."""
        return -float(model.actuator(self.actuators[name]).biasprm[2])

    def modifier(self, what, name):
        def change(spec, parameter):
            value = float(parameter.value[0])
            if what == "kp":
                actuator = spec.actuator(self.actuators[name])
                actuator.gainprm[0], actuator.biasprm[1] = value, -value
            elif what == "damping":
                joint = spec.joint(name)
                joint.damping = [value, *np.asarray(joint.damping).ravel()[1:]] if np.ndim(joint.damping) else value
            else:
                setattr(spec.joint(name), what, value)

        return change

    def read(self, data, ours, model):
        table = pyarrow.parquet.read_table(data).to_pydict()
        n = len(self.names)
        time_ = np.array(table["time"])
        q, q_ref = (np.column_stack([table[f"{c}{j + 1}"] for j in range(n)]) for c in ("q", "q_ref"))
        self.tracking = np.sqrt(((q_ref - q) ** 2).mean(axis=0))
        scratch = mujoco.MjData(model)
        where = [int(model.joint(name).qposadr[0]) for name in self.names]
        moved = [int(model.joint(name).dofadr[0]) for name in self.names]
        driven = [int(model.actuator(self.actuators[name]).id) for name in self.names]
        rows = [np.flatnonzero((time_ >= low - 1e-9) & (time_ <= high + 1e-9)) for low, high in ours["blocks"]]
        length = min(len(r) for r in rows)
        self.chunks = []
        states, controls, sensors = [], [], []
        for r in rows:
            r = r[:length]
            t = time_[r] - time_[r[0]]
            mujoco.mj_resetData(model, scratch)
            scratch.qpos[where] = q[r[0]]
            # Slope of the parabola through the five samples around the start, as the other fit takes it.
            near = slice(max(r[0] - 2, 0), r[0] + 3)
            scratch.qvel[moved] = np.polyfit(time_[near] - time_[r[0]], q[near], 2)[1]
            steps = np.arange(int(np.ceil(t[-1] / model.opt.timestep)) + 1) * model.opt.timestep
            control = np.zeros((len(steps), model.nu))
            held = np.clip(np.searchsorted(t, steps, side="right") - 1, 0, length - 1)
            control[:, driven] = q_ref[r][held]
            states.append(sysid.create_initial_state(model, scratch.qpos, scratch.qvel, scratch.act))
            controls.append(sysid.TimeSeries(steps, control))
            sensors.append(sysid.TimeSeries.from_names(t, q[r], model))
            self.chunks.append(f"block {len(self.chunks)}")
        sequences = sysid.ModelSequences("arm", self.spec, self.chunks, states, controls, sensors)
        self.residual = sysid.build_residual_fn(
            models_sequences=[sequences], n_threads=self.threads, resample_true=False, modify_residual=self.off,
        )  # fmt: skip

    def off(self, params, sensordata_predicted, sensordata_measured, model, return_pred_all, state=None, sensor_weights=None):
        """Residuals in units of the tracking error, at the recorded stamps."""
        predicted = sensordata_predicted.resample(sensordata_measured.times[1:-1])
        measured = sensordata_measured.resample(sensordata_measured.times[1:-1])
        return (predicted.data - measured.data) / self.tracking, predicted, measured

    def cost(self, x):
        residuals, *_ = self.residual(np.asarray(x), self.parameters.copy())
        return float((np.concatenate(residuals) ** 2).sum())

    def vectors(self, ours):
        """Iterates of the other fit as MuJoCo's parameters."""
        model = self.spec.compile()
        for iterate in ours["iterates"]:
            x = []
            for j, name in enumerate(self.names):
                for what in BOUNDS:
                    x.append(iterate[what][j] - (self.damping(model, name) if what == "damping" else 0.0))
            yield iterate["seconds"], iterate["processor"], np.array(x)

    def optimize(self, iterations):
        """Seconds and processor seconds until each candidate of MuJoCo's optimiser, which asks for one column at a candidate."""
        begun, used = time.perf_counter(), time.process_time()
        out = []

        def watched(x, params):
            if x.ndim == 1 or x.shape[1] == 1:
                out.append((time.perf_counter() - begun, time.process_time() - used, np.array(x).ravel()))
            return self.residual(x, params)

        sysid.optimize(self.parameters.copy(), watched, optimizer="mujoco", verbose=False, max_iters=iterations, x_scale="jac")
        return out


if __name__ == "__main__":
    main()
