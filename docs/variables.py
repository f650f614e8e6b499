"""The variables of all FMUs as a page, from the list that the FMUs themselves are made of."""

from collections.abc import Iterable, Sequence

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model, Variable
from jointfmu.parameters import default

INTRODUCTION = """# FMU variables

All variables have SI units. Their names follow the blocks for FMU export of the Modelica Standard Library: \
`phi1`, `w1`, `phi2`, `w2` → `tau1`, `tau2` for rotation, and `s_rel`, `v_rel` → `f` for translation. An \
output follows the inputs at once: no step is needed. `jointfmu parameters NAME` prints the parameters with \
their intervals and meanings; `jointfmu parameters NAME --json` is for programs.

## Frames and signs

| FMU | frame and positive directions | a positive output acts on |
|---|---|---|
| `HarmonicDriveSpring` | angles of both flanges about the same axis, in the same direction | \
`tau1`: flange 1 (wave generator, motor). `tau2`: flange 2 (output). The housing takes the rest |
| `HarmonicDriveCompliance` | motor locked; `phi_rel` is the angle of the output flange | \
`tau` is the outer torque on the output flange |
| `BoltedJoint` | right-handed frame at the centre of the interface: x along the bolt rows, y across them, \
z normal, from side 1 to side 2. Motion is that of side 2 relative to side 1, from the tightened state. \
`s_rel_z > 0` pulls the sides apart | `f_x`, `f_y`, `f_z`, `m_x`, `m_y`, `m_z`: side 2, moments about the \
centre of the interface. Side 1 gets the opposite. The force is restoring: `f_z < 0` while pulled apart |
| `GearContact` | `s_rel` is the approach of both flanks from first touch | `f` presses the flanks together |
| `GearMesh` | angles of both wheels, counted in the same direction; the wheels roll with \
`r_b1 phi1 + r_b2 phi2 = 0` | `tau1`: wheel 1. `tau2`: wheel 2 |

With `sides = "elastic"`, the sides of `BoltedJoint` are the attachment faces of the plates, and each \
bolt has an output `F_bolt[j]`, its working force.

The blocks of the Modelica Standard Library carry torques and forces with the opposite sign in their signal \
adaptors: connect `tau1`, `tau2` or `f` with a gain of -1, or use the wrappers of the \
[Modelica library](modelica.md)."""


def page() -> str:
    """The page (Markdown): frames and signs, then inputs, outputs and parameters of each FMU."""
    return "\n\n".join([INTRODUCTION, *(_fmu(model) for model in MODELS.values())]) + "\n"


def _fmu(model: Model) -> str:
    file = default(model.joint)
    parts = [f"## {model.name}", f"As shipped, the parameters are those of: {file.name}."]
    parts += ["**Inputs**", _table(_rows(model.inputs)), "**Outputs**", _table(_rows(model.outputs))]
    parameters = [
        (name, field.metadata.get("unit", ""), field.metadata["doc"])
        for name, field in model.parameter_fields().items()
        if name in file.flat
    ]
    return "\n\n".join([*parts, "**Parameters**", _table(parameters)])


def _rows(variables: Sequence[Variable]) -> list[tuple[str, str, str]]:
    return [(v.name, v.unit, v.doc) for v in variables]


def _table(rows: Iterable[tuple[str, str, str]]) -> str:
    lines = [f"| `{name}` | {unit} | {text.replace('|', chr(92) + '|')} |" for name, unit, text in rows]
    return "\n".join(["| name | unit | meaning |", "|---|---|---|", *lines])
