"""Peer of `benches/inference.rs`: for each line `GRAPH FORM ITERATIONS` on stdin, nanoseconds of one evaluation of an ONNX
graph on one thread of ONNX Runtime. FORM is f32, or int8 for its own dynamic quantisation.

Python's own part of a call, timed on a graph that does nothing, is taken off."""

import sys
import tempfile
import time

import numpy as np
import onnx
import onnxruntime as ort
from onnx import TensorProto, helper
from onnxruntime.quantization import QuantType, quantize_dynamic

FOLDER = tempfile.TemporaryDirectory()
SESSIONS = {}


def session(graph, form):
    """Session on one thread with its inputs bound, and that of the same inputs without work."""
    if (graph, form) not in SESSIONS:
        options = ort.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        options.log_severity_level = 3
        path = graph
        if form == "int8":
            path = f"{FOLDER.name}/{len(SESSIONS)}.onnx"
            quantize_dynamic(graph, path, weight_type=QuantType.QInt8)
        given = onnx.load(graph).graph.input
        SESSIONS[graph, form] = [bound(path, options), bound(idle(given), options)]
    return SESSIONS[graph, form]


def idle(given):
    """A graph that hands its first input on."""
    output = helper.make_tensor_value_info("out", TensorProto.FLOAT, None)
    node = helper.make_node("Identity", [given[0].name], ["out"])
    graph = helper.make_graph([node], "idle", list(given), [output])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    return model.SerializeToString()


def bound(model, options):
    opened = ort.InferenceSession(model, options, providers=["CPUExecutionProvider"])
    binding = opened.io_binding()
    for i, given in enumerate(opened.get_inputs()):
        shape = [size if isinstance(size, int) else 1 for size in given.shape]
        values = np.sin(np.arange(np.prod(shape)) + i).astype(np.float32).reshape(shape)
        binding.bind_ortvalue_input(given.name, ort.OrtValue.ortvalue_from_numpy(values))
    for output in opened.get_outputs():
        binding.bind_output(output.name)
    return lambda: opened.run_with_iobinding(binding)


def timed(call, count):
    start = time.perf_counter_ns()
    for _ in range(count):
        call()
    return (time.perf_counter_ns() - start) / count


for line in sys.stdin:
    graph, form, count = line.split()
    work, nothing = session(graph, form)
    work()
    print(max(timed(work, int(count)) - timed(nothing, int(count)), 0.0), flush=True)
