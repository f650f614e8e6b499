"""The files that lists of exporting tools ask for, in the folders of the FMI cross-check rules, version 4.1.

fmus/VERSION/cs/PLATFORM/TOOL/TOOL_VERSION/MODEL holds MODEL.fmu, MODEL_in.csv, MODEL_ref.csv, MODEL_ref.opt
and README.md, of one experiment: the first validation that needs no parameter set, else the first such one.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu_fmu_src.proof.series import TimeSeries, text
from jointfmu_fmu_src.proof.standard import CO_SIMULATION, FOLDER

from jointfmu.files import archives
from jointfmu.files.outputs import MARK, FileKind, check_outputs
from jointfmu.files.writing import made_folder, write_bytes

from .. import host
from .manifest import Experiment
from .outcome import Outcome, Proof
from .plan import TOLERANCE

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription

README = "README.md"
LISTING = FileKind("listing", (".md",))
KNOWN = ("c-code", "darwin64", "linux32", "linux64", "win32", "win64")
"""Platforms of the rules, for FMI 2.0; those of FMI 3.0 are named as the FMU has them."""


def write(proof: Proof, out: Path, force: bool = False) -> list[Path]:
    """Write the files of a proof that passed, once for each platform of the FMU; the folders.

    force : replace files of these names in a folder whose README.md jointfmu did not write

    Raises ValueError if no experiment fits, or a file may not or cannot be written.
    """
    described = host.description(proof.fmu)
    files = _files(proof, _chosen(proof), described)
    tool, _, version = (described.generationTool or "unknown").rpartition(" ")
    below = [_safe(tool or version), _safe(version), _safe(described.modelName)]
    version = described.fmiVersion[:3]
    folders = [out.joinpath("fmus", version, "cs", p, *below) for p in _platforms(proof.fmu, version)]
    check_outputs((folder / README for folder in folders), LISTING, force)
    for folder in folders:
        with made_folder(folder):
            for name, content in files.items():
                write_bytes(folder / name, content)
    return folders


def _chosen(proof: Proof) -> Outcome:
    """Of an experiment with results from its start to its end, whose settings its inputs hold, too."""
    fitting = [o for o in proof.outcomes if o.interface == CO_SIMULATION and _fits(o.experiment)]
    if not fitting:
        raise ValueError(
            f"{proof.fmu}: no experiment without parameters has results from start to end to list"
        )
    return next((one for one in fitting if one.experiment.purpose == "validation"), fitting[0])


def _fits(one: Experiment) -> bool:
    if one.unfit or one.references is None or not one.settings.keys() <= set(_inputs(one)):
        return False
    start, stop = _ends(one)
    return bool(one.references.time[0] <= start and one.references.time[-1] >= stop)


def _inputs(one: Experiment) -> list[str]:
    return list(one.stimuli.columns) if one.stimuli else []


def _ends(one: Experiment) -> tuple[float, float]:
    """Start and stop time; those of the results where the experiment does not state them."""
    assert one.references is not None
    stop = float(one.references.time[-1]) if one.stop is None else one.stop
    return one.start or 0.0, stop


def _files(proof: Proof, chosen: Outcome, description: "ModelDescription") -> dict[str, bytes]:
    """{name: content}."""
    one, name = chosen.experiment, _safe(description.modelName)
    assert one.references is not None
    start, stop = _ends(one)
    tolerance = TOLERANCE if one.tolerance is None else one.tolerance
    options = {"StartTime": start, "StopTime": stop, "StepSize": one.step or 0.0, "RelTol": tolerance}
    series: dict[str, TimeSeries] = {"ref": one.references, **({"in": one.stimuli} if one.stimuli else {})}
    return {
        f"{name}.fmu": proof.fmu.read_bytes(),
        **{f"{name}_{key}.csv": text(values).encode() for key, values in series.items()},
        f"{name}_ref.opt": "".join(f"{key}, {value!r}\n" for key, value in options.items()).encode(),
        README: _readme(proof, chosen, description).encode(),
    }


def _readme(proof: Proof, chosen: Outcome, description: "ModelDescription") -> str:
    one, worst, name = chosen.experiment, chosen.worst, _safe(description.modelName)
    assert worst is not None
    tool = description.generationTool or "an unknown tool"
    driven = f"`{name}_in.csv` drives {', '.join(f'`{n}`' for n in _inputs(one))}; " if one.stimuli else ""
    text = f"{description.description or description.modelName}."
    return f"""# {description.modelName}

{text} FMI {description.fmiVersion} for co-simulation, exported by {tool}.

These are the files of the experiment "{one.name}" in `{FOLDER}` of the FMU.
{driven}`{name}_ref.csv` has the reference results that the FMU carries, `{name}_ref.opt` times, step
and relative tolerance. Nothing else is set.

Run in {proof.importer} by `jointfmu prove {name}.fmu`: of {len(chosen.points)} outputs at {chosen.compared}
times `{worst.output}` is furthest off, by {worst.error:.1e}; allowed is {worst.allowed:.1e}.

<!-- {MARK} -->
"""


def _platforms(fmu: Path, version: str) -> list[str]:
    """Platforms for which an FMU has a binary; of FMI 2.0 those that the rules know."""
    with archives.open_archive(fmu) as archive:
        found = {match[1] for name in archive.namelist() if (match := re.match(r"binaries/([^/]+)/.", name))}
    return sorted(found & set(KNOWN) if version.startswith("2") else found)


def _safe(name: str) -> str:
    """A name as that of a file."""
    return re.sub(r"[^\w.+-]+", "_", name) or "unknown"
