"""`jointfmu parameters`: list the parameters of an FMU, a joint or an interface law."""

import argparse
import math
from dataclasses import Field
from pathlib import Path
from typing import Any

from jointfmu.contact.laws import LAWS, ROUGHNESS_LAW
from jointfmu.contact.roughness import DECLARED
from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import ParameterFile, default, load
from jointfmu.quantity import flat_fields, flatten

from ..command_line.common import Answer, Commands, argument, command
from ..laws import law_file, law_parameters
from ..shown import aligned

_HEAD = ("name", "default", "unit", "allowed", "meaning")


def add(commands: Commands) -> None:
    """Declare the command `jointfmu parameters` with its options."""
    text = "list the parameters of an FMU, a joint or an interface law"
    sub = command(commands, "parameters", _parameters, text)
    text = f"an FMU ({', '.join(MODELS)}), a joint ({', '.join(KINDS)}) or a law ({', '.join(LAWS)})"
    argument(sub, "name", str, text, choices=[*MODELS, *KINDS, *LAWS])
    source = sub.add_mutually_exclusive_group()
    laws = sorted({law for kind in KINDS.values() for law in kind.laws})
    argument(source, "--law", str, f"law of the FMU or joint ({', '.join(laws)})", "LAW", choices=laws)
    argument(source, "--params", Path, "parameter file, in place of the default values (TOML)")


def _parameters(args: argparse.Namespace) -> Answer:
    name = args.name
    if name in LAWS:
        if args.law:
            raise ValueError(f"--law has no meaning for the law {name}; it is for FMUs and joints")
        values = flatten(law_parameters(name, law_file(args.params, name) if args.params else None, {}))
        fields = dict(flat_fields(LAWS[name], names=values))
        if name == ROUGHNESS_LAW:
            fields |= {stated: field for stated, field in DECLARED.items() if stated not in fields}
        head = {"name": name, "law": name}
    else:
        file = _joint_file(name, args)
        values = dict(file.flat)
        if name in MODELS:
            known = MODELS[name].of(file.joint, file.values).parameter_fields()
            fields = {stated: field for stated, field in known.items() if stated in values}
        else:
            fields = dict(flat_fields(type(file.values), names=values))
        head = {"name": name, "joint": file.joint, "law": file.law}
    rows = [_row(stated, field, values.get(stated)) for stated, field in fields.items()]
    return Answer(document={**head, "parameters": rows}, lines=aligned([_HEAD, *map(_cells, rows)]))


def _joint_file(name: str, args: argparse.Namespace) -> ParameterFile:
    """Load the parameter file of an FMU or joint: that of `--params`, or the default with `--law`."""
    joint = MODELS[name].joint if name in MODELS else name
    if args.params:
        return load(args.params, joint)
    if args.law and args.law not in KINDS[joint].laws:
        raise ValueError(
            f"law = {args.law!r} is none of a {joint}, allowed are {', '.join(KINDS[joint].laws)}"
        )
    return default(joint, args.law)


def _row(name: str, field: Field[Any], value: Any) -> dict[str, Any]:
    """JSON object of one parameter: name, meaning, default, unit, lower and upper limit, allowed values."""
    meta = field.metadata
    row = {"name": name, "meaning": meta["doc"], "default": value}
    if "allowed" in meta:
        return row | {"unit": None, "allowed": list(meta["allowed"])}
    interval = meta["interval"]
    low, high = (end if math.isfinite(end) else None for end in (interval.low, interval.high))
    whole = {"whole": True} if meta["whole"] else {}
    return row | {"unit": meta["unit"], "low": low, "high": high, "allowed": str(interval)} | whole


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    allowed = row["allowed"]
    if isinstance(allowed, list):
        allowed = " | ".join(str(option).lower() for option in allowed)
    elif "whole" in row:
        allowed += " whole"
    return (row["name"], _shown(row["default"]), row["unit"] or "", allowed, row["meaning"])


def _shown(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, tuple):
        return f"{len(value)} numbers"
    return str(value).lower() if isinstance(value, bool | str) else f"{value:.6g}"
