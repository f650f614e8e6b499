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

from jointfmu_fmu_src.proof.series import TimeSeries, parse_csv
from jointfmu_fmu_src.proof.standard import (
    ATTRIBUTE_NAMESPACE,
    CSV_TYPE,
    EXPERIMENT_PURPOSES,
    EXPERIMENTS_TYPE,
    INTERFACE_LABELS,
    INTERFACE_TYPES,
    MANIFEST_PATH,
    SCALES_TYPE,
    SSV_TYPE,
    STANDARD_NAME,
    TRANSIENT_ELEMENT,
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

    unit : as stated in the file; empty if not stated
    """

    value: float | int | bool | str
    unit: str


@dataclass(frozen=True, slots=True)
class Experiment:
    """Experiment of an FMU by FMI-LS-REF: times, start values, inputs and reference results.

    purpose    : one of PURPOSES
    start, stop, step : start time, stop time and step size [s]; None: not stated
    tolerance  : relative tolerance of the reference results [1]; None: not stated
    settings   : {variable: start value}
    stimuli    : inputs over time
    references : reference results over time
    interfaces : FMI interfaces for which the experiment is meant
    output_scales : {output: size to which the relative tolerance refers, instead of each reference value}
    unsupported_reason : why the experiment cannot be executed by jointfmu; empty if it can
    """

    name: str
    purpose: str
    start: float | None = None
    stop: float | None = None
    step: float | None = None
    tolerance: float | None = None
    settings: Mapping[str, StartSetting] = field(default_factory=dict)
    stimuli: TimeSeries | None = None
    references: TimeSeries | None = None
    interfaces: Sequence[str] = INTERFACE_TYPES
    output_scales: Mapping[str, float] = field(default_factory=dict)
    unsupported_reason: str = ""


class RelatedFiles:
    """Reader of the related files of an FMU: the files named in its manifest and experiments.

    member_contents : {path: content} of files to be read instead of the files in the FMU

    All methods raise ValueError, one line that names FMU and file, if a file is missing or broken.
    """

    def __init__(self, fmu: Path, member_contents: Mapping[str, bytes] | None = None) -> None:
        self.fmu = fmu
        self._fmu_members = FmuMembers(fmu)
        self.members: Mapping[str, bytes] = member_contents or self._fmu_members
        if MANIFEST_PATH not in self.members:
            raise ValueError(
                f"{fmu}: has no {MANIFEST_PATH}; expected an FMU with experiments after FMI-LS-REF"
            )

    def read_experiments(self) -> list[Experiment]:
        """Read all experiments that the manifest names, in the order of the manifest."""
        with self._fmu_members.open_for_reading():
            return self._read_all_experiments()

    def _read_all_experiments(self) -> list[Experiment]:
        """Yield the experiments of all related files in the manifest."""
        root = self._read_xml(MANIFEST_PATH)
        if (standard := root.get(f"{{{ATTRIBUTE_NAMESPACE}}}fmi-ls-name")) != STANDARD_NAME:
            raise ValueError(f"{self.fmu}: {MANIFEST_PATH} is of {standard!r}, expected {STANDARD_NAME!r}")
        experiments = []
        for related in root.iter("Related"):
            self._check_checksum(related)
            role, _, purpose = related.get("role", "").partition("/")
            if role == "experiment":
                experiments += self._read_experiments(related, purpose or EXPERIMENT_PURPOSES[0])
        if not experiments:
            raise ValueError(f"{self.fmu}: {MANIFEST_PATH} names no experiment; expected one at least")
        return experiments

    def _check_checksum(self, file_element: Element) -> None:
        """Compare a related file in the FMU with its checksum, if the manifest states one.

        file_element : element of the manifest

        Raises ValueError if they differ.
        """
        source = file_element.get("source", "")
        if urlsplit(source).scheme or (path := self._resolve_path(MANIFEST_PATH, source)) not in self.members:
            return
        try:
            checksum.check_checksum(file_element, self.members[path])
        except ValueError as error:
            raise ValueError(f"{self.fmu}: {path} {error}") from None

    def _read_experiments(self, file_element: Element, purpose: str) -> list[Experiment]:
        """Read the experiments in a related file of the FMU.

        A file of an unsupported type gives one experiment that states why it cannot be executed.
        """
        source, kind = file_element.get("source", ""), file_element.get("type", EXPERIMENTS_TYPE)
        if kind not in (EXPERIMENTS_TYPE, *_OTHER_EXPERIMENT_MIME_TYPES):
            return [
                Experiment(
                    source, purpose, unsupported_reason=f"is of type {kind}, {EXPERIMENTS_TYPE} is read"
                )
            ]
        if urlsplit(source).scheme:
            return [Experiment(source, purpose, unsupported_reason="lies outside of the FMU")]
        path = self._resolve_path(MANIFEST_PATH, source)
        labels = {label.get("name") for label in file_element.iter("Label")}
        interfaces = [name for name, label in INTERFACE_LABELS.items() if label in labels] or INTERFACE_TYPES
        nodes = self._read_xml(path).iter("Experiment")
        return [self._read_experiment(path, node, purpose, interfaces) for node in nodes]

    def _read_experiment(
        self, path: str, element: Element, purpose: str, interfaces: Sequence[str]
    ) -> Experiment:
        """Read the experiment of an XML element in the file `path`, with the files that it names."""
        name = element.get("name", "")
        kinds = [
            child.tag for child in element if child.tag not in ("Annotations", *_RELATED_FILE_MIME_TYPES)
        ]
        unfit = f"is a {kinds[0]}" if kinds and kinds[0] != TRANSIENT_ELEMENT else ""
        files: dict[str, str] = {}
        for tag, kind in _RELATED_FILE_MIME_TYPES.items():
            children = element.findall(tag)
            if len(children) > 1:
                unfit = unfit or f"has {len(children)} {tag}, one is read"
            for child in children if not unfit else ():
                if child.get("type", kind) != kind:
                    unfit = f"has {tag} of type {child.get('type')}, {kind} is read"
                else:
                    files[tag] = self._resolve_path(path, child.get("source", ""))
        times = {**element.attrib, **getattr(element.find(TRANSIENT_ELEMENT), "attrib", {})}
        start, stop, step, tolerance = (
            self._parse_number(path, name, key, times.get(key))
            for key in ("startTime", "stopTime", "stepSize", "tolerance")
        )
        stimuli, references = (
            parse_csv(self._read_text(files[tag]), f"{self.fmu}: {files[tag]}")
            if tag in files and not unfit
            else None
            for tag in ("Stimuli", "References")
        )
        settings = self._read_settings(files["Parameters"]) if "Parameters" in files and not unfit else {}
        numbers, scales = (start, stop, step, tolerance), self._read_output_scales(path, name, element)
        return Experiment(name, purpose, *numbers, settings, stimuli, references, interfaces, scales, unfit)

    def _read_output_scales(self, path: str, experiment_name: str, element: Element) -> dict[str, float]:
        """Scales {output: scale} in the annotation of an experiment; ValueError if one is not positive."""
        scales = {}
        for scale in element.iterfind(f"Annotations/Annotation[@type='{SCALES_TYPE}']/Scale"):
            output = scale.get("name", "")
            value = self._parse_number(path, experiment_name, f"scale of {output}", scale.get("value", ""))
            if value is None or not 0.0 < value < float("inf"):
                text = (
                    f"experiment {experiment_name!r} has scale of {output} = {value}, expected a positive "
                    "number"
                )
                raise ValueError(f"{self.fmu}: {path}: {text}")
            scales[output] = value
        return scales

    def _parse_number(
        self, path: str, experiment_name: str, value_label: str, value: str | None
    ) -> float | None:
        """Parse a number of an experiment; None if it is not stated."""
        try:
            return None if value is None else float(value)
        except ValueError:
            text = (
                f"{self.fmu}: {path}: experiment {experiment_name!r} has {value_label} = {value!r}, "
                "expected a number"
            )
            raise ValueError(text) from None

    def _read_settings(self, path: str) -> dict[str, StartSetting]:
        """Read the start values of an SSV file, {variable: start value}."""
        settings = {}
        for parameter in self._read_xml(path).iter(f"{{{SSV_NAMESPACE}}}Parameter"):
            name = parameter.get("name", "")
            for child in parameter:
                kind, value = child.tag.rpartition("}")[2], child.get("value", "")
                try:
                    settings[name] = StartSetting(_parse_value(kind, value), child.get("unit", ""))
                except (KeyError, ValueError):
                    raise ValueError(f"{self.fmu}: {path}: {name} = {value!r} is not a {kind}") from None
                break
        return settings

    def _resolve_path(self, base_member: str, source_address: str) -> str:
        """Resolve a source address relative to the file `base_member` in the FMU, to a path in the FMU."""
        if urlsplit(source_address).scheme:
            raise ValueError(f"{self.fmu}: {base_member} names {source_address}; expected a file in the FMU")
        return posixpath.normpath(posixpath.join(posixpath.dirname(base_member), unquote(source_address)))

    def _read_text(self, path: str) -> str:
        """Read the text of a related file of the FMU."""
        if path not in self.members:
            raise ValueError(f"{self.fmu}: has no {path}, which its manifest or an experiment names")
        try:
            return self.members[path].decode("utf-8-sig")
        except UnicodeDecodeError:
            raise ValueError(f"{self.fmu}: {path} is not a text; expected UTF-8") from None

    def _read_xml(self, path: str) -> Element:
        """Read the XML root element of a related file of the FMU."""
        try:
            return ElementTree.fromstring(self._read_text(path))
        except ElementTree.ParseError as error:
            raise ValueError(f"{self.fmu}: {path} is not valid XML ({error})") from None


_RELATED_FILE_MIME_TYPES = {"Parameters": SSV_TYPE, "Stimuli": CSV_TYPE, "References": CSV_TYPE}
"""{child element of an experiment: MIME type of the file that it names}."""
_BOOLEAN_VALUES = {"true": True, "1": True, "false": False, "0": False}
"""{text in an SSV file: Boolean value}."""


def _parse_value(element_name: str, value: str) -> float | int | bool | str:
    """Parse a value of an SSV file by the name of its XML element (kind): Real, Integer, Boolean, String."""
    if element_name == "Boolean":
        return _BOOLEAN_VALUES[value]
    if element_name.startswith(("Integer", "Int", "UInt")):
        return int(value)
    return float(value) if element_name.startswith(("Real", "Float")) else value
