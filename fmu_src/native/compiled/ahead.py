"""Compile ahead of time the parts that a wheel carries: of every law and choice that code depends on."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, default
from jointfmu.progress import track
from jointfmu.quantity import flat_fields

from ...partners import PARTNERS
from ...partners import parameters as partner_parameters
from ..data import split
from .kept import part_of, shipped_name, written


def compile_ahead(names: Sequence[str], out: Path) -> list[Path]:
    """Write the parts of some FMUs, or of all, into a folder, whose other files go.

    Raises what `kept.part_of` raises, and ValueError for an unknown name.
    """
    every = MODELS | PARTNERS
    if unknown := [name for name in names if name not in every]:
        raise ValueError(f"unknown FMU {unknown[0]!r}, allowed are {', '.join(every)}")
    jobs = [job for name in names or every for job in structures(every[name])]
    out.mkdir(parents=True, exist_ok=True)
    made = []
    for model, parameters in track(jobs, "compile", len(jobs)):
        given = split(model, parameters)
        part = part_of(model, parameters, given)
        made.append(out / shipped_name(model, given))
        made[-1].write_bytes(written(part))
    for old in set(out.iterdir()) - set(made):
        old.unlink()
    return made


def structures(model: Model) -> Iterator[tuple[Model, ParameterFile]]:
    """An FMU and parameters for each of its structures."""
    if model.name in PARTNERS:
        yield model, partner_parameters(model.name)
        return
    for law in KINDS[model.joint].laws:
        file = default(model.joint, law)
        own = model.of(file.joint, file.values)
        for choices in _choices(own, file):
            try:
                chosen = file.with_values(choices, "user", "compiled ahead")
            except ValueError:  # a choice that goes with numbers which the file does not have
                continue
            yield own, chosen


def _choices(model: Model, file: ParameterFile) -> Iterator[Mapping[str, object]]:
    """All values of the parameters that code depends on and that are choices."""
    code = split(model, file).code
    allowed = {
        name: item.metadata["allowed"]
        for name, item in flat_fields(type(file.values))
        if name in code and "allowed" in item.metadata
    }
    for values in product(*allowed.values()):
        yield dict(zip(allowed, values, strict=True))
