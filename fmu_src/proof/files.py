"""Files of FMI-LS-REF: manifest, experiments (MA-HS-Experiments), parameter sets (SSV), time series, text."""

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, format_parameter_file
from jointfmu.quantity import flatten_parameters
from jointfmu.version import __version__

from ..ssv import ParameterValue, format_ssv_parameter_set
from ..xml_parts import serialize_xml
from . import standard
from .experiments import ReferenceExperiment
from .reference import RESULT_SIGNIFICANT_DIGITS
from .series import format_time_series_csv
from .standard import MIN_TOLERANCE_SCALE_OVER_NOMINAL, SOLVER_TOLERANCE_OVER_EXPERIMENT_TOLERANCE

REFERENCE_TOLERANCE = 1e-5
"""Relative tolerance of reference results [1].

An importer that prints six digits rounds by 5e-6. The difference between the package and the compiled law,
including the rounding of the files, is 1e-8 at boundary values of parameters and 1e-9 elsewhere (measured).
Platforms differ by 1e-12; a solver adds 4e-10 to models with states.
"""
EXPERIMENT_TEXT_PATH = "documentation/fmi-ls-ref.txt"
"""Path in an FMU of the text that explains its experiments."""
_EXPERIMENT_RUN_INSTRUCTIONS = {
    standard.CO_SIMULATION: "steps of stepSize; the inputs of a step are those at its start or at its end",
    standard.MODEL_EXCHANGE: f"a solver with {SOLVER_TOLERANCE_OVER_EXPERIMENT_TOLERANCE:g} times the "
    "tolerance of the experiment as its own; a completed integrator step at each row of inputs and results",
}
"""{interface type: how an experiment is run}."""
_EXPERIMENT_PURPOSE_TITLES = {
    "smoke-test": "Smoke test",
    "validation": "Load ramp, loop, shipped models, neighbours of refusals",
    "uncertainty-analysis": "Samples of all real parameters",
}
"""{purpose of experiments: heading in the explaining text}."""


class ManifestEntry(NamedTuple):
    """Entry of the manifest of reference files.

    interface_labels : {interface type: how an experiment is run}; only for files of experiments
    """

    file_path: str
    mime_type: str
    manifest_role: str
    file_description: str
    interface_labels: Mapping[str, str] = {}


def make_reference_files(
    fmu_model: Model,
    parameter_file: ParameterFile,
    shipped_variants: Sequence[tuple[ParameterFile, Mapping[str, object]]],
    reference_experiments: Sequence[ReferenceExperiment],
    uncertainty_study: Mapping[str, str],
    is_native: bool,
) -> dict[str, bytes]:
    """Make the reference files inside an FMU, {path: content}, after the layered standard FMI-LS-REF.

    shipped_variants  : (parameter file, {parameter: value that differs from the first file})
    uncertainty_study : {parameter: distribution} of the uncertainty experiments
    is_native         : whether the FMU is native: then it has model exchange and a documentation page
    """
    members: dict[str, bytes] = {}
    related: list[ManifestEntry] = []
    interfaces = dict(list(_EXPERIMENT_RUN_INSTRUCTIONS.items())[: 2 if is_native else 1])

    def add_file(
        file_path: str, mime_type: str, manifest_role: str, file_description: str, file_content: bytes
    ) -> None:
        """Add a reference file and its entry of the manifest."""
        members[file_path] = file_content
        labels = interfaces if mime_type == standard.EXPERIMENTS_MIME_TYPE else {}
        related.append(ManifestEntry(file_path, mime_type, manifest_role, file_description, labels))

    file_stem, exposed = make_file_name_slug(parameter_file.name), fmu_model.parameter_fields()
    if is_native:
        address = "../../documentation/index.html"
        related.append(
            ManifestEntry(address, "text/html", "requirement", "what the FMU takes, gives and refuses")
        )
    add_file(
        f"parameters/{file_stem}.toml",
        "application/toml",
        "requirement",
        "each parameter with its source",
        format_parameter_file(parameter_file).encode(),
    )
    doc = "what the experiments are, and their tolerance"
    related.append(ManifestEntry(f"../../{EXPERIMENT_TEXT_PATH}", "text/plain", "document", doc))
    for file, _ in shipped_variants:
        values = {name: value for name, value in flatten_parameters(file.values).items() if name in exposed}
        content = _format_parameter_set(fmu_model, file.name, values)
        add_file(
            f"parameters/{make_file_name_slug(file.name)}.ssv",
            standard.SSV_MIME_TYPE,
            "parameter",
            file.name,
            content,
        )
    if uncertainty_study:
        lines = [f"{json.dumps(name)} = {json.dumps(law)}" for name, law in uncertainty_study.items()]
        content = "\n".join(["schema = 1", "", "[parameters]", *lines, ""]).encode()
        doc = "distributions of the uncertainty experiment"
        add_file("parameters/study.toml", "application/toml", "method", doc, content)
    for purpose in dict.fromkeys(experiment.experiment_purpose for experiment in reference_experiments):
        numbered = [
            (i, experiment)
            for i, experiment in enumerate(reference_experiments)
            if experiment.experiment_purpose == purpose
        ]
        root = Element("Experiments", name=_EXPERIMENT_PURPOSE_TITLES[purpose], description=fmu_model.doc)
        series: dict[str, bytes] = {}
        for i, experiment in numbered:
            series |= _declare_experiment(fmu_model, root, f"{i:02d}", experiment, members | series)
        content = serialize_xml(root)
        add_file(
            f"{purpose}.exp",
            standard.EXPERIMENTS_MIME_TYPE,
            f"experiment/{purpose}",
            _EXPERIMENT_PURPOSE_TITLES[purpose],
            content,
        )
        members |= series
        for path in series:
            if path.endswith("_ref.csv"):
                related.append(
                    ManifestEntry(path, standard.CSV_MIME_TYPE, "result", "reference result of the package")
                )
    return place_reference_files(
        members, related, _format_experiment_text(file_stem, reference_experiments, is_native)
    )


def place_reference_files(
    reference_files: Mapping[str, bytes], manifest_entries: Sequence[ManifestEntry], explaining_text: str
) -> dict[str, bytes]:
    """Collect reference files, their manifest and a text that explains them: {path in the FMU: content}."""
    files = {**reference_files, "fmi-ls-manifest.xml": _format_manifest(manifest_entries)}
    return {f"{standard.REFERENCE_FILE_FOLDER}/{path}": content for path, content in files.items()} | {
        EXPERIMENT_TEXT_PATH: explaining_text.encode()
    }


def make_file_name_slug(display_name: str) -> str:
    """Convert a text to a file name of lower case letters, digits and _; at most 40 characters."""
    return re.sub(r"[^a-z0-9]+", "_", display_name.lower()).strip("_")[:40].strip("_") or "parameters"


def _declare_experiment(
    fmu_model: Model,
    root_element: Element,
    experiment_number: str,
    experiment: ReferenceExperiment,
    stored_files: Mapping[str, bytes],
) -> dict[str, bytes]:
    """Add an experiment to an XML file of reference experiments; return its new data files {path: content}.

    stored_files : files of other experiments; equal input series are not stored twice
    """
    stem = f"experiments/{experiment_number}_{make_file_name_slug(experiment.experiment_name)}"
    stimuli = format_time_series_csv(experiment.input_stimulus.input_time_series).encode()
    equal_inputs = (
        path for path, content in stored_files.items() if path.endswith("_in.csv") and content == stimuli
    )
    files = {"Stimuli": next(equal_inputs, f"{stem}_in.csv"), "References": f"{stem}_ref.csv"}
    contents = {
        files["Stimuli"]: stimuli,
        files["References"]: format_time_series_csv(
            experiment.reference_results, RESULT_SIGNIFICANT_DIGITS
        ).encode(),
    }
    if experiment.variable_values:
        files = {"Parameters": f"{stem}.ssv", **files}
        contents[files["Parameters"]] = _format_parameter_set(
            fmu_model, experiment.experiment_name, experiment.variable_values
        )
    node = SubElement(
        root_element,
        "Experiment",
        name=experiment.experiment_name,
        description=experiment.experiment_description,
        tolerance=repr(REFERENCE_TOLERANCE),
    )
    times = {
        "startTime": 0.0,
        "stopTime": float(experiment.input_stimulus.sampling_instants[-1]),
        "stepSize": 0.5 * experiment.input_stimulus.sampling_interval,
    }
    SubElement(
        node, standard.TRANSIENT_SIMULATION_ELEMENT, {name: repr(time) for name, time in times.items()}
    )
    for tag, path in files.items():
        SubElement(node, tag, source=path)
    if experiment.output_scales:
        annotate_output_scales(node, experiment.output_scales)
    return {path: content for path, content in contents.items() if path not in stored_files}


def annotate_output_scales(experiment_element: Element, output_scales: Mapping[str, float]) -> None:
    """Add the annotation of an experiment that states the scales {output: size} of its tolerances."""
    annotation = SubElement(
        SubElement(experiment_element, "Annotations"),
        "Annotation",
        type=standard.OUTPUT_SCALES_ANNOTATION_TYPE,
    )
    for output, scale in output_scales.items():
        SubElement(annotation, "Scale", name=output, value=f"{scale:.{RESULT_SIGNIFICANT_DIGITS}g}")


def _format_parameter_set(
    fmu_model: Model, parameter_set_name: str, value_by_name: Mapping[str, object]
) -> bytes:
    """Format an SSV file (parameter set) with values of parameters and inputs of an FMU."""
    units = {v.name: v.unit for v in fmu_model.inputs}
    units |= {n: item.metadata.get("unit", "") for n, item in fmu_model.parameter_fields().items()}
    return format_ssv_parameter_set(
        parameter_set_name, {n: ParameterValue(value, units[n]) for n, value in value_by_name.items()}
    )


def _format_manifest(manifest_entries: Sequence[ManifestEntry]) -> bytes:
    """Format the manifest of the reference files (layered standard FMI-LS-REF) as XML."""
    head = {
        "name": standard.LAYERED_STANDARD_NAME,
        "version": standard.LAYERED_STANDARD_VERSION,
        "description": standard.LAYERED_STANDARD_DESCRIPTION,
    }
    root = Element("fmiReferences", {"xmlns:fmi-ls": standard.MANIFEST_ATTRIBUTE_NAMESPACE})
    root.attrib |= {f"fmi-ls:fmi-ls-{name}": value for name, value in head.items()}
    for file in manifest_entries:
        attributes = {
            "type": file.mime_type,
            "source": file.file_path,
            "role": file.manifest_role,
            "description": file.file_description,
        }
        node = SubElement(root, "Related", attributes)
        for interface, doc in file.interface_labels.items():
            SubElement(node, "Label", name=standard.INTERFACE_TYPE_LABELS[interface], description=doc)
    return serialize_xml(root)


def _format_experiment_text(
    parameter_file_stem: str, reference_experiments: Sequence[ReferenceExperiment], is_native: bool
) -> str:
    """Format the text file that explains the experiments of an FMU."""
    counts = {
        p: sum(experiment.experiment_purpose == p for experiment in reference_experiments)
        for p in standard.EXPERIMENT_PURPOSES
    }
    page = Path(__file__).with_name("page.txt").read_text(encoding="utf-8")
    return page.format(
        standard=standard.LAYERED_STANDARD_NAME,
        version=standard.LAYERED_STANDARD_VERSION,
        own=__version__,
        counts="\n".join(f"{count:4d} {purpose}" for purpose, count in counts.items() if count),
        tolerance=REFERENCE_TOLERANCE,
        solver=SOLVER_TOLERANCE_OVER_EXPERIMENT_TOLERANCE * REFERENCE_TOLERANCE,
        floor=MIN_TOLERANCE_SCALE_OVER_NOMINAL,
        scales=standard.OUTPUT_SCALES_ANNOTATION_TYPE,
        page="documentation/index.html" if is_native else "modelDescription.xml",
        file=parameter_file_stem,
    )
