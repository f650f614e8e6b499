"""Few points for many nodes: how many, how accurate, how long, and `jointfmu footprint import` of 1e5 nodes.

Times are those of the processor, of all threads: BLAS should have one (OPENBLAS_NUM_THREADS=1).

python benchmarks/field_reduction.py
"""

import contextlib
import io
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from jointfmu_tools import cli
from jointfmu_tools.inputs.fields import nodal_result
from jointfmu_tools.inputs.fields.joint_parameters import pressure_shape
from jointfmu_tools.inputs.fields.nodal_result import ContactField
from jointfmu_tools.inputs.fields.reduction import reduce_field

from jointfmu.joints.bolted_joint.law import bolt_pattern, preload_pressure
from jointfmu.mechanics.footprint import bolts
from jointfmu.parameters import load_default

PRELOAD = 9e3
ACROSS = (10, 20, 66)
"""Cells across a bolt's hole, 66 for 104 052 nodes."""
OPEN = 0.45
"""Pressure below which nodes are open, over the mean [1]."""
UNEVEN = 0.1
"""By how much the pressure grows along the rows [1], so that nothing is symmetric."""


def field(across: int, closed: float) -> ContactField:
    """The default frame with its pressure, uneven, open below `closed`."""
    joint = load_default("bolted_joint").values
    bolts.CELLS_ACROSS_FLANGE = across
    shape = bolt_pattern(joint).pressure_distribution()
    x = shape.position[:, 0]
    p = np.maximum(shape.preload_shape * (1.0 + UNEVEN * x / np.ptp(x)) - closed, 0.0)
    p *= PRELOAD * joint.n_bolts / joint.A_0 / (shape.area_share @ p)
    return ContactField(shape.area_share * joint.A_0, shape.position, p)


def main() -> None:
    """Print the table."""
    joint = load_default("bolted_joint").values
    print("| nodes | open | points | deviation | s | s of the command |\n|---|---|---|---|---|---|")
    for across in ACROSS:
        for closed in (0.0, OPEN):
            one = field(across, closed)
            start = time.process_time()
            shape = pressure_shape(joint, one, PRELOAD)
            found = reduce_field(replace(joint, A_0=float(one.area.sum())), shape, PRELOAD, preload_pressure)
            took = time.process_time() - start
            with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
                path = Path(folder) / "field.csv"
                path.write_text(nodal_result.csv_text(one))
                start = time.process_time()
                line = ["footprint", "import", str(path), "--preload", f"{PRELOAD:g}", "--open", "keep"]
                cli.main([*line, "--out", str(path.with_suffix(".toml"))])
                whole = time.process_time() - start
            part = float(np.mean(one.pressure == 0.0))
            times = f"{took:.1f} | {whole:.1f}"
            print(
                f"| {found.node_count} | {part:.0%} | {found.point_count} | {found.largest_deviation:.1e} | "
                f"{times} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
