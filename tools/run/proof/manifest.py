"""Experiments in an FMU by the layered standard FMI-LS-REF: manifest, MA-HS-Experiments, SSV and CSV files.

Older drafts of the standard state the times of experiments as attributes of `Experiment`; they are read, too.
"""

import posixpath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from jointfmu_fmu_src.proof.series import TimeSeries, parse_time_series_csv
from jointfmu_fmu_src.proof.standard import (
    CSV_MIME_TYPE,
    EXPERIMENT_PURPOSES,
    EXPERIMENTS_MIME_TYPE,
    FMI_INTERFACE_TYPES,
    INTERFACE_TYPE_LABELS,
    LAYERED_STANDARD_NAME,
    MANIFEST_ATTRIBUTE_NAMESPACE,
    MANIFEST_PATH,
    OUTPUT_SCALES_ANNOTATION_TYPE,
    SSV_MIME_TYPE,
    TRANSIENT_SIMULATION_ELEMENT,
)

from jointfmu.files.archives import FmuMembers

from . import checksum

SSV_NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
"""XML namespace of SSV files."""
_OTHER_EXPERIMENT_MIME_TYPES = ("application/x-ma-ls-experiments", "application/octet-stream")
"""Other MIME types accepted for files of experiments: in the example of the standard, and its default."""


@dataclass(frozen=True, slots=True)
class StartSetting:
    """Start value of a variable in an experiment.

    value_unit : as stated in the file; empty if not stated
    """

    start_value: float | int | bool | str
    value_unit: str


@dataclass(frozen=True, slots=True)
class Experiment:
    """Experiment of an FMU by the standard FMI-LS-REF: times, start values, inputs and reference results.

    experiment_purpose : one of EXPERIMENT_PURPOSES
    start_time, stop_time, step_size : start time, stop time and step size [s]; None: not stated
    relative_tolerance : relative tolerance of the reference results [1]; None: not stated
    start_settings : {variable: start value}
    stimuli    : inputs over time
    reference_results : reference results over time
    fmi_interfaces : FMI interfaces (co-simulation, model exchange) for which the experiment is meant
    output_scales : {output: size to which the relative tolerance refers, instead of each reference value}
    unsupported_reason : why the experiment cannot be executed by jointfmu; empty if it can
    """

    experiment_name: str
    experiment_purpose: str
    start_time: float | None = None
    stop_time: float | None = None
    step_size: float | None = None
    relative_tolerance: float | None = None
    start_settings: Mapping[str, StartSetting] = field(default_factory=dict)
    stimuli: TimeSeries | None = None
    reference_results: TimeSeries | None = None
    fmi_interfaces: Sequence[str] = FMI_INTERFACE_TYPES
    output_scales: Mapping[str, float] = field(default_factory=dict)
    unsupported_reason: str = ""


class RelatedFileReader:
    """Reader of the related files of an FMU: the files named in its manifest and experiments.

    member_contents : {path: content} of files to be read instead of the files in the FMU

    All methods raise ValueError, one line that names FMU and file, if a file is missing or broken.
    """

    def __init__(self, fmu_path: Path, member_contents: Mapping[str, bytes] | None = None) -> None:
        self.fmu_path = fmu_path
        self._fmu_members = FmuMembers(fmu_path)
        self.members: Mapping[str, bytes] = member_contents or self._fmu_members
        if MANIFEST_PATH not in self.members:
            raise ValueError(
                f"{fmu_path}: has no {MANIFEST_PATH}; expected an FMU that contains experiments (FMI-LS-REF)"
            )

    def read_experiments(self) -> list[Experiment]:
        """Read all experiments that the manifest names, in the order of the manifest."""
        with self._fmu_members.open_for_reading():
            return self._read_all_experiments()

    def _read_all_experiments(self) -> list[Experiment]:
        """Read the experiments of all related files in the manifest."""
        root = self._read_xml_root(MANIFEST_PATH)
        if (standard := root.get(f"{{{MANIFEST_ATTRIBUTE_NAMESPACE}}}fmi-ls-name")) != LAYERED_STANDARD_NAME:
            raise ValueError(
                f"{self.fmu_path}: {MANIFEST_PATH}: fmi-ls-name = {standard!r}, expected "
                f"{LAYERED_STANDARD_NAME!r}"
            )
        experiments = []
        for related in root.iter("Related"):
            self._check_checksum(related)
            role, _, purpose = related.get("role", "").partition("/")
            if role == "experiment":
                experiments += self._read_experiments(related, purpose or EXPERIMENT_PURPOSES[0])
        if not experiments:
            raise ValueError(f"{self.fmu_path}: {MANIFEST_PATH} names no experiment; expected one at least")
        return experiments

    def _check_checksum(self, related_file_element: Element) -> None:
        """Raise ValueError if a file in the FMU does not have the checksum that the manifest states.

        related_file_element : element of the manifest for the file
        """
        source = related_file_element.get("source", "")
        if urlsplit(source).scheme or (path := self._resolve_path(MANIFEST_PATH, source)) not in self.members:
            return
        try:
            checksum.check_checksum(related_file_element, self.members[path])
        except ValueError as error:
            raise ValueError(f"{self.fmu_path}: {path} {error}") from None

    def _read_experiments(self, related_file_element: Element, experiment_purpose: str) -> list[Experiment]:
        """Read the experiments in one file of the FMU, named in its manifest.

        A file of an unsupported type gives one experiment that states why it cannot be executed.
        """
        source, kind = (
            related_file_element.get("source", ""),
            related_file_element.get("type", EXPERIMENTS_MIME_TYPE),
        )
        if kind not in (EXPERIMENTS_MIME_TYPE, *_OTHER_EXPERIMENT_MIME_TYPES):
            return [
                Experiment(
                    source,
                    experiment_purpose,
                    unsupported_reason=f"its type is {kind}; only {EXPERIMENTS_MIME_TYPE} is supported",
                )
            ]
        if urlsplit(source).scheme:
            return [Experiment(source, experiment_purpose, unsupported_reason="its file is outside the FMU")]
        path = self._resolve_path(MANIFEST_PATH, source)
        labels = {label.get("name") for label in related_file_element.iter("Label")}
        interfaces = [
            name for name, label in INTERFACE_TYPE_LABELS.items() if label in labels
        ] or FMI_INTERFACE_TYPES
        nodes = self._read_xml_root(path).iter("Experiment")
        return [self._read_experiment(path, node, experiment_purpose, interfaces) for node in nodes]

    def _read_experiment(
        self,
        member_path: str,
        experiment_element: Element,
        experiment_purpose: str,
        fmi_interfaces: Sequence[str],
    ) -> Experiment:
        """Read the experiment of an XML element in the file `member_path`, with the files that it names."""
        name = experiment_element.get("name", "")
        kinds = [
            child.tag
            for child in experiment_element
            if child.tag not in ("Annotations", *_RELATED_FILE_MIME_TYPES)
        ]
        unfit = (
            f"is a {kinds[0]}; only {TRANSIENT_SIMULATION_ELEMENT} is supported"
            if kinds and kinds[0] != TRANSIENT_SIMULATION_ELEMENT
            else ""
        )
        files: dict[str, str] = {}
        for tag, kind in _RELATED_FILE_MIME_TYPES.items():
            children = experiment_element.findall(tag)
            if len(children) > 1:
                unfit = unfit or f"has {len(children)} {tag}; only one is supported"
            for child in children if not unfit else ():
                if child.get("type", kind) != kind:
                    unfit = f"has {tag} of type {child.get('type')}; only {kind} is supported"
                else:
                    files[tag] = self._resolve_path(member_path, child.get("source", ""))
        times = {
            **experiment_element.attrib,
            **getattr(experiment_element.find(TRANSIENT_SIMULATION_ELEMENT), "attrib", {}),
        }
        start, stop, step, tolerance = (
            self._parse_experiment_number(member_path, name, key, times.get(key))
            for key in ("startTime", "stopTime", "stepSize", "tolerance")
        )
        stimuli, references = (
            parse_time_series_csv(self._read_member_text(files[tag]), f"{self.fmu_path}: {files[tag]}")
            if tag in files and not unfit
            else None
            for tag in ("Stimuli", "References")
        )
        settings = (
            self._read_start_settings(files["Parameters"]) if "Parameters" in files and not unfit else {}
        )
        numbers, scales = (
            (start, stop, step, tolerance),
            self._read_output_scales(member_path, name, experiment_element),
        )
        return Experiment(
            name, experiment_purpose, *numbers, settings, stimuli, references, fmi_interfaces, scales, unfit
        )

    def _read_output_scales(
        self, member_path: str, experiment_name: str, experiment_element: Element
    ) -> dict[str, float]:
        """Read the sizes {output: size} of outputs to which the relative tolerance of an experiment refers.

        They stand in an annotation of the experiment. Raises ValueError if one is not positive.
        """
        scales = {}
        for scale in experiment_element.iterfind(
            f"Annotations/Annotation[@type='{OUTPUT_SCALES_ANNOTATION_TYPE}']/Scale"
        ):
            output = scale.get("name", "")
            value = self._parse_experiment_number(
                member_path, experiment_name, f"scale of {output}", scale.get("value", "")
            )
            if value is None or not 0.0 < value < float("inf"):
                text = (
                    f"experiment {experiment_name!r} has scale of {output} = {value}, expected a positive "
                    "number"
                )
                raise ValueError(f"{self.fmu_path}: {member_path}: {text}")
            scales[output] = value
        return scales

    def _parse_experiment_number(
        self, member_path: str, experiment_name: str, number_label: str, number_text: str | None
    ) -> float | None:
        """Parse a number of an experiment; None if it is not stated."""
        try:
            return None if number_text is None else float(number_text)
        except ValueError:
            text = (
                f"{self.fmu_path}: {member_path}: experiment {experiment_name!r} has {number_label} = "
                f"{number_text!r}, expected a number"
            )
            raise ValueError(text) from None

    def _read_start_settings(self, member_path: str) -> dict[str, StartSetting]:
        """Read the start values of an SSV file, {variable: start value}."""
        settings = {}
        for parameter in self._read_xml_root(member_path).iter(f"{{{SSV_NAMESPACE}}}Parameter"):
            name = parameter.get("name", "")
            for child in parameter:
                kind, value = child.tag.rpartition("}")[2], child.get("value", "")
                try:
                    settings[name] = StartSetting(_parse_ssv_value(kind, value), child.get("unit", ""))
                except (KeyError, ValueError):
                    raise ValueError(
                        f"{self.fmu_path}: {member_path}: {name} = {value!r} is not a {kind}"
                    ) from None
                break
        return settings

    def _resolve_path(self, base_member_path: str, source_address: str) -> str:
        """Resolve the address of a file, relative to the file that states it, to a path in the FMU.

        base_member_path : path in the FMU of the file that states the address
        """
        if urlsplit(source_address).scheme:
            raise ValueError(
                f"{self.fmu_path}: {base_member_path} names {source_address}; expected a file in the FMU"
            )
        return posixpath.normpath(
            posixpath.join(posixpath.dirname(base_member_path), unquote(source_address))
        )

    def _read_member_text(self, member_path: str) -> str:
        """Read the text of a file of the FMU that its manifest or an experiment names."""
        if member_path not in self.members:
            raise ValueError(
                f"{self.fmu_path}: has no {member_path}, which its manifest or an experiment names"
            )
        try:
            return self.members[member_path].decode("utf-8-sig")
        except UnicodeDecodeError:
            raise ValueError(f"{self.fmu_path}: {member_path} is not a text; expected UTF-8") from None

    def _read_xml_root(self, member_path: str) -> Element:
        """Read the XML root element of a file of the FMU that its manifest or an experiment names."""
        try:
            return ElementTree.fromstring(self._read_member_text(member_path))
        except ElementTree.ParseError as error:
            raise ValueError(f"{self.fmu_path}: {member_path} is not valid XML ({error})") from None


_RELATED_FILE_MIME_TYPES = {
    "Parameters": SSV_MIME_TYPE,
    "Stimuli": CSV_MIME_TYPE,
    "References": CSV_MIME_TYPE,
}
"""{child element of an experiment: MIME type of the file that it names}."""
_BOOLEAN_VALUES = {"true": True, "1": True, "false": False, "0": False}
"""{text in an SSV file: Boolean value}."""


def _parse_ssv_value(element_name: str, value_text: str) -> float | int | bool | str:
    """Parse a value of an SSV file (system structure parameter values).

    element_name : XML element, which is the type: Real, Integer, Boolean, String, ...
    """
    if element_name == "Boolean":
        return _BOOLEAN_VALUES[value_text]
    if element_name.startswith(("Integer", "Int", "UInt")):
        return int(value_text)
    return float(value_text) if element_name.startswith(("Real", "Float")) else value_text
