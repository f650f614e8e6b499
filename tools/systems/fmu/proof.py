"""Proof of a system's FMU: the reference results that it contains, by model exchange at a tight tolerance.

The FMUs of the single joints verify the joint laws against the package. The FMU of a system adds connections,
history variables and the implicit step. Its references are the same equations, integrated by CVode.
"""

from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from jointfmu_fmu_src.proof import standard
from jointfmu_fmu_src.proof.files import EXPERIMENT_TEXT_PATH, RelatedFile, proof_members
from jointfmu_fmu_src.proof.series import TimeSeries, format_csv
from jointfmu_fmu_src.proof.standard import CO_SIMULATION, MODEL_EXCHANGE
from jointfmu_fmu_src.xml_parts import serialize_xml

from jointfmu.joints.model import Model
from jointfmu.version import __version__

from ...run.host import unpack_fmu
from ...run.proof import exchange
from ...run.proof.task import ExperimentTask

OUTPUT_TOLERANCE = 5e-3
"""Tolerance of an output over its scale [1], as stated in docs/systems_explanation.md."""
REFERENCE_SOLVER_TOLERANCE = 1e-9
"""Relative tolerance of the solver for the references [1]."""
DEFAULT_SOLVER_TOLERANCE = 1e-5
"""Default relative tolerance of the solver of an importing tool [1].

The references end where results with this and with the solver tolerance differ by more than OUTPUT_TOLERANCE:
from there the motion is too sensitive to be compared.
"""
MIN_OUTPUT_SCALE_OVER_NOMINAL = 1e-2
"""Smallest scale of an output's tolerance over the nominal value of the output [1]."""
SHORT_STEP = 1e-3
"""Short communication step [s]; at most a tenth of the stop time."""
LONG_OVER_SHORT_STEP = 10
"""Long communication step over the short one [1]."""
STEPS_PER_INTERVAL = 3
"""Integrator steps of model exchange per interval of the system [1]; each is accepted as a load step."""
MAX_INTEGRATOR_STEPS = 100_000
"""Largest number of integrator steps [1]; longer experiments are cut."""
ROWS_PER_FILE = 200
"""Approximate number of rows of a result file [1]."""
JUMP_OVER_NEIGHBOUR_CHANGE = 10.0
"""Criterion of a jump: change of an output in a fine step over its changes before and after [1].

The change must also exceed OUTPUT_TOLERANCE. A stiffness jumps where the motion reverses.
"""
JUMP_NEIGHBOUR_INTERVALS = 3
"""Number of intervals next to a jump [1] in which results are not compared.

Correct steps find a reversal slightly earlier or later."""
SIGNIFICANT_DIGITS = 7
"""Significant digits of results [1]."""
_PROOF_DESCRIPTION = """\
The proof inside this FMU

The folder extra/{standard} contains the system's own experiment after FMI-LS-REF
{version}, at communication steps of {short:g} s and {long:g} s, and in model exchange. jointfmu {own}
has computed the reference results by model exchange of this FMU: CVode, relative tolerance {solver:g}, a
completed integrator step every {fine:.3g} s. They test the implicit step, not the laws: the FMUs of the
joints test the laws. They end at {end:.6g} s of {stop:g} s: at the latest where model exchange with a
tolerance of {host:g} gives other results.

How to run them
  jointfmu prove FMU
or by any importer: no value is set, steps are of stepSize.

Tolerance
  |value - reference| <= {tolerance:g} scale
The annotation of each experiment states the scale of each output: its largest reference between start and
end, or {small:g} of its nominal value if that is larger. Times within {near:.3g} s of a jump of an output are
not compared: a stiffness jumps where the motion reverses and friction sticks again.
"""
"""Text in the FMU that explains its experiments."""


def make_proof_files(model: Model, stop: float, interval: float, fmu: Path) -> dict[str, bytes]:
    """Make the files with experiments and reference results of a system's FMU, {path: content}.

    If no experiment can be run, the result is one text that says so.

    stop, interval : stop time and interval of the system's experiment [s]
    fmu            : path of the FMU, with all files that are needed to run it
    """
    step = min(SHORT_STEP, stop / LONG_OVER_SHORT_STEP)
    substeps = max(int(np.ceil(STEPS_PER_INTERVAL * step / interval - 1e-6)), 1)
    count = LONG_OVER_SHORT_STEP * max(
        min(
            int(stop / (LONG_OVER_SHORT_STEP * step) + 1e-6),
            MAX_INTEGRATOR_STEPS // (LONG_OVER_SHORT_STEP * substeps),
        ),
        1,
    )
    fine = step / substeps
    try:
        times = fine * np.arange(count * substeps + 1)
        results, coarse_results = (
            _simulate(model, fmu, times, tolerance)
            for tolerance in (REFERENCE_SOLVER_TOLERANCE, DEFAULT_SOLVER_TOLERANCE)
        )
        while (difference_row := _find_first_difference(model, results, coarse_results)) < results.time.size:
            count = (difference_row - 1) // (LONG_OVER_SHORT_STEP * substeps) * LONG_OVER_SHORT_STEP
            if not count:
                raise RuntimeError(
                    "its own experiment is too sensitive to the solver tolerance from the start"
                )
            results = _first_rows(results, count * substeps + 1)
    except Exception as error:  # fmpy raises bare Exception
        return {
            EXPERIMENT_TEXT_PATH: f"There is no proof inside this FMU: where it was built {error}\n".encode()
        }
    scales = _find_scales(model, results)
    smooth = _is_smooth(results, scales)
    short, long = (f"experiments/{model.title}_{n}_ref.csv" for n in (1, LONG_OVER_SHORT_STEP))
    members = {
        path: _result_file(results, smooth, n * substeps)
        for path, n in ((short, 1), (long, LONG_OVER_SHORT_STEP))
    }
    runs = {
        CO_SIMULATION: [(step, short), (LONG_OVER_SHORT_STEP * step, long)],
        MODEL_EXCHANGE: [(fine, short)],
    }
    related = [
        RelatedFile(
            "../../documentation/index.html", "text/html", "requirement", "what the FMU takes and gives"
        ),
        RelatedFile(f"../../{EXPERIMENT_TEXT_PATH}", "text/plain", "document", "experiments and tolerance"),
        *(
            RelatedFile(path, standard.CSV_TYPE, "result", "by model exchange at a tight tolerance")
            for path in members
        ),
    ]
    for interface, steps in runs.items():
        path = f"{interface.replace(' ', '-')}.exp"
        members[path] = _format_experiments(model, count * step, steps, scales)
        labels = {interface: "steps of stepSize"}
        related.append(
            RelatedFile(path, standard.EXPERIMENTS_TYPE, "experiment/validation", model.doc, labels)
        )
    page = _PROOF_DESCRIPTION.format(
        standard=standard.STANDARD_NAME,
        version=standard.STANDARD_VERSION,
        own=__version__,
        short=step,
        long=LONG_OVER_SHORT_STEP * step,
        solver=REFERENCE_SOLVER_TOLERANCE,
        fine=fine,
        tolerance=OUTPUT_TOLERANCE,
        small=MIN_OUTPUT_SCALE_OVER_NOMINAL,
        near=STEPS_PER_INTERVAL * JUMP_NEIGHBOUR_INTERVALS * fine,
        end=count * step,
        stop=stop,
        host=DEFAULT_SOLVER_TOLERANCE,
    )
    return proof_members(members, related, page)


def _find_scales(model: Model, results: TimeSeries) -> dict[str, float]:
    """{output: scale for its tolerance}: largest absolute value, or a share of the nominal value."""
    return {
        v.name: max(float(np.abs(results.columns[v.name]).max()), MIN_OUTPUT_SCALE_OVER_NOMINAL * v.nominal)
        for v in model.outputs
    }


def _find_first_difference(model: Model, fine_results: TimeSeries, coarse_results: TimeSeries) -> int:
    """Index of the first row at which two results of the system differ by more than OUTPUT_TOLERANCE.

    The result is the number of rows if there is no difference. Rows near jumps are not compared.
    """
    scales, rows = _find_scales(model, fine_results), fine_results.time.size
    differs = [
        np.abs(column - coarse_results.columns[name][:rows]) > OUTPUT_TOLERANCE * scales[name]
        for name, column in fine_results.columns.items()
    ]
    rows_differing = np.flatnonzero(np.any(differs, axis=0) & _is_smooth(fine_results, scales))
    return int(rows_differing[0]) if rows_differing.size else rows


def _first_rows(results: TimeSeries, row_count: int) -> TimeSeries:
    """First rows of a time series, as a new series."""
    return TimeSeries(
        results.time[:row_count], {name: column[:row_count] for name, column in results.columns.items()}
    )


def _simulate(model: Model, fmu: Path, times: np.ndarray, tolerance: float) -> TimeSeries:
    """Simulate all outputs of a system's FMU at given times by model exchange.

    Raises RuntimeError with the reason of a failure.
    """
    names, messages = [v.name for v in model.outputs], list[str]()
    if not exchange.has_cvode_solver():
        raise RuntimeError("fmpy has no solver for model exchange")
    with unpack_fmu(fmu, model_exchange=True) as (folder, _):
        task = ExperimentTask(
            str(fmu),
            folder,
            MODEL_EXCHANGE,
            times=times.tolist(),
            outputs=names,
            variable_kinds=dict.fromkeys(names, "real"),
            tolerance=tolerance,
        )
        try:
            rows = exchange.run_fmpy_exchange(task, messages)
        except Exception as error:
            raise RuntimeError(f"its own experiment failed: {messages[0] if messages else error}") from None
    return TimeSeries(times, dict(zip(names, np.array(rows).T, strict=True)))


def _is_smooth(results: TimeSeries, scales: Mapping[str, float]) -> np.ndarray:
    """Mask (n) of the rows of a result near which no output jumps."""
    jumps = np.zeros(results.time.size - 1, dtype=bool)
    for name, column in results.columns.items():
        change = np.abs(np.diff(column))
        neighbour_change = np.maximum(np.append(change[1:], 0.0), np.append(0.0, change[:-1]))
        jumps |= (change > OUTPUT_TOLERANCE * scales[name]) & (
            change > JUMP_OVER_NEIGHBOUR_CHANGE * neighbour_change
        )
    near = np.convolve(jumps, np.ones(2 * STEPS_PER_INTERVAL * JUMP_NEIGHBOUR_INTERVALS, dtype=int))[
        STEPS_PER_INTERVAL * JUMP_NEIGHBOUR_INTERVALS - 1 :
    ]
    smooth = np.asarray(near[: results.time.size] == 0)
    smooth[0] = True  # at the start nothing has changed yet
    return smooth


def _result_file(results: TimeSeries, is_smooth: np.ndarray, step: int) -> bytes:
    """CSV file of results at the ends of communication steps of `step` fine steps, about ROWS_PER_FILE rows.

    is_smooth : (n) whether a row is far from jumps; other rows are left out
    """
    rows = step * np.flatnonzero(is_smooth[::step])
    rows = rows[:: -(-rows.size // ROWS_PER_FILE)]
    columns = {name: column[rows] for name, column in results.columns.items()}
    times = np.array([float(f"{time:.12g}") for time in results.time[rows]])
    return format_csv(TimeSeries(times, columns), SIGNIFICANT_DIGITS).encode()


def _format_experiments(
    model: Model, stop: float, step_files: list[tuple[float, str]], scales: Mapping[str, float]
) -> bytes:
    """XML of the experiments with steps of given sizes [s], each with its reference file."""
    root = Element("Experiments", name=f"{model.title}, its own experiment", description=model.doc)
    for step, path in step_files:
        name = f"steps of {1e3 * step:g} ms"
        node = SubElement(
            root, "Experiment", name=name, description=model.doc, tolerance=repr(OUTPUT_TOLERANCE)
        )
        times = {"startTime": 0.0, "stopTime": stop, "stepSize": step}
        SubElement(node, standard.TRANSIENT_ELEMENT, {key: f"{value:.12g}" for key, value in times.items()})
        SubElement(node, "References", source=path)
        annotation = SubElement(SubElement(node, "Annotations"), "Annotation", type=standard.SCALES_TYPE)
        for output, scale in scales.items():
            SubElement(annotation, "Scale", name=output, value=f"{scale:.{SIGNIFICANT_DIGITS}g}")
    return serialize_xml(root)
