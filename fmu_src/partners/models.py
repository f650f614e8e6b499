"""Models (variables, ramp, equations) and parameters of the partner FMUs.

A partner is an inertia, mass, load or prescribed motion that is connected to a joint in a system.
"""

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.parameters import ParameterFile, read_document, read_entries
from jointfmu.quantity import build_parameter_set, flatten_fields

from .laws import AngleProfile, ForceProfile, RotationalInertia, TorqueCurve, TorqueProfile, TranslationalMass


def _make_model(
    parameter_class: type[Any],
    model_description: str,
    input_variables: Sequence[Variable],
    output_variables: Sequence[Variable],
    load_ramp: LoadRamp,
    state_count: int = 0,
) -> Model:
    """Make the model of a partner FMU, from its parameter class and variables."""
    return Model(
        name=parameter_class.__name__,
        joint="partner",
        doc=model_description,
        parameter_class=parameter_class,
        tabulate=lambda partner: partner,
        inputs=input_variables,
        outputs=output_variables,
        evaluate=lambda partner, values: partner.evaluate_outputs(values),
        validity_limits=(),
        ramp=load_ramp,
        # states depend on no input; the acceleration depends on the inputs and the position
        dependencies={v.name: (v.name,) for v in output_variables[:state_count]}
        | {
            v.name: (*(i.name for i in input_variables), output_variables[0].name)
            for v in output_variables[state_count:]
            if state_count
        },
        state_count=state_count,
        is_time_dependent=True,
        find_event_times=getattr(parameter_class, "find_corner_times", None),
    )


_TORQUE_PROFILE_VARIABLES = (
    (Variable("tau_in", "N.m", "torque added to the profile"),),
    (Variable("tau", "N.m", "torque"),),
)
"""Inputs and outputs of models that prescribe a torque over time."""
PARTNERS: dict[str, Model] = {
    model.name: model
    for model in (
        _make_model(
            RotationalInertia,
            "Rotational inertia with its weight: torques in, motion out",
            (
                Variable("tau_a", "N.m", "torque on the inertia"),
                Variable("tau_b", "N.m", "second torque on the inertia"),
            ),
            (
                Variable("phi", "rad", "angle, zero where the centre of mass hangs down", 1e-3),
                Variable("w", "rad/s", "speed", 1e-1),
                Variable("a", "rad/s2", "acceleration", 1e2),
            ),
            LoadRamp("tau_a", 1.0, 1e-3, 1e-3),
            state_count=2,
        ),
        _make_model(
            TranslationalMass,
            "Mass: forces in, motion out",
            (
                Variable("f_a", "N", "force on the mass", 1e3),
                Variable("f_b", "N", "second force on the mass", 1e3),
            ),
            (
                Variable("s", "m", "displacement", 1e-6),
                Variable("v", "m/s", "speed", 1e-3),
                Variable("a", "m/s2", "acceleration", 1e2),
            ),
            LoadRamp("f_a", 1e3, 1.0, 1e-5),
            state_count=2,
        ),
        _make_model(
            TorqueProfile,
            "Torque over time: smooth ramp to a constant value, and smooth pulse",
            *_TORQUE_PROFILE_VARIABLES,
            LoadRamp("tau_in", 1.0, 1e-3, 1e-3, {"pulse_height": 1.0}),
        ),
        _make_model(
            ForceProfile,
            "Force over time: smooth ramp to a constant value, and smooth pulse",
            (Variable("f_in", "N", "force added to the profile", 1e3),),
            (Variable("f", "N", "force", 1e3),),
            LoadRamp("f_in", 1e3, 1.0, 1e-3, {"pulse_height": 1e3}),
        ),
        _make_model(
            AngleProfile,
            "Angle over time: smooth rotation from rest to rest",
            (
                Variable("phi_in", "rad", "angle added to the profile"),
                Variable("w_in", "rad/s", "speed added to the profile"),
            ),
            (Variable("phi", "rad", "angle"), Variable("w", "rad/s", "speed")),
            LoadRamp("phi_in", 1.0, 1e-3, 1e-3, {"height": 1.0}),
        ),
        _make_model(
            TorqueCurve,
            "Torque over time: a Bernstein polynomial, held before and after it",
            *_TORQUE_PROFILE_VARIABLES,
            LoadRamp("tau_in", 1.0, 1e-3, 1e-3),
        ),
    )
}
"""{name of a partner FMU: its model}."""


def load_partner_parameters(partner_name: str) -> ParameterFile:
    """Load the shipped parameter file of a partner FMU, models/partners/NAME.toml."""
    path = Path(str(files("jointfmu_models") / "partners" / f"{partner_name}.toml"))
    return read_partner_parameters(path, partner_name)


def read_partner_parameters(parameter_file_path: Path, partner_name: str) -> ParameterFile:
    """Read the parameter file of a partner FMU (inertia, mass, load or prescribed motion).

    Raises ValueError with one line that names the file, the wrong entry and the allowed values.
    """
    document = read_document(parameter_file_path, "a partner's parameter file")
    if document.get("partner") != partner_name:
        raise ValueError(
            f"{parameter_file_path}: partner = {document.get('partner')!r}, expected {partner_name!r}"
        )
    cls = PARTNERS[partner_name].parameter_class
    body = {key: entry for key, entry in document.items() if key not in ("schema", "partner")}
    values, origins, sources = read_entries(parameter_file_path, dict(flatten_fields(cls)), body)
    try:
        return ParameterFile("partner", partner_name, build_parameter_set(cls, values), origins, sources)
    except ValueError as error:
        raise ValueError(f"{parameter_file_path}: {error}") from None
