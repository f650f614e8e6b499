"""The experiments of FMI-LS-REF in an FMU: its manifest, files of MA-HS-Experiments, SSV and CSV.

Older drafts have the times of an experiment as attributes of `Experiment`; they are read there, too.
"""

import posixpath
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from .series import Series, parse

NAME = "org.fmi-standard.fmi-ls-ref"
"""Of the layered standard."""
VERSION = "1.0.0-alpha.1"
DESCRIPTION = "Layered Standard providing information on related files included in an FMU."
FOLDER = f"extra/{NAME}"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"
ATTRIBUTES = "http://fmi-standard.org/fmi-ls-manifest"
"""Namespace of the manifest's own attributes."""
VALUES = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
"""Namespace of SSV files."""
EXPERIMENTS, SSV, CSV = "application/x-ma-hs-experiments", "application/x-ssp-parameter-set", "text/csv"
"""Types of related files that are read."""
TRANSIENT = "TransientSimulation"
PURPOSES = ("smoke-test", "validation", "uncertainty-analysis")
"""What an experiment is for; the first where a manifest does not say."""


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
    unfit     : why it cannot be executed here; empty: it can
    """

    name: str
    purpose: str
    start: float | None
    stop: float | None
    step: float | None
    tolerance: float | None
    settings: Mapping[str, Setting]
    stimuli: Series | None
    references: Series | None
    unfit: str = ""


class Related:
    """The related files of an FMU, by the addresses that its manifest and experiments give.

    Raises ValueError, one line that names FMU and file, wherever one is missing or broken.
    """

    def __init__(self, fmu: Path) -> None:
        self.fmu = fmu
        try:
            with zipfile.ZipFile(fmu) as archive:
                self.members = {
                    name: archive.read(name)
                    for name in archive.namelist()
                    if name.startswith("extra/") and not name.endswith("/")
                }
        except OSError as error:
            raise ValueError(f"{fmu}: cannot be read ({error.strerror}); expected an FMU") from None
        except zipfile.BadZipFile as error:
            raise ValueError(
                f"{fmu}: is no FMU ({error}); expected a zip with modelDescription.xml"
            ) from None
        if MANIFEST not in self.members:
            raise ValueError(f"{fmu}: has no {MANIFEST}; expected an FMU with experiments after FMI-LS-REF")

    def experiments(self) -> list[Experiment]:
        """All experiments of the manifest, in its order."""
        root = self._xml(MANIFEST)
        if (found := root.get(f"{{{ATTRIBUTES}}}fmi-ls-name")) != NAME:
            raise ValueError(f"{self.fmu}: {MANIFEST} is of {found!r}, expected {NAME!r}")
        read = []
        for related in root.iter("Related"):
            role, _, purpose = related.get("role", "").partition("/")
            if role == "experiment":
                path = self._path(MANIFEST, related.get("source", ""))
                nodes = self._xml(path).iter("Experiment")
                read += [self._experiment(path, node, purpose or PURPOSES[0]) for node in nodes]
        if not read:
            raise ValueError(f"{self.fmu}: {MANIFEST} names no experiment; expected one at least")
        return read

    def _experiment(self, path: str, node: Element, purpose: str) -> Experiment:
        name = node.get("name", "")
        kinds = [child.tag for child in node if child.tag not in ("Annotations", *_FILES)]
        unfit = f"is a {kinds[0]}" if kinds and kinds[0] != TRANSIENT else ""
        files: dict[str, str] = {}
        for tag, kind in _FILES.items():
            if (child := node.find(tag)) is not None and not unfit:
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
        return Experiment(name, purpose, start, stop, step, tolerance, settings, stimuli, references, unfit)

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


def _value(kind: str, value: str) -> Any:
    """The value of an SSV file: what its element's name says."""
    if kind == "Boolean":
        return _TRUTH[value]
    if kind.startswith(("Integer", "Int", "UInt")):
        return int(value)
    return float(value) if kind.startswith(("Real", "Float")) else value
