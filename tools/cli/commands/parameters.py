"""`jointfmu parameters`: list the parameters of an FMU, a joint or an interface law."""

import argparse
import math
from dataclasses import Field
from pathlib import Path
from typing import Any

from jointfmu.contact.laws import LAWS, ROUGHNESS_LAW_NAME
from jointfmu.contact.roughness import HEIGHT_FIELDS
from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file
from jointfmu.quantity import flatten_fields, flatten_parameters

from ...common.shown import align_columns
from ...inputs.laws import build_law_parameters, load_law_file
from ..command import CommandResult, SubParsers, declare_argument, declare_command

_PARAMETER_TABLE_HEADINGS = ("name", "default", "unit", "allowed", "meaning")
"""Headings of the printed table of parameters."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu parameters` with its options."""
    text = "list the parameters of an FMU, a joint or an interface law"
    sub = declare_command(command_parsers, "parameters", _run_parameters, text)
    text = f"an FMU ({', '.join(MODELS)}), a joint ({', '.join(KINDS)}) or a law ({', '.join(LAWS)})"
    declare_argument(sub, "name", str, text, choices=[*MODELS, *KINDS, *LAWS])
    source = sub.add_mutually_exclusive_group()
    laws = sorted({law for kind in KINDS.values() for law in kind.laws})
    declare_argument(
        source,
        "--law",
        str,
        f"interface law of the FMU or joint ({', '.join(laws)}; default: that of its default parameters)",
        "LAW",
        choices=laws,
    )
    declare_argument(
        source,
        "--params",
        Path,
        "parameter file whose values are listed, in place of the default values (TOML)",
    )


def _run_parameters(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu parameters`: list the parameters of an FMU, joint or law."""
    name = args.name
    if name in LAWS:
        if args.law:
            raise ValueError(f"--law has no effect for the law {name}; it is for FMUs and joints")
        values = flatten_parameters(
            build_law_parameters(name, load_law_file(args.params, name) if args.params else None, {})
        )
        fields = dict(flatten_fields(LAWS[name], parameter_names=values))
        if name == ROUGHNESS_LAW_NAME:
            fields |= {stated: field for stated, field in HEIGHT_FIELDS.items() if stated not in fields}
        head = {"name": name, "law": name}
    else:
        file = _load_joint_file(name, args)
        values = dict(file.values_by_name)
        if name in MODELS:
            known = MODELS[name].with_parameters(file.joint, file.values).parameter_fields()
            fields = {stated: field for stated, field in known.items() if stated in values}
        else:
            fields = dict(flatten_fields(type(file.values), parameter_names=values))
        head = {"name": name, "joint": file.joint, "law": file.law}
    rows = [_parameter_to_json(stated, field, values.get(stated)) for stated, field in fields.items()]
    return CommandResult(
        json_document={**head, "parameters": rows},
        output_lines=align_columns([_PARAMETER_TABLE_HEADINGS, *map(_format_parameter_row, rows)]),
    )


def _load_joint_file(fmu_or_joint_name: str, args: argparse.Namespace) -> ParameterFile:
    """Load the parameter file of an FMU or joint: the file of `--params`, or the default file of `--law`."""
    joint = MODELS[fmu_or_joint_name].joint if fmu_or_joint_name in MODELS else fmu_or_joint_name
    if args.params:
        return load_parameter_file(args.params, joint)
    if args.law and args.law not in KINDS[joint].laws:
        raise ValueError(
            f"law = {args.law!r} is not a law of a {joint}, allowed are {', '.join(KINDS[joint].laws)}"
        )
    return load_default(joint, args.law)


def _parameter_to_json(
    parameter_name: str, parameter_field: Field[Any], default_value: Any
) -> dict[str, Any]:
    """JSON object of one parameter: name, meaning, default, unit, lower and upper limit, allowed values."""
    meta = parameter_field.metadata
    row = {"name": parameter_name, "meaning": meta["doc"], "default": default_value}
    if "allowed" in meta:
        return row | {"unit": None, "allowed": list(meta["allowed"])}
    interval = meta["interval"]
    low, high = (end if math.isfinite(end) else None for end in (interval.low, interval.high))
    whole = {"whole": True} if meta["whole"] else {}
    return row | {"unit": meta["unit"], "low": low, "high": high, "allowed": str(interval)} | whole


def _format_parameter_row(parameter_json: dict[str, Any]) -> tuple[str, ...]:
    """Format the row of one parameter: name, default, unit, allowed values, meaning."""
    allowed = parameter_json["allowed"]
    if isinstance(allowed, list):
        allowed = " | ".join(str(option).lower() for option in allowed)
    elif "whole" in parameter_json:
        allowed += " whole"
    return (
        parameter_json["name"],
        _format_default(parameter_json["default"]),
        parameter_json["unit"] or "",
        allowed,
        parameter_json["meaning"],
    )


def _format_default(default_value: object) -> str:
    """Format the default value of a parameter."""
    if default_value is None:
        return "-"
    if isinstance(default_value, tuple):
        return f"{len(default_value)} numbers"
    return str(default_value).lower() if isinstance(default_value, bool | str) else f"{default_value:.6g}"
