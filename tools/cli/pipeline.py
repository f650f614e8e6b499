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
from ..run.proof.outcome import Proof
from ..run.proof.run import prove
from ..run.ramps import ramp
from ..studies.checks import (
    Check,
    check_decays,
    check_free_vibrations,
    check_ramp,
    compare_flavour,
    compute_published_points,
    run_default_ramp,
)
from ..studies.published import law_reference, validation
from ..systems import cosimulation, decays
from ..systems.decays import Decay
from ..systems.ringing import FreeVibration, simulate_example_vibrations
from ..systems.ssp import build_systems
from ..systems.system import System


@dataclass(slots=True)
class PipelineResult:
    """Results of the main job `python build_fmus.py`.

    fmi2_folder : folder of the FMUs of FMI 2.0
    fmu_paths   : FMUs of the joints, of all flavours
    system_files : system files (.ssp) and the FMUs that they add
    problems    : errors, one line each
    ramps       : {FMU: its load ramp}
    proofs : results of the experiments stored in each FMU, against their references
    checks      : numerical checks of the ramps, resonances and decays
    law_comparisons : laws compared with quadrature of their equations
    validated_points : published points, computed by the package
    fmu_validated_points : published points, computed by running FMUs
    free_vibrations, decays : {system: simulated free vibrations}
    arm_results : {name: robot arm, its simulated columns}
    figures     : {joint: figures of the report}
    """

    fmi2_folder: Path
    fmu_paths: list[Path] = field(default_factory=list)
    system_files: list[Path] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    ramps: dict[str, ramp.RampResult] = field(default_factory=dict)
    proofs: list[Proof] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    law_comparisons: list[law_reference.LawComparison] = field(default_factory=list)
    validated_points: list[validation.ValidatedPoint] = field(default_factory=list)
    fmu_validated_points: list[validation.ValidatedPoint] = field(default_factory=list)
    free_vibrations: dict[str, list[FreeVibration]] = field(default_factory=dict)
    decays: dict[str, list[Decay]] = field(default_factory=dict)
    arm_results: dict[str, tuple[System, dict[str, Array]]] = field(default_factory=dict)
    figures: dict[str, list[Figure]] = field(default_factory=dict)

    @property
    def failures(self) -> list[str]:
        """Failed checks of the main job, one line each.

        A published point that an FMU misses is listed only if the package meets it.
        """
        lines = list(self.problems)
        lines += [f"{report_name(proof.fmu)}: {text}" for proof in self.proofs for text in proof.failures]
        lines += [
            f"{c.fmu}: {c.compared_quantity}: {c.deviation:.2g}, allowed {c.tolerance:.0e}"
            for c in self.checks
            if not c.is_passed
        ]
        lines += [
            f"{quantity}: differs from the quadrature of the law's equations"
            for quantity in law_reference.missed_quantities(self.law_comparisons)
        ]
        met = {(r.point.paper, r.point.id) for r in self.validated_points if r.has_passed}
        worse = [
            r for r in self.fmu_validated_points if not r.has_passed and (r.point.paper, r.point.id) in met
        ]
        for source, rows in (("package", validation.missed_points(self.validated_points)), ("FMU", worse)):
            lines += [
                f"{r.point.paper}: {r.point.id} by the {source}: published {r.point.value}, "
                f"computed {r.computed_value:.6g}"
                for r in rows
            ]
        return lines


def report_name(fmu: Path) -> str:
    """Name of an FMU in the report: folder of its build (fmi2, fmi3, python)/file name."""
    return f"{fmu.parent.name}/{fmu.stem}"


def run_pipeline(out_folder: Path) -> PipelineResult:
    """Build, prove and check the FMUs of all flavours; write report and laboratory page to out_folder/report.

    The report shows the ramps of the flavour `fmi2`. The ramps of the other flavours must be equal to them.
    """
    folder = out_folder / "fmi2"
    outcome = PipelineResult(folder)
    with worker_processes() as pool:
        outcome.fmu_paths = build_fmus([], list(FLAVOUR_BUILDERS), None, out_folder, pool=pool)
        outcome.system_files = build_systems(out_folder, build_joints=False, pool=pool)
        components = [path for path in outcome.system_files if path.suffix == ".fmu"]
        arms = pool.submit(cosimulation.simulate_arms)
        ringdowns = pool.submit(decays.simulate_example_decays, folder)
        ringing = pool.submit(simulate_example_vibrations, folder)
        page = pool.submit(write_laboratory, out_folder / "report" / "laboratory.html")
        paths = [*outcome.fmu_paths, *components]
        examined = pool.map(_validate_and_prove, paths)
        _compare_ramps(outcome, out_folder)
        outcome.arm_results, outcome.decays, outcome.free_vibrations = (
            arms.result(),
            ringdowns.result(),
            ringing.result(),
        )
        outcome.figures = build_figures(outcome)  # while other processes prove the FMUs
        for problems, proof in track_progress(examined, "validate and prove", len(paths)):
            outcome.problems += problems
            outcome.proofs.append(proof)
        outcome.checks += [*check_free_vibrations(outcome.free_vibrations), *check_decays(outcome.decays)]
        write_report(out_folder / "report" / "index.html", outcome)
        page.result()
    return outcome


def _validate_and_prove(path: Path) -> tuple[list[str], Proof]:
    """Validate an FMU with fmpy and run the experiments stored in it.

    Returns problems, and results of the experiments (the proof).
    """
    return [f"{report_name(path)}: {problem}" for problem in validate_fmu(str(path))], prove(path)


def _compare_ramps(pipeline_result: PipelineResult, out_folder: Path) -> None:
    """Run and check the ramps of all FMUs, and compare with the published numbers."""
    for name in track_progress(MODELS, "ramp", len(MODELS)):
        result = run_default_ramp(name, pipeline_result.fmi2_folder)
        pipeline_result.ramps[name] = result
        pipeline_result.problems += [f"{name}: unexpected message: {text}" for text in result.messages]
        write_text(out_folder / "report" / f"{name}.csv", result.format_csv())
        pipeline_result.checks += check_ramp(name, pipeline_result.fmi2_folder, result)
        other_folders = [
            out_folder / flavour
            for flavour in FLAVOUR_BUILDERS
            if out_folder / flavour != pipeline_result.fmi2_folder
        ]
        pipeline_result.checks += [compare_flavour(name, folder, result) for folder in other_folders]
    for step in track_progress(("package", "FMUs"), "compare", 2):
        if step == "package":
            pipeline_result.law_comparisons = law_reference.compare_laws()
            pipeline_result.validated_points = validation.validate()
        else:
            pipeline_result.fmu_validated_points = compute_published_points(pipeline_result.fmi2_folder)


def main(out_folder: Path) -> int:
    """Run the main job and print a summary. Returns the exit code: 0, 1 for a failure, 2 for bad input."""
    try:
        outcome = run_pipeline(out_folder)
    except (ValueError, RuntimeError) as error:
        print(f"build_fmus.py: {error}", file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        print("build_fmus.py: interrupted", file=sys.stderr)
        return 130
    return print_summary(outcome, out_folder)


def print_summary(outcome: PipelineResult, out_folder: Path) -> int:
    """Print what was built and checked, and all failures. Returns the exit code: 0, or 1 for a failure."""
    misses = outcome.failures
    folders = ", ".join(str(out_folder / flavour) for flavour in FLAVOUR_BUILDERS)
    print(f"built: {len(outcome.fmu_paths)} FMUs in {folders}: {', '.join(MODELS)}")
    print(
        f"systems: {', '.join(p.name for p in outcome.system_files if p.suffix == '.ssp')} in "
        f"{out_folder / 'ssp'}"
    )
    partners = [path for path in outcome.system_files if path.suffix == ".fmu"]
    print(f"validated with fmpy: {len(outcome.fmu_paths) + len(partners)}; ramps run: {len(outcome.ramps)}")
    worst = max((proof.worst_point.error_ratio for proof in outcome.proofs if proof.worst_point), default=0.0)
    runs = sum(proof.executed_experiment_count for proof in outcome.proofs)
    print(
        f"proved in fmpy: {len(outcome.proofs)} FMUs by {runs} runs of their experiments, "
        f"at worst {worst:.1e} of what is allowed"
    )
    print(
        f"compared: {law_reference.format_law_summary(outcome.law_comparisons)}; "
        f"{validation.format_summary(outcome.validated_points)}; "
        f"{len(outcome.fmu_validated_points)} of them again through the FMUs; {len(outcome.checks)} "
        "checks of the ramps"
    )
    print(
        f"report: {out_folder / 'report' / 'index.html'}; laboratory: "
        f"{out_folder / 'report' / 'laboratory.html'}"
    )
    print(f"missed: {len(misses)}")
    for line in misses:
        print(f"  {line}")
    return int(bool(misses))
