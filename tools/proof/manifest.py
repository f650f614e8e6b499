"""The experiments of FMI-LS-REF in an FMU: its manifest, files of MA-HS-Experiments, SSV and CSV.

Older drafts have the times of an experiment as attributes of `Experiment`; they are read there, too.
"""

import posixpath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from jointfmu_fmu_src.proof.series import TimeSeries, parse
from jointfmu_fmu_src.proof.standard import (
    ATTRIBUTES,
    CSV,
    EXPERIMENTS,
    INTERFACES,
    LABELS,
    MANIFEST,
    NAME,
    PURPOSES,
    SCALES,
    SSV,
    TRANSIENT,
)

from jointfmu.files.archives import Members

from . import checksum

VALUES = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
"""Namespace of SSV files."""
_OTHER_NAMES = ("application/x-ma-ls-experiments", "application/octet-stream")
"""Of the type of experiments: in the standard's example, and its default."""


@dataclass(frozen=True, slots=True)
class Setting:
    """A start value that an experiment gives; `unit` as its file states it, empty: it states none."""

    value: float | int | bool | str
    unit: str


@dataclass(frozen=True, slots=True)
class Experiment:
    """An experiment of an FMU.

    purpose   : one of PURPOSES
    start, stop, step : [s], None: not stated
    tolerance : relative, of the reference results; None: not stated
    settings  : {variable: start value}
    stimuli, references : inputs and expected results over time
    interfaces : for which it is
    scales    : {output: size by which the tolerance counts, and not each value's own}
    unfit     : why it cannot be executed here; empty: it can
    """

    name: str
    purpose: str
    start: float | None = None
    stop: float | None = None
    step: float | None = None
    tolerance: float | None = None
    settings: Mapping[str, Setting] = field(default_factory=dict)
    stimuli: TimeSeries | None = None
    references: TimeSeries | None = None
    interfaces: Sequence[str] = INTERFACES
    scales: Mapping[str, float] = field(default_factory=dict)
    unfit: str = ""


class Related:
    """The related files of an FMU, by the addresses that its manifest and experiments give.

    members : those to be read instead of the FMU's own

    Raises ValueError, one line that names FMU and file, wherever one is missing or broken.
    """

    def __init__(self, fmu: Path, members: Mapping[str, bytes] | None = None) -> None:
        self.fmu = fmu
        self._own = Members(fmu)
        self.members: Mapping[str, bytes] = members or self._own
        if MANIFEST not in self.members:
            raise ValueError(f"{fmu}: has no {MANIFEST}; expected an FMU with experiments after FMI-LS-REF")

    def experiments(self) -> list[Experiment]:
        """All experiments of the manifest, in its order."""
        with self._own.open_for_reading():
            return self._all_experiments()

    def _all_experiments(self) -> list[Experiment]:
        root = self._xml(MANIFEST)
        if (found := root.get(f"{{{ATTRIBUTES}}}fmi-ls-name")) != NAME:
            raise ValueError(f"{self.fmu}: {MANIFEST} is of {found!r}, expected {NAME!r}")
        read = []
        for related in root.iter("Related"):
            self._unchanged(related)
            role, _, purpose = related.get("role", "").partition("/")
            if role == "experiment":
                read += self._experiments(related, purpose or PURPOSES[0])
        if not read:
            raise ValueError(f"{self.fmu}: {MANIFEST} names no experiment; expected one at least")
        return read

    def _unchanged(self, related: Element) -> None:
        """Compare a related file of the layered standard's folder with its checksum, if one is stated."""
        source = related.get("source", "")
        if urlsplit(source).scheme or (path := self._path(MANIFEST, source)) not in self.members:
            return
        try:
            checksum.check(related, self.members[path])
        except ValueError as error:
            raise ValueError(f"{self.fmu}: {path} {error}") from None

    def _experiments(self, related: Element, purpose: str) -> list[Experiment]:
        """The experiments of a file; one as its name if it cannot be read here."""
        source, kind = related.get("source", ""), related.get("type", EXPERIMENTS)
        if kind not in (EXPERIMENTS, *_OTHER_NAMES):
            return [Experiment(source, purpose, unfit=f"is of type {kind}, {EXPERIMENTS} is read")]
        if urlsplit(source).scheme:
            return [Experiment(source, purpose, unfit="lies outside of the FMU")]
        path = self._path(MANIFEST, source)
        labels = {label.get("name") for label in related.iter("Label")}
        meant = [name for name, label in LABELS.items() if label in labels] or INTERFACES
        return [self._experiment(path, node, purpose, meant) for node in self._xml(path).iter("Experiment")]

    def _experiment(self, path: str, node: Element, purpose: str, interfaces: Sequence[str]) -> Experiment:
        name = node.get("name", "")
        kinds = [child.tag for child in node if child.tag not in ("Annotations", *_FILES)]
        unfit = f"is a {kinds[0]}" if kinds and kinds[0] != TRANSIENT else ""
        files: dict[str, str] = {}
        for tag, kind in _FILES.items():
            children = node.findall(tag)
            if len(children) > 1:
                unfit = unfit or f"has {len(children)} {tag}, one is read"
            for child in children if not unfit else ():
                if child.get("type", kind) != kind:
                    unfit = f"has {tag} of type {child.get('type')}, {kind} is read"
                else:
                    files[tag] = self._path(path, child.get("source", ""))
        times = {**node.attrib, **getattr(node.find(TRANSIENT), "attrib", {})}
        start, stop, step, tolerance = (
            self._number(path, name, key, times.get(key))
            for key in ("startTime", "stopTime", "stepSize", "tolerance")
        )
        stimuli, references = (
            parse(self._text(files[tag]), f"{self.fmu}: {files[tag]}") if tag in files and not unfit else None
            for tag in ("Stimuli", "References")
        )
        settings = self._settings(files["Parameters"]) if "Parameters" in files and not unfit else {}
        numbers, scales = (start, stop, step, tolerance), self._scales(path, name, node)
        return Experiment(name, purpose, *numbers, settings, stimuli, references, interfaces, scales, unfit)

    def _scales(self, path: str, experiment: str, node: Element) -> dict[str, float]:
        """What its annotation states."""
        scales = {}
        for scale in node.iterfind(f"Annotations/Annotation[@type='{SCALES}']/Scale"):
            output = scale.get("name", "")
            value = self._number(path, experiment, f"scale of {output}", scale.get("value", ""))
            if value is None or not 0.0 < value < float("inf"):
                text = (
                    f"experiment {experiment!r} has scale of {output} = {value}, expected a positive number"
                )
                raise ValueError(f"{self.fmu}: {path}: {text}")
            scales[output] = value
        return scales

    def _number(self, path: str, experiment: str, key: str, value: str | None) -> float | None:
        try:
            return None if value is None else float(value)
        except ValueError:
            text = f"{self.fmu}: {path}: experiment {experiment!r} has {key} = {value!r}, expected a number"
            raise ValueError(text) from None

    def _settings(self, path: str) -> dict[str, Setting]:
        """The values of an SSV file."""
        settings = {}
        for parameter in self._xml(path).iter(f"{{{VALUES}}}Parameter"):
            name = parameter.get("name", "")
            for child in parameter:
                kind, value = child.tag.rpartition("}")[2], child.get("value", "")
                try:
                    settings[name] = Setting(_value(kind, value), child.get("unit", ""))
                except (KeyError, ValueError):
                    raise ValueError(f"{self.fmu}: {path}: {name} = {value!r} is no {kind}") from None
                break
        return settings

    def _path(self, base: str, source: str) -> str:
        """The member of the archive that an address beside another member means."""
        if urlsplit(source).scheme:
            raise ValueError(f"{self.fmu}: {base} names {source}; expected a file in the FMU")
        return posixpath.normpath(posixpath.join(posixpath.dirname(base), unquote(source)))

    def _text(self, path: str) -> str:
        if path not in self.members:
            raise ValueError(f"{self.fmu}: has no {path}, which its manifest or an experiment names")
        try:
            return self.members[path].decode("utf-8-sig")
        except UnicodeDecodeError:
            raise ValueError(f"{self.fmu}: {path} is no text; expected UTF-8") from None

    def _xml(self, path: str) -> Element:
        try:
            return ElementTree.fromstring(self._text(path))
        except ElementTree.ParseError as error:
            raise ValueError(f"{self.fmu}: {path} is no XML ({error})") from None


_FILES = {"Parameters": SSV, "Stimuli": CSV, "References": CSV}
"""{element of an experiment: type of its file}."""
_TRUTH = {"true": True, "1": True, "false": False, "0": False}


def _value(kind: str, value: str) -> float | int | bool | str:
    """The value of an SSV file: what its element's name says."""
    if kind == "Boolean":
        return _TRUTH[value]
    if kind.startswith(("Integer", "Int", "UInt")):
        return int(value)
    return float(value) if kind.startswith(("Real", "Float")) else value
