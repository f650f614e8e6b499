"""Proof of a system's FMU: the reference results that it contains, by model exchange at a tight tolerance.

The FMUs of the single joints verify the joint laws against the package. The FMU of a system adds connections,
history variables and the implicit step. Its references are the same equations, integrated by CVode.
"""

from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from jointfmu_fmu_src.proof import standard
from jointfmu_fmu_src.proof.files import (
    EXPERIMENT_TEXT_PATH,
    ManifestEntry,
    annotate_output_scales,
    place_reference_files,
)
from jointfmu_fmu_src.proof.series import TimeSeries, format_time_series_csv
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
SHORT_COMMUNICATION_STEP = 1e-3
"""Short communication step [s]; at most a tenth of the stop time."""
LONG_OVER_SHORT_STEP = 10
"""Long communication step over the short one [1]."""
STEPS_PER_INTERVAL = 3
"""Integrator steps of model exchange per interval of the system [1]; each is accepted as a load step."""
MAX_INTEGRATOR_STEPS = 100_000
"""Largest number of integrator steps [1]; longer experiments are cut."""
ROWS_PER_RESULT_FILE = 200
"""Approximate number of rows of a result file [1]."""
MIN_JUMP_OVER_NEIGHBOUR_CHANGE = 10.0
"""Criterion of a jump: change of an output in a fine step over its changes before and after [1].

The change must also exceed OUTPUT_TOLERANCE. A stiffness jumps where the motion reverses.
"""
JUMP_NEIGHBOUR_INTERVALS = 3
"""Number of intervals next to a jump [1] in which results are not compared.

Correct steps find a reversal slightly earlier or later."""
RESULT_SIGNIFICANT_DIGITS = 7
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


def make_proof_files(
    fmu_model: Model, stop_time: float, system_interval: float, fmu_path: Path
) -> dict[str, bytes]:
    """Make the files with experiments and reference results of a system's FMU, {path: content}.

    If no experiment can be run, the result is one text that says so.

    stop_time       : stop time of the system's experiment [s]
    system_interval : communication step of the system's experiment with separate FMUs [s]
    fmu_path        : FMU with all files that are needed to run it
    """
    step = min(SHORT_COMMUNICATION_STEP, stop_time / LONG_OVER_SHORT_STEP)
    substeps = max(int(np.ceil(STEPS_PER_INTERVAL * step / system_interval - 1e-6)), 1)
    count = LONG_OVER_SHORT_STEP * max(
        min(
            int(stop_time / (LONG_OVER_SHORT_STEP * step) + 1e-6),
            MAX_INTEGRATOR_STEPS // (LONG_OVER_SHORT_STEP * substeps),
        ),
        1,
    )
    fine = step / substeps
    try:
        times = fine * np.arange(count * substeps + 1)
        results, coarse_results = (
            _simulate_outputs(fmu_model, fmu_path, times, tolerance)
            for tolerance in (REFERENCE_SOLVER_TOLERANCE, DEFAULT_SOLVER_TOLERANCE)
        )
        while (
            difference_row := _find_first_differing_row(fmu_model, results, coarse_results)
        ) < results.time.size:
            count = (difference_row - 1) // (LONG_OVER_SHORT_STEP * substeps) * LONG_OVER_SHORT_STEP
            if not count:
                raise RuntimeError(
                    "its own experiment is too sensitive to the solver tolerance from the start"
                )
            results = _keep_first_rows(results, count * substeps + 1)
    except Exception as error:  # fmpy raises bare Exception
        return {
            EXPERIMENT_TEXT_PATH: f"There is no proof inside this FMU: where it was built {error}\n".encode()
        }
    scales = _find_output_scales(fmu_model, results)
    smooth = _find_smooth_rows(results, scales)
    short, long = (f"experiments/{fmu_model.title}_{n}_ref.csv" for n in (1, LONG_OVER_SHORT_STEP))
    members = {
        path: _format_result_file(results, smooth, n * substeps)
        for path, n in ((short, 1), (long, LONG_OVER_SHORT_STEP))
    }
    runs = {
        CO_SIMULATION: [(step, short), (LONG_OVER_SHORT_STEP * step, long)],
        MODEL_EXCHANGE: [(fine, short)],
    }
    related = [
        ManifestEntry(
            "../../documentation/index.html", "text/html", "requirement", "what the FMU takes and gives"
        ),
        ManifestEntry(f"../../{EXPERIMENT_TEXT_PATH}", "text/plain", "document", "experiments and tolerance"),
        *(
            ManifestEntry(path, standard.CSV_MIME_TYPE, "result", "by model exchange at a tight tolerance")
            for path in members
        ),
    ]
    for interface, steps in runs.items():
        path = f"{interface.replace(' ', '-')}.exp"
        members[path] = _format_experiments(fmu_model, count * step, steps, scales)
        labels = {interface: "steps of stepSize"}
        related.append(
            ManifestEntry(
                path, standard.EXPERIMENTS_MIME_TYPE, "experiment/validation", fmu_model.doc, labels
            )
        )
    page = _PROOF_DESCRIPTION.format(
        standard=standard.LAYERED_STANDARD_NAME,
        version=standard.LAYERED_STANDARD_VERSION,
        own=__version__,
        short=step,
        long=LONG_OVER_SHORT_STEP * step,
        solver=REFERENCE_SOLVER_TOLERANCE,
        fine=fine,
        tolerance=OUTPUT_TOLERANCE,
        small=MIN_OUTPUT_SCALE_OVER_NOMINAL,
        near=STEPS_PER_INTERVAL * JUMP_NEIGHBOUR_INTERVALS * fine,
        end=count * step,
        stop=stop_time,
        host=DEFAULT_SOLVER_TOLERANCE,
    )
    return place_reference_files(members, related, page)


def _find_output_scales(fmu_model: Model, simulation_results: TimeSeries) -> dict[str, float]:
    """{output: scale of its tolerance}: largest absolute value, at least a fraction of the nominal value."""
    return {
        v.name: max(
            float(np.abs(simulation_results.columns[v.name]).max()), MIN_OUTPUT_SCALE_OVER_NOMINAL * v.nominal
        )
        for v in fmu_model.outputs
    }


def _find_first_differing_row(fmu_model: Model, fine_results: TimeSeries, coarse_results: TimeSeries) -> int:
    """Index of the first row at which two simulations of a system differ by more than OUTPUT_TOLERANCE.

    The index is the number of rows if they do not differ. Rows near jumps are not compared.
    """
    scales, rows = _find_output_scales(fmu_model, fine_results), fine_results.time.size
    differs = [
        np.abs(column - coarse_results.columns[name][:rows]) > OUTPUT_TOLERANCE * scales[name]
        for name, column in fine_results.columns.items()
    ]
    rows_differing = np.flatnonzero(np.any(differs, axis=0) & _find_smooth_rows(fine_results, scales))
    return int(rows_differing[0]) if rows_differing.size else rows


def _keep_first_rows(simulation_results: TimeSeries, row_count: int) -> TimeSeries:
    """First rows of a time series, as a new series."""
    return TimeSeries(
        simulation_results.time[:row_count],
        {name: column[:row_count] for name, column in simulation_results.columns.items()},
    )


def _simulate_outputs(
    fmu_model: Model, fmu_path: Path, output_times: np.ndarray, solver_tolerance: float
) -> TimeSeries:
    """Simulate all outputs of a system's FMU at given times by model exchange.

    Raises RuntimeError with the reason of a failure.
    """
    names = [v.name for v in fmu_model.outputs]
    if not exchange.has_cvode_solver():
        raise RuntimeError("fmpy has no solver for model exchange")
    with unpack_fmu(fmu_path, accepts_model_exchange=True) as (folder, _):
        task = ExperimentTask(
            str(fmu_path),
            folder,
            MODEL_EXCHANGE,
            communication_points=output_times.tolist(),
            output_names=names,
            variable_data_types=dict.fromkeys(names, "real"),
            solver_tolerance=solver_tolerance,
        )
        try:
            rows = exchange.run_fmpy_model_exchange(task, [])
        except Exception as error:
            raise RuntimeError(f"its own experiment failed: {error}") from None
    return TimeSeries(output_times, dict(zip(names, np.array(rows).T, strict=True)))


def _find_smooth_rows(simulation_results: TimeSeries, output_scales: Mapping[str, float]) -> np.ndarray:
    """Mask (n) of the rows of a result near which no output jumps."""
    jumps = np.zeros(simulation_results.time.size - 1, dtype=bool)
    for name, column in simulation_results.columns.items():
        change = np.abs(np.diff(column))
        neighbour_change = np.maximum(np.append(change[1:], 0.0), np.append(0.0, change[:-1]))
        jumps |= (change > OUTPUT_TOLERANCE * output_scales[name]) & (
            change > MIN_JUMP_OVER_NEIGHBOUR_CHANGE * neighbour_change
        )
    near = np.convolve(jumps, np.ones(2 * STEPS_PER_INTERVAL * JUMP_NEIGHBOUR_INTERVALS, dtype=int))[
        STEPS_PER_INTERVAL * JUMP_NEIGHBOUR_INTERVALS - 1 :
    ]
    smooth = np.asarray(near[: simulation_results.time.size] == 0)
    smooth[0] = True  # at the start nothing has changed yet
    return smooth


def _format_result_file(
    simulation_results: TimeSeries, smooth_rows: np.ndarray, fine_steps_per_row: int
) -> bytes:
    """CSV file of simulation results, reduced to about ROWS_PER_RESULT_FILE rows.

    smooth_rows        : mask (n) of the rows that are far from jumps; other rows are left out
    fine_steps_per_row : number of solver steps in a communication step; only ends of communication steps are
        rows of the file
    """
    rows = fine_steps_per_row * np.flatnonzero(smooth_rows[::fine_steps_per_row])
    rows = rows[:: -(-rows.size // ROWS_PER_RESULT_FILE)]
    columns = {name: column[rows] for name, column in simulation_results.columns.items()}
    times = np.array([float(f"{time:.12g}") for time in simulation_results.time[rows]])
    return format_time_series_csv(TimeSeries(times, columns), RESULT_SIGNIFICANT_DIGITS).encode()


def _format_experiments(
    fmu_model: Model,
    stop_time: float,
    step_size_and_file_pairs: list[tuple[float, str]],
    output_scales: Mapping[str, float],
) -> bytes:
    """XML of the experiments with steps of given sizes [s], each with its reference file."""
    root = Element("Experiments", name=f"{fmu_model.title}, its own experiment", description=fmu_model.doc)
    for step, path in step_size_and_file_pairs:
        name = f"steps of {1e3 * step:g} ms"
        node = SubElement(
            root, "Experiment", name=name, description=fmu_model.doc, tolerance=repr(OUTPUT_TOLERANCE)
        )
        times = {"startTime": 0.0, "stopTime": stop_time, "stepSize": step}
        SubElement(
            node,
            standard.TRANSIENT_SIMULATION_ELEMENT,
            {key: f"{value:.12g}" for key, value in times.items()},
        )
        SubElement(node, "References", source=path)
        annotate_output_scales(node, output_scales)
    return serialize_xml(root)
