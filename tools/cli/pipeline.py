"""Main job: build, validate and prove all FMUs, run the ramps, compare with the papers, write the report."""

import sys
from dataclasses import dataclass, field
from pathlib import Path

from fmpy.validation import validate_fmu
from jointfmu_fmu_src.building import FLAVOUR_BUILDERS, build_fmus

from jointfmu.files.writing import write_text
from jointfmu.joints import MODELS
from jointfmu.progress import track_progress, worker_processes
from jointfmu.quantity import Array

from ..pages.laboratory.assemble import write_laboratory
from ..pages.report.figure import Figure
from ..pages.report.page import build_figures, write_report
from ..run.proof.outcome import ProofResult
from ..run.proof.run import prove
from ..run.ramps import ramp
from ..studies.checks import (
    FmuCheck,
    check_decays,
    check_free_vibrations,
    check_ramp,
    compare_build_variant,
    compute_published_numbers,
    run_default_ramp,
)
from ..studies.published import law_reference, validation
from ..systems import cosimulation, decays
from ..systems.decays import FreeDecay
from ..systems.ringing import FreeVibration, simulate_example_vibrations
from ..systems.ssp import build_system_archives
from ..systems.system import System


@dataclass(slots=True)
class PipelineResult:
    """Results of the main job `python build_fmus.py`.

    fmi2_folder                  : folder of the FMUs of FMI 2.0
    fmu_paths                    : FMUs of the joints, of all flavours
    system_files                 : system files (.ssp) and the FMUs that they add
    fmu_problems                 : errors, one line each
    load_ramps                   : {FMU: its load ramp}
    fmu_proofs                   : outputs of each FMU compared with the reference results stored in the FMU
    numerical_checks             : numerical checks of the ramps, resonances and decays
    law_comparisons              : laws compared with quadrature of their equations
    validated_points             : published numbers compared with those computed by the package
    fmu_validated_points         : published numbers compared with those computed by running FMUs
    free_vibrations, free_decays : {system: simulated free vibrations}
    arm_results                  : {name: robot arm, its simulated columns}
    report_figures               : {joint: figures of the report}
    """

    fmi2_folder: Path
    fmu_paths: list[Path] = field(default_factory=list)
    system_files: list[Path] = field(default_factory=list)
    fmu_problems: list[str] = field(default_factory=list)
    load_ramps: dict[str, ramp.RampResult] = field(default_factory=dict)
    fmu_proofs: list[ProofResult] = field(default_factory=list)
    numerical_checks: list[FmuCheck] = field(default_factory=list)
    law_comparisons: list[law_reference.LawComparison] = field(default_factory=list)
    validated_points: list[validation.ValidatedPoint] = field(default_factory=list)
    fmu_validated_points: list[validation.ValidatedPoint] = field(default_factory=list)
    free_vibrations: dict[str, list[FreeVibration]] = field(default_factory=dict)
    free_decays: dict[str, list[FreeDecay]] = field(default_factory=dict)
    arm_results: dict[str, tuple[System, dict[str, Array]]] = field(default_factory=dict)
    report_figures: dict[str, list[Figure]] = field(default_factory=dict)

    @property
    def failed_checks(self) -> list[str]:
        """Failed checks of the main job, one line each.

        A published number that an FMU does not reproduce is listed only if the package reproduces it.
        """
        lines = list(self.fmu_problems)
        lines += [
            f"{report_name_of_fmu(proof.fmu_path)}: {text}"
            for proof in self.fmu_proofs
            for text in proof.failure_messages
        ]
        lines += [
            f"{c.fmu_name}: {c.compared_quantity}: {c.deviation:.2g}, allowed {c.tolerance:.0e}"
            for c in self.numerical_checks
            if not c.is_passed
        ]
        lines += [
            f"{quantity}: differs from the quadrature of the law's equations"
            for quantity in law_reference.list_missed_quantities(self.law_comparisons)
        ]
        met = {(r.published_point.paper, r.published_point.id) for r in self.validated_points if r.has_passed}
        worse = [
            r
            for r in self.fmu_validated_points
            if not r.has_passed and (r.published_point.paper, r.published_point.id) in met
        ]
        for source, rows in (
            ("package", validation.select_missed_points(self.validated_points)),
            ("FMU", worse),
        ):
            lines += [
                f"{r.published_point.paper}: {r.published_point.id} by the {source}: published "
                f"{r.published_point.value}, computed {r.computed_value:.6g}"
                for r in rows
            ]
        return lines


def report_name_of_fmu(fmu_path: Path) -> str:
    """Name of an FMU in the report: folder of its build (fmi2, fmi3, python)/file name."""
    return f"{fmu_path.parent.name}/{fmu_path.stem}"


def run_pipeline(out_folder: Path) -> PipelineResult:
    """Build, prove and check the FMUs of all flavours; write report and laboratory page to out_folder/report.

    The report shows the ramps of the flavour `fmi2`. The ramps of the other flavours must be equal to them.
    """
    folder = out_folder / "fmi2"
    pipeline_result = PipelineResult(folder)
    with worker_processes() as pool:
        pipeline_result.fmu_paths = build_fmus(
            [], list(FLAVOUR_BUILDERS), None, out_folder, process_pool=pool
        )
        pipeline_result.system_files = build_system_archives(
            out_folder, build_joints=False, process_pool=pool
        )
        components = [path for path in pipeline_result.system_files if path.suffix == ".fmu"]
        arms = pool.submit(cosimulation.simulate_arms)
        ringdowns = pool.submit(decays.simulate_example_decays, folder)
        ringing = pool.submit(simulate_example_vibrations, folder)
        page = pool.submit(write_laboratory, out_folder / "report" / "laboratory.html")
        paths = [*pipeline_result.fmu_paths, *components]
        examined = pool.map(_validate_and_prove, paths)
        _compare_ramps(pipeline_result, out_folder)
        pipeline_result.arm_results, pipeline_result.free_decays, pipeline_result.free_vibrations = (
            arms.result(),
            ringdowns.result(),
            ringing.result(),
        )
        pipeline_result.report_figures = build_figures(
            pipeline_result
        )  # while other processes prove the FMUs
        for problems, proof in track_progress(examined, "validate and prove", len(paths)):
            pipeline_result.fmu_problems += problems
            pipeline_result.fmu_proofs.append(proof)
        pipeline_result.numerical_checks += [
            *check_free_vibrations(pipeline_result.free_vibrations),
            *check_decays(pipeline_result.free_decays),
        ]
        write_report(out_folder / "report" / "index.html", pipeline_result)
        page.result()
    return pipeline_result


def _validate_and_prove(fmu_path: Path) -> tuple[list[str], ProofResult]:
    """Validate an FMU with fmpy, and compare its outputs with the reference results stored in it (proof).

    Returns error messages of the validation, and the result of the proof.
    """
    return [f"{report_name_of_fmu(fmu_path)}: {problem}" for problem in validate_fmu(str(fmu_path))], prove(
        fmu_path
    )


def _compare_ramps(pipeline_result: PipelineResult, out_folder: Path) -> None:
    """Run and check the ramps of all FMUs, and compare with the published numbers."""
    for name in track_progress(MODELS, "ramp", len(MODELS)):
        result = run_default_ramp(name, pipeline_result.fmi2_folder)
        pipeline_result.load_ramps[name] = result
        pipeline_result.fmu_problems += [
            f"{name}: unexpected message: {text}" for text in result.log_messages
        ]
        write_text(out_folder / "report" / f"{name}.csv", result.format_time_series_csv())
        pipeline_result.numerical_checks += check_ramp(name, pipeline_result.fmi2_folder, result)
        other_folders = [
            out_folder / flavour
            for flavour in FLAVOUR_BUILDERS
            if out_folder / flavour != pipeline_result.fmi2_folder
        ]
        pipeline_result.numerical_checks += [
            compare_build_variant(name, folder, result) for folder in other_folders
        ]
    for step in track_progress(("package", "FMUs"), "compare", 2):
        if step == "package":
            pipeline_result.law_comparisons = law_reference.compare_laws()
            pipeline_result.validated_points = validation.validate_published_numbers()
        else:
            pipeline_result.fmu_validated_points = compute_published_numbers(pipeline_result.fmi2_folder)


def main(out_folder: Path) -> int:
    """Run the main job and print a summary. Returns the exit code: 0, 1 for a failure, 2 for bad input."""
    try:
        pipeline_result = run_pipeline(out_folder)
    except (ValueError, RuntimeError) as error:
        print(f"build_fmus.py: {error}", file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        print("build_fmus.py: interrupted", file=sys.stderr)
        return 130
    return print_summary(pipeline_result, out_folder)


def print_summary(pipeline_result: PipelineResult, out_folder: Path) -> int:
    """Print what was built and checked, and all failures. Returns the exit code: 0, or 1 for a failure."""
    misses = pipeline_result.failed_checks
    folders = ", ".join(str(out_folder / flavour) for flavour in FLAVOUR_BUILDERS)
    print(f"built: {len(pipeline_result.fmu_paths)} FMUs in {folders}: {', '.join(MODELS)}")
    print(
        f"systems: {', '.join(p.name for p in pipeline_result.system_files if p.suffix == '.ssp')} in "
        f"{out_folder / 'ssp'}"
    )
    partners = [path for path in pipeline_result.system_files if path.suffix == ".fmu"]
    print(
        f"validated with fmpy: {len(pipeline_result.fmu_paths) + len(partners)}; ramps run: "
        f"{len(pipeline_result.load_ramps)}"
    )
    worst = max(
        (proof.worst_point.error_over_tolerance for proof in pipeline_result.fmu_proofs if proof.worst_point),
        default=0.0,
    )
    runs = sum(proof.executed_experiment_count for proof in pipeline_result.fmu_proofs)
    print(
        f"proved in fmpy: {len(pipeline_result.fmu_proofs)} FMUs by {runs} runs of their experiments, at "
        f"worst {worst:.1e} of what is allowed"
    )
    print(
        f"compared: {law_reference.format_law_summary(pipeline_result.law_comparisons)}; "
        f"{validation.format_validation_summary(pipeline_result.validated_points)}; "
        f"{len(pipeline_result.fmu_validated_points)} of them again through the FMUs; "
        f"{len(pipeline_result.numerical_checks)} checks of the ramps"
    )
    print(
        f"report: {out_folder / 'report' / 'index.html'}; laboratory: "
        f"{out_folder / 'report' / 'laboratory.html'}"
    )
    print(f"missed: {len(misses)}")
    for line in misses:
        print(f"  {line}")
    return int(bool(misses))
