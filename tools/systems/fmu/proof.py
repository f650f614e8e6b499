"""The proof inside the FMU of a system: its own experiment, judged by model exchange at a tight tolerance.

The laws of the joints are proved by the joints' FMUs, against the package. What a system adds are wires,
memory and the implicit step: references are of the same equations, integrated by CVode.
"""

from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from jointfmu_fmu_src.proof import standard
from jointfmu_fmu_src.proof.files import TEXT, RelatedFile, proof_members
from jointfmu_fmu_src.proof.series import TimeSeries, text
from jointfmu_fmu_src.proof.standard import CO_SIMULATION, MODEL_EXCHANGE
from jointfmu_fmu_src.xml_parts import serialized

from jointfmu import __version__
from jointfmu.joints.model import Model

from ...host import unpack_fmu
from ...proof import exchange
from ...proof.task import Task

TOLERANCE, SOLVER, HOST = 5e-3, 1e-9, 1e-5
"""Of an output [1], over its scale: what docs/systems_explanation.md promises of any step; of the
references' solver; of one whose host states none. Where these two part the motion is too sensitive to be
compared."""
SMALL = 1e-2
"""Part of its nominal value [1] below which an output is judged by that part, not by its largest value."""
STEP, LONGER = 1e-3, 10
"""Communication step [s], of which an experiment has ten at least, and how many make the longer one."""
FINE, MOST_STEPS, ROWS = 3, 100_000, 200
"""Steps of model exchange in an interval of the system, after each of which memory is accepted; of them at
most: a longer experiment is proved up to there; about the rows of a file."""
JUMP, JUMP_DISTANCE = 10.0, 3
"""An output jumps where it changes by more than TOLERANCE between two fine steps, and by this many times [1]
what it changes before and after: a stiffness does where motion turns. A step that is right finds the turn a
little earlier or later, so within so many intervals of a jump nothing is compared."""
DIGITS = 7
_PAGE = """\
The proof inside this FMU

The folder extra/{standard} holds the system's own experiment after FMI-LS-REF
{version}, at communication steps of {short:g} s and {long:g} s, and in model exchange. jointfmu {own}
has computed the reference results by model exchange of this FMU: CVode, relative tolerance {solver:g}, a
completed integrator step every {fine:.3g} s. They prove the implicit step, not the laws: these are proved
by the joints' own FMUs. They end at {end:.6g} s of {stop:g} s: at the latest where model exchange at a
tolerance of {host:g} gives other results.

How to run them
  jointfmu prove FMU
or by any importer: no value is set, steps are of stepSize.

Tolerance
  |value - reference| <= {tolerance:g} scale
The annotation of each experiment states the scale of each output: its largest reference between start and
end, or {small:g} of its nominal value if that is more. Left out are times within {near:.3g} s of a jump of an
output: a stiffness jumps where the motion turns and friction sticks again.
"""


def proof(model: Model, stop: float, interval: float, fmu: Path) -> dict[str, bytes]:
    """{path in the FMU: content}; where its experiment cannot be run here a text that says why.

    stop, interval : of the system's experiment [s]; what separate FMUs need is followed more finely here
    """
    step = min(STEP, stop / LONGER)
    parts = max(int(np.ceil(FINE * step / interval - 1e-6)), 1)
    count = LONGER * max(min(int(stop / (LONGER * step) + 1e-6), MOST_STEPS // (LONGER * parts)), 1)
    fine = step / parts
    try:
        times = fine * np.arange(count * parts + 1)
        found, rough = (_exchanged(model, fmu, times, tolerance) for tolerance in (SOLVER, HOST))
        while (parted := _first_difference(model, found, rough)) < found.time.size:
            count = (parted - 1) // (LONGER * parts) * LONGER
            if not count:
                raise RuntimeError("its own experiment is too sensitive from the start")
            found = _first_rows(found, count * parts + 1)
    except Exception as error:  # fmpy raises bare Exception
        return {TEXT: f"There is no proof inside this FMU: where it was built {error}\n".encode()}
    scales = _scales(model, found)
    smooth = _is_smooth(found, scales)
    short, long = (f"experiments/{model.title}_{n}_ref.csv" for n in (1, LONGER))
    members = {path: _result_file(found, smooth, n * parts) for path, n in ((short, 1), (long, LONGER))}
    runs = {
        CO_SIMULATION: [(step, short), (LONGER * step, long)],
        MODEL_EXCHANGE: [(fine, short)],
    }
    related = [
        RelatedFile(
            "../../documentation/index.html", "text/html", "requirement", "what the FMU takes and gives"
        ),
        RelatedFile(f"../../{TEXT}", "text/plain", "document", "experiments and tolerance"),
        *(
            RelatedFile(path, standard.CSV, "result", "by model exchange at a tight tolerance")
            for path in members
        ),
    ]
    for interface, steps in runs.items():
        path = f"{interface.replace(' ', '-')}.exp"
        members[path] = _experiments(model, count * step, steps, scales)
        labels = {interface: "steps of stepSize"}
        related.append(RelatedFile(path, standard.EXPERIMENTS, "experiment/validation", model.doc, labels))
    page = _PAGE.format(
        standard=standard.NAME,
        version=standard.VERSION,
        own=__version__,
        short=step,
        long=LONGER * step,
        solver=SOLVER,
        fine=fine,
        tolerance=TOLERANCE,
        small=SMALL,
        near=FINE * JUMP_DISTANCE * fine,
        end=count * step,
        stop=stop,
        host=HOST,
    )
    return proof_members(members, related, page)


def _scales(model: Model, results: TimeSeries) -> dict[str, float]:
    """{output: its scale}."""
    return {
        v.name: max(float(np.abs(results.columns[v.name]).max()), SMALL * v.nominal) for v in model.outputs
    }


def _first_difference(model: Model, fine: TimeSeries, coarse: TimeSeries) -> int:
    """The row of results at which rougher ones part from them, the number of rows if they do not."""
    scales, rows = _scales(model, fine), fine.time.size
    apart = [
        np.abs(column - coarse.columns[name][:rows]) > TOLERANCE * scales[name]
        for name, column in fine.columns.items()
    ]
    missed = np.flatnonzero(np.any(apart, axis=0) & _is_smooth(fine, scales))
    return int(missed[0]) if missed.size else rows


def _first_rows(results: TimeSeries, rows: int) -> TimeSeries:
    """The first rows."""
    return TimeSeries(results.time[:rows], {name: column[:rows] for name, column in results.columns.items()})


def _exchanged(model: Model, fmu: Path, times: np.ndarray, tolerance: float) -> TimeSeries:
    """All outputs at the times, by model exchange; raises whatever prevents it."""
    names, said = [v.name for v in model.outputs], list[str]()
    if not exchange.has_solver():
        raise RuntimeError("fmpy has no solver for model exchange")
    with unpack_fmu(fmu, model_exchange=True) as (folder, _):
        task = Task(
            str(fmu),
            folder,
            MODEL_EXCHANGE,
            times=times.tolist(),
            outputs=names,
            kinds=dict.fromkeys(names, "real"),
            tolerance=tolerance,
        )
        try:
            rows = exchange.run_fmpy_exchange(task, said)
        except Exception as error:
            raise RuntimeError(f"its own experiment failed: {said[0] if said else error}") from None
    return TimeSeries(times, dict(zip(names, np.array(rows).T, strict=True)))


def _is_smooth(results: TimeSeries, scales: Mapping[str, float]) -> np.ndarray:
    """Whether no output jumps near a time."""
    jumps = np.zeros(results.time.size - 1, dtype=bool)
    for name, column in results.columns.items():
        change = np.abs(np.diff(column))
        around = np.maximum(np.append(change[1:], 0.0), np.append(0.0, change[:-1]))
        jumps |= (change > TOLERANCE * scales[name]) & (change > JUMP * around)
    near = np.convolve(jumps, np.ones(2 * FINE * JUMP_DISTANCE, dtype=int))[FINE * JUMP_DISTANCE - 1 :]
    smooth = np.asarray(near[: results.time.size] == 0)
    smooth[0] = True  # nothing has moved yet
    return smooth


def _result_file(results: TimeSeries, smooth: np.ndarray, step: int) -> bytes:
    """A file of the results at some ends of steps of so many fine ones."""
    rows = step * np.flatnonzero(smooth[::step])
    rows = rows[:: -(-rows.size // ROWS)]
    columns = {name: column[rows] for name, column in results.columns.items()}
    times = np.array([float(f"{time:.12g}") for time in results.time[rows]])
    return text(TimeSeries(times, columns), DIGITS).encode()


def _experiments(
    model: Model, stop: float, steps: list[tuple[float, str]], scales: Mapping[str, float]
) -> bytes:
    root = Element("Experiments", name=f"{model.title}, its own experiment", description=model.doc)
    for step, path in steps:
        name = f"steps of {1e3 * step:g} ms"
        node = SubElement(root, "Experiment", name=name, description=model.doc, tolerance=repr(TOLERANCE))
        times = {"startTime": 0.0, "stopTime": stop, "stepSize": step}
        SubElement(node, standard.TRANSIENT, {key: f"{value:.12g}" for key, value in times.items()})
        SubElement(node, "References", source=path)
        given = SubElement(SubElement(node, "Annotations"), "Annotation", type=standard.SCALES)
        for output, scale in scales.items():
            SubElement(given, "Scale", name=output, value=f"{scale:.{DIGITS}g}")
    return serialized(root)
