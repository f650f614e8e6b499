"""The one list of variables: name, unit, causality and meaning of every variable of every FMU.

Parameters are those of the joint's parameter set, whose units, intervals and meanings the package
declares; inputs and outputs are listed here. What an FMU computes is one call into the package.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jointfmu.joints.bolted_joint import BoltedJoint, BoltedJointSpring
from jointfmu.joints.gear_contact import GearContact, GearContactSpring
from jointfmu.joints.harmonic_drive import HarmonicDrive, HarmonicDriveSpring
from jointfmu.quantity import Interval, Number, flat_fields

Values = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Variable:
    """An input or output."""

    name: str
    unit: str
    doc: str
    nominal: float = 1.0
    low: float = -math.inf

    @property
    def interval(self) -> Interval:
        """What an input may be: finite, and not below its least value."""
        return Interval.of(ge=self.low)


@dataclass(frozen=True, slots=True)
class Ramp:
    """Load ramp: the default experiment, one step per interval [s]."""

    input: str
    end: float
    step: float
    interval: float = 1.0


@dataclass(frozen=True, slots=True)
class Outside:
    """A way to leave the tables, worth a warning: a variable outside its interval.

    interval : (joint, (x, y) at the end of the curve, inputs) -> (low, high); numbers or symbols
    doc      : what happens there
    """

    variable: str
    interval: Callable[[Any, tuple[Number, Number], Mapping[str, Number]], tuple[Number, Number]]
    doc: str


@dataclass(frozen=True, slots=True)
class Model:
    """One FMU.

    joint    : kind of the parameter file
    spring   : makes the tabulated joint of a parameter set
    evaluate : (spring, inputs) -> outputs
    outside  : warnings about a state outside the tables
    dependencies : inputs that an output depends on, where not on all
    hidden   : prefixes of parameters that are baked in
    states   : continuous states, the first outputs; the rate of each is the output after it
    moves    : outputs change with time, while inputs rest
    """

    name: str
    joint: str
    doc: str
    parameters: type[Any]
    spring: Callable[[Any], Any]
    inputs: Sequence[Variable]
    outputs: Sequence[Variable]
    evaluate: Callable[[Any, Values], Mapping[str, Any]]
    outside: Sequence[Outside]
    ramp: Ramp
    dependencies: Mapping[str, Sequence[str]]
    hidden: Sequence[str] = ()
    states: int = 0
    moves: bool = False

    def parameter_fields(self) -> dict[str, Any]:
        """Structured names and fields of the parameters that the FMU exposes."""
        return {
            name: item
            for name, item in flat_fields(self.parameters)
            if not any(name == h or name.startswith(f"{h}.") for h in self.hidden)
            and not isinstance(item.metadata.get("allowed", (0,))[0], str)
        }

    def check_joint(self, joint: str) -> None:
        """Raise ValueError if a parameter file is of another joint than this FMU's."""
        if joint != self.joint:
            raise ValueError(f"{self.name}: the parameter file is of a {joint!r}, expected a {self.joint!r}")

    def warnings(self, spring: Any, values: Values) -> dict[int, str]:
        """Warnings about a state of inputs and outputs outside the tables, by number."""
        units = {v.name: v.unit for v in (*self.inputs, *self.outputs)}
        messages = {}
        for i, o in enumerate(self.outside):
            value, unit = values[o.variable], units[o.variable]
            low, high = (float(end) for end in o.interval(spring.joint, spring.curve.end, values))
            inside = Interval.of(ge=low, le=high)
            if not inside.contains(value):
                messages[i] = f"{o.variable} = {value:.6g} {unit} is outside {inside} {unit}: {o.doc}"
        return messages

    def depends(self, output: str) -> Sequence[str]:
        """Inputs and states on which an output depends."""
        return self.dependencies.get(output, [v.name for v in self.inputs])


_CONTACT = (
    Variable("K_WTS", "N.m/rad", "tangent stiffness dT/dphi at the present torque", 5e3),
    Variable("K_TS", "N.m/rad", "its part of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS", 5e3),
    Variable("K_FTS", "N.m/rad", "its part of circular spline and flexspline", 2e4),
    Variable("K_TS_pair", "N.m/rad", "K_TS over drive_scale: the scale of Hu 2023, Fig. 11", 1e3),
    Variable("p_max", "Pa", "peak contact pressure, at the major axis and the cup's opening", 1e8),
)


def _bolted(spring: BoltedJointSpring, v: Values) -> Mapping[str, float]:
    return spring.motion(
        v["preload"],
        v["moment"],
        (v["s_rel_x"], v["s_rel_y"], v["s_rel_z"]),
        (v["v_rel_x"], v["v_rel_y"], v["v_rel_z"]),
    )


_BEYOND = "beyond the tabulated law the last tangent is continued"


def _row_moment(joint: Any, preload: Number) -> Number:
    """The largest moment [N.m] that both bolt rows carry without a negative bolt force."""
    return preload * joint.row_distance * joint.row_bolts


_MOTION = ("phi1", "phi2")
_TIGHT = ("preload", "moment")
_SHIFT = ("s_rel_x", "s_rel_y", "s_rel_z")
_DRIVE_HIDDEN = ("max_torque", "shear_traction")

MODELS: dict[str, Model] = {
    model.name: model
    for model in (
        Model(
            name="HarmonicDriveSpring",
            joint="harmonic_drive",
            doc="Torsional spring and damper of a harmonic drive: motion in, torque out (Hu 2023)",
            parameters=HarmonicDrive,
            spring=HarmonicDriveSpring.of,
            inputs=(
                Variable("phi1", "rad", "angle of the wave-generator (motor) flange"),
                Variable("w1", "rad/s", "speed of the wave-generator (motor) flange"),
                Variable("phi2", "rad", "angle of the output flange"),
                Variable("w2", "rad/s", "speed of the output flange"),
            ),
            outputs=(
                Variable("tau1", "N.m", "torque of the element on flange 1, tau/ratio", 0.1),
                Variable("tau2", "N.m", "torque of the element on flange 2, -tau", 5.0),
                Variable("phi_rel", "rad", "wind-up at the output, phi2 - phi1/ratio", 1e-3),
                Variable("tau", "N.m", "T(phi_rel) + d der(phi_rel)", 5.0),
                *_CONTACT,
            ),
            evaluate=lambda s, v: s.motion(v["phi1"], v["w1"], v["phi2"], v["w2"]),
            outside=(Outside("phi_rel", lambda j, end, v: (-end[0], end[0]), _BEYOND),),
            ramp=Ramp("phi2", 1.5e-3, 3e-6),
            dependencies={
                "phi_rel": _MOTION,
                "K_WTS": _MOTION,
                "K_TS": _MOTION,
                "K_FTS": (),
                "K_TS_pair": _MOTION,
                "p_max": _MOTION,
            },
            hidden=_DRIVE_HIDDEN,
        ),
        Model(
            name="HarmonicDriveCompliance",
            joint="harmonic_drive",
            doc="Wind-up of a harmonic drive with the wave generator locked: torque in, motion out (Hu 2023)",
            parameters=HarmonicDrive,
            spring=HarmonicDriveSpring.of,
            inputs=(Variable("tau", "N.m", "torque at the output flange", 5.0),),
            outputs=(Variable("phi_rel", "rad", "wind-up at the output, phi(tau)", 1e-3), *_CONTACT),
            evaluate=lambda s, v: s.windup(v["tau"]),
            outside=(Outside("tau", lambda j, end, v: (-end[1], end[1]), _BEYOND),),
            ramp=Ramp("tau", 5.0, 0.01),
            dependencies={"K_FTS": ()},
            hidden=_DRIVE_HIDDEN,
        ),
        Model(
            name="BoltedJoint",
            joint="bolted_joint",
            doc="Bolted joint under uneven pressure: motion in, force out (Zhao 2018)",
            parameters=BoltedJoint,
            spring=BoltedJointSpring.of,
            inputs=(
                Variable("preload", "N", "pre-tightening force of each bolt", 1e4, low=0.0),
                Variable("moment", "N.m", "bending moment on the joint", 1e3),
                Variable("s_rel_x", "m", "displacement from the tightened state, along the rows", 1e-6),
                Variable("s_rel_y", "m", "displacement from the tightened state, across the rows", 1e-6),
                Variable("s_rel_z", "m", "displacement from the tightened state, positive apart", 1e-6),
                Variable("v_rel_x", "m/s", "rate of s_rel_x", 1e-3),
                Variable("v_rel_y", "m/s", "rate of s_rel_y", 1e-3),
                Variable("v_rel_z", "m/s", "rate of s_rel_z", 1e-3),
            ),
            outputs=(
                Variable("f_x", "N", "force on side 2 along x, restoring", 1e4),
                Variable("f_y", "N", "force on side 2 along y, restoring", 1e4),
                Variable("f_z", "N", "force on side 2 along the normal, negative when pulled apart", 1e4),
                Variable("K_xx", "N/m", "tangential stiffness -df_x/ds_rel_x", 1e10),
                Variable("K_yy", "N/m", "tangential stiffness -df_y/ds_rel_y", 1e10),
                Variable("K_zz", "N/m", "normal stiffness -df_z/ds_rel_z", 1e10),
                Variable("C_xx", "N.s/m", "viscous-equivalent damping along x", 1e4),
                Variable("C_yy", "N.s/m", "viscous-equivalent damping along y", 1e4),
                Variable("C_zz", "N.s/m", "viscous-equivalent damping along the normal", 1e4),
                Variable("eta_t", "1", "tangential dissipation factor"),
                Variable("eta_n", "1", "normal dissipation factor"),
                Variable("K_rx", "N.m/rad", "rotational stiffness about x through the centroid", 1e8),
                Variable("K_ry", "N.m/rad", "rotational stiffness about y through the centroid", 1e8),
                Variable("K_rz", "N.m/rad", "rotational stiffness about the normal, same point", 1e8),
                Variable("p_mean", "Pa", "mean contact pressure", 1e6),
                Variable("p_max", "Pa", "largest contact pressure", 1e6),
            ),
            evaluate=_bolted,
            outside=(
                Outside(
                    "moment",
                    lambda j, end, v: (-_row_moment(j, v["preload"]), _row_moment(j, v["preload"])),
                    "a bolt force would be negative; the contact is open where the pressure would be",
                ),
                Outside("p_max", lambda j, end, v: (-math.inf, end[1]), _BEYOND),
            ),
            ramp=Ramp("preload", 30e3, 100.0),
            dependencies={
                "f_x": (*_TIGHT, "s_rel_x", "s_rel_z", "v_rel_x"),
                "f_y": (*_TIGHT, "s_rel_y", "s_rel_z", "v_rel_y"),
                "f_z": (*_TIGHT, *_SHIFT, "v_rel_z"),
                "K_zz": (*_TIGHT, *_SHIFT),
                "eta_t": (),
                **dict.fromkeys(
                    (
                        "K_xx",
                        "K_yy",
                        "C_xx",
                        "C_yy",
                        "C_zz",
                        "eta_n",
                        "K_rx",
                        "K_ry",
                        "K_rz",
                        "p_mean",
                        "p_max",
                    ),
                    (*_TIGHT, "s_rel_z"),
                ),
            },
            hidden=("pattern", "field"),
        ),
        Model(
            name="GearContact",
            joint="gear_contact",
            doc="Tooth contact of a gear with elliptical asperities: force in, motion out (Yu 2022)",
            parameters=GearContact,
            spring=GearContactSpring.of,
            inputs=(Variable("f", "N", "normal load of the tooth contact", 1e3),),
            outputs=(
                Variable("s_rel", "m", "approach of the two flanks from first touch", 1e-6),
                Variable("K_N", "N/m", "tangent stiffness df/ds", 1e9),
                Variable("A_r", "m2", "real contact area", 1e-6),
                Variable("elastic_fraction", "1", "elastic part of the real contact area"),
            ),
            evaluate=lambda s, v: s.approach(v["f"]),
            outside=(
                Outside("f", lambda j, end, v: (0.0, math.inf), "it pulls, the flanks are apart"),
                Outside("f", lambda j, end, v: (-math.inf, j.A_0 * end[1]), _BEYOND),
            ),
            ramp=Ramp("f", 3e3, 10.0),
            dependencies={},
            hidden=("mu", "traction_ratio"),
        ),
    )
}
