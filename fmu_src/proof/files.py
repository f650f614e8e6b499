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

from ..ssv import ParameterValue, format_parameter_set
from ..xml_parts import serialize_xml
from . import standard
from .experiments import ReferenceExperiment
from .reference import SIGNIFICANT_DIGITS
from .series import format_csv
from .standard import MIN_SCALE_OVER_NOMINAL, SOLVER_OVER_EXPERIMENT_TOLERANCE

REFERENCE_TOLERANCE = 1e-5
"""Relative tolerance of reference results [1].

An importer that prints six digits rounds by 5e-6. The difference between the package and the compiled law,
including the rounding of the files, is 1e-8 at boundary values of parameters and 1e-9 elsewhere (measured).
Platforms differ by 1e-12; a solver adds 4e-10 to models with states.
"""
EXPERIMENT_TEXT_PATH = "documentation/fmi-ls-ref.txt"
"""Path in an FMU of the text that explains its experiments."""
_RUN_INSTRUCTIONS = {
    standard.CO_SIMULATION: "steps of stepSize; the inputs of a step are those at its start or at its end",
    standard.MODEL_EXCHANGE: f"a solver with {SOLVER_OVER_EXPERIMENT_TOLERANCE:g} times the tolerance of the "
    "experiment as its own; a completed integrator step at each row of inputs and results",
}
"""{interface type: how an experiment is run}."""
_PURPOSE_TITLES = {
    "smoke-test": "Smoke test",
    "validation": "Load ramp, loop, shipped models, neighbours of refusals",
    "uncertainty-analysis": "Samples of all real parameters",
}
"""{purpose of experiments: heading in the explaining text}."""


class RelatedFile(NamedTuple):
    """File listed in the manifest of reference files; experiments have labels of their interface types.

    interface_labels : {interface type: how an experiment is run}
    """

    file_path: str
    mime_type: str
    role: str
    doc: str
    interface_labels: Mapping[str, str] = {}


def make_reference_files(
    model: Model,
    parameters: ParameterFile,
    shipped_variants: Sequence[tuple[ParameterFile, Mapping[str, object]]],
    experiments: Sequence[ReferenceExperiment],
    uncertainty_study: Mapping[str, str],
    is_native: bool,
) -> dict[str, bytes]:
    """Make the files of FMI-LS-REF inside an FMU: {path: content}.

    shipped_variants  : parameter files, each with the values that differ from the first
    uncertainty_study : {parameter: distribution} of the uncertainty experiments
    is_native         : whether the FMU is native: then it has model exchange and a documentation page
    """
    members: dict[str, bytes] = {}
    related: list[RelatedFile] = []
    interfaces = dict(list(_RUN_INSTRUCTIONS.items())[: 2 if is_native else 1])

    def add_file(file_path: str, mime_type: str, role: str, doc: str, file_content: bytes) -> None:
        """Add a file and its entry of the manifest."""
        members[file_path] = file_content
        labels = interfaces if mime_type == standard.EXPERIMENTS_TYPE else {}
        related.append(RelatedFile(file_path, mime_type, role, doc, labels))

    file_stem, exposed = make_slug(parameters.name), model.parameter_fields()
    if is_native:
        address = "../../documentation/index.html"
        related.append(
            RelatedFile(address, "text/html", "requirement", "what the FMU takes, gives and refuses")
        )
    add_file(
        f"parameters/{file_stem}.toml",
        "application/toml",
        "requirement",
        "each parameter with its source",
        format_parameter_file(parameters).encode(),
    )
    doc = "what the experiments are, and their tolerance"
    related.append(RelatedFile(f"../../{EXPERIMENT_TEXT_PATH}", "text/plain", "document", doc))
    for file, _ in shipped_variants:
        values = {name: value for name, value in flatten_parameters(file.values).items() if name in exposed}
        content = _format_parameter_set(model, file.name, values)
        add_file(f"parameters/{make_slug(file.name)}.ssv", standard.SSV_TYPE, "parameter", file.name, content)
    if uncertainty_study:
        lines = [f"{json.dumps(name)} = {json.dumps(law)}" for name, law in uncertainty_study.items()]
        content = "\n".join(["schema = 1", "", "[parameters]", *lines, ""]).encode()
        doc = "distributions of the uncertainty experiment"
        add_file("parameters/study.toml", "application/toml", "method", doc, content)
    for purpose in dict.fromkeys(experiment.purpose for experiment in experiments):
        numbered = [
            (i, experiment) for i, experiment in enumerate(experiments) if experiment.purpose == purpose
        ]
        root = Element("Experiments", name=_PURPOSE_TITLES[purpose], description=model.doc)
        series: dict[str, bytes] = {}
        for i, experiment in numbered:
            series |= _declare_experiment(model, root, f"{i:02d}", experiment, members | series)
        content = serialize_xml(root)
        add_file(
            f"{purpose}.exp",
            standard.EXPERIMENTS_TYPE,
            f"experiment/{purpose}",
            _PURPOSE_TITLES[purpose],
            content,
        )
        members |= series
        for path in series:
            if path.endswith("_ref.csv"):
                related.append(
                    RelatedFile(path, standard.CSV_TYPE, "result", "reference result of the package")
                )
    return proof_members(members, related, _format_experiment_text(file_stem, experiments, is_native))


def proof_members(
    members: Mapping[str, bytes], related_files: Sequence[RelatedFile], page_text: str
) -> dict[str, bytes]:
    """Place reference files, their manifest and the explaining page: {path in the FMU: content}."""
    files = {**members, "fmi-ls-manifest.xml": _format_manifest(related_files)}
    return {f"{standard.REFERENCE_FOLDER}/{path}": content for path, content in files.items()} | {
        EXPERIMENT_TEXT_PATH: page_text.encode()
    }


def make_slug(name: str) -> str:
    """Convert a name to lower case letters, digits and _, for file names; at most 40 characters."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:40].strip("_") or "parameters"


def _declare_experiment(
    model: Model,
    root_element: Element,
    experiment_number: str,
    experiment: ReferenceExperiment,
    known_files: Mapping[str, bytes],
) -> dict[str, bytes]:
    """Declare an experiment below `root_element`, and return its new files {path: content}.

    known_files : files of other experiments; equal inputs are not stored twice
    """
    stem = f"experiments/{experiment_number}_{make_slug(experiment.name)}"
    stimuli = format_csv(experiment.stimulus.input_series).encode()
    equal_inputs = (
        path for path, content in known_files.items() if path.endswith("_in.csv") and content == stimuli
    )
    files = {"Stimuli": next(equal_inputs, f"{stem}_in.csv"), "References": f"{stem}_ref.csv"}
    contents = {
        files["Stimuli"]: stimuli,
        files["References"]: format_csv(experiment.results, SIGNIFICANT_DIGITS).encode(),
    }
    if experiment.variable_values:
        files = {"Parameters": f"{stem}.ssv", **files}
        contents[files["Parameters"]] = _format_parameter_set(
            model, experiment.name, experiment.variable_values
        )
    node = SubElement(
        root_element,
        "Experiment",
        name=experiment.name,
        description=experiment.doc,
        tolerance=repr(REFERENCE_TOLERANCE),
    )
    times = {
        "startTime": 0.0,
        "stopTime": float(experiment.stimulus.sampling_instants[-1]),
        "stepSize": 0.5 * experiment.stimulus.sampling_interval,
    }
    SubElement(node, standard.TRANSIENT_ELEMENT, {name: repr(time) for name, time in times.items()})
    for tag, path in files.items():
        SubElement(node, tag, source=path)
    return {path: content for path, content in contents.items() if path not in known_files}


def _format_parameter_set(
    model: Model, parameter_set_name: str, value_by_name: Mapping[str, object]
) -> bytes:
    """Content of an SSV file with values of parameters and inputs of a model."""
    units = {v.name: v.unit for v in model.inputs}
    units |= {n: item.metadata.get("unit", "") for n, item in model.parameter_fields().items()}
    return format_parameter_set(
        parameter_set_name, {n: ParameterValue(value, units[n]) for n, value in value_by_name.items()}
    )


def _format_manifest(related_files: Sequence[RelatedFile]) -> bytes:
    """Format the manifest of the reference files (layered standard FMI-LS-REF) as XML."""
    head = {
        "name": standard.STANDARD_NAME,
        "version": standard.STANDARD_VERSION,
        "description": standard.STANDARD_DESCRIPTION,
    }
    root = Element("fmiReferences", {"xmlns:fmi-ls": standard.ATTRIBUTE_NAMESPACE})
    root.attrib |= {f"fmi-ls:fmi-ls-{name}": value for name, value in head.items()}
    for file in related_files:
        attributes = {
            "type": file.mime_type,
            "source": file.file_path,
            "role": file.role,
            "description": file.doc,
        }
        node = SubElement(root, "Related", attributes)
        for interface, doc in file.interface_labels.items():
            SubElement(node, "Label", name=standard.INTERFACE_LABELS[interface], description=doc)
    return serialize_xml(root)


def _format_experiment_text(
    file_stem: str, experiments: Sequence[ReferenceExperiment], is_native: bool
) -> str:
    """Text that explains the experiments of an FMU."""
    counts = {
        p: sum(experiment.purpose == p for experiment in experiments) for p in standard.EXPERIMENT_PURPOSES
    }
    page = Path(__file__).with_name("page.txt").read_text(encoding="utf-8")
    return page.format(
        standard=standard.STANDARD_NAME,
        version=standard.STANDARD_VERSION,
        own=__version__,
        counts="\n".join(f"{count:4d} {purpose}" for purpose, count in counts.items() if count),
        tolerance=REFERENCE_TOLERANCE,
        solver=SOLVER_OVER_EXPERIMENT_TOLERANCE * REFERENCE_TOLERANCE,
        floor=MIN_SCALE_OVER_NOMINAL,
        page="documentation/index.html" if is_native else "modelDescription.xml",
        file=file_stem,
    )
