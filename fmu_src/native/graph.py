"""The laws as graphs: Python's own functions called with symbols, for C to be made of them.

Everything here is a call into the package. What depends on parameters alone is taken out of all
functions and computed once per parameter set, into the constants c.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca
import numpy as np

from jointfmu.curve import closing
from jointfmu.joints import bolted_joint, gear_contact, harmonic_drive
from jointfmu.parameters import ParameterFile
from jointfmu.powerlaw import Power, Smooth, Spots, Term
from jointfmu.quantity import Limit, build, flatten

from ..variables import Model

Symbols = Sequence[Any]


@dataclass(frozen=True, slots=True)
class Function:
    """`y = name(x)` besides the constants; `doc` says what x and y are."""

    name: str
    doc: str
    x: Sequence[ca.SX]
    y: Sequence[ca.SX]


@dataclass(slots=True)
class Graph:
    """All functions of an FMU, and the parameters they depend on.

    theta     : symbols of the parameters, in the order of the variable list
    constants : expressions of theta that the functions use; c is theta and then these
    """

    theta: dict[str, ca.SX]
    joint: Any
    limits: list[Limit]
    functions: list[Function] = field(default_factory=list)
    constants: list[ca.SX] = field(default_factory=list)
    symbols: list[ca.SX] = field(default_factory=list)

    def add(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols) -> None:
        """Add a function."""
        self.functions.append(Function(name, doc, x, [ca.SX(value) for value in y]))

    def add_with_seed(self, name: str, doc: str, x: Sequence[ca.SX], y: Symbols, fixed: int = 0) -> None:
        """Add a function and `name_seed`: its derivative along a seed for all x but the first `fixed`."""
        self.add(name, doc, x, y)
        moving = ca.vertcat(*x[fixed:])
        seed = symbols("seed", len(x) - fixed)
        slope = ca.densify(ca.jtimes(ca.vertcat(*map(ca.SX, y)), moving, ca.vertcat(*seed)))
        self.add(
            f"{name}_seed", f"Derivative along a seed: x, seed -> y of {name}", [*x, *seed], list(slope.nz)
        )

    def settle(self) -> None:
        """Take out what depends on parameters alone."""
        everything = ca.cse(ca.densify(ca.vertcat(*(value for f in self.functions for value in f.y))))
        theta = ca.vertcat(*self.theta.values())
        rest, self.symbols, self.constants = ca.extract_parametric(everything, theta)
        values, settled = iter(ca.densify(rest).nz), []
        for f in self.functions:
            settled.append(replace(f, y=[next(values) for _ in f.y]))
        self.functions = settled

    @property
    def c(self) -> ca.SX:
        """The constants' symbols."""
        return ca.vertcat(*self.theta.values(), *self.symbols)


def graph(model: Model, parameters: ParameterFile) -> Graph:
    """All functions of an FMU; parameters that it does not expose have their value."""
    before = ca.GlobalOptions.getNumpyMode()
    ca.GlobalOptions.setNumpyMode(1)
    try:
        theta = {name: ca.SX.sym(name) for name in model.parameter_fields()}
        joint = build(model.parameters, {**flatten(parameters.values), **theta})
        found = Graph(theta, joint, limits(joint))
        if model.moves:
            _partner(found, model)
        else:
            _bounds(found, model)
            kinds = {"harmonic_drive": _drive, "bolted_joint": _bolted, "gear_contact": _gear}
            kinds[model.joint](found, model)
        found.settle()
    finally:
        ca.GlobalOptions.setNumpyMode(before)
    return found


def symbols(name: str, count: int) -> list[ca.SX]:
    """So many symbols."""
    return [ca.SX.sym(f"{name}{i}") for i in range(count)]


def limits(joint: Any) -> list[Limit]:
    """Intervals of parameters that other parameters decide."""
    own = joint.limits() if hasattr(joint, "limits") else []
    return [*own, *(joint.table_limits() if hasattr(joint, "table_limits") else [])]


def _partner(g: Graph, model: Model) -> None:
    names = ("time", *(v.name for v in model.inputs), *(v.name for v in model.outputs[: model.states]))
    v: dict[str, Any] = {name: ca.SX.sym(name) for name in names}
    found = model.evaluate(g.joint, v)
    doc = "time, inputs, states -> outputs"
    g.add_with_seed("outputs", doc, list(v.values()), [found[o.name] for o in model.outputs])


def _bounds(g: Graph, model: Model) -> None:
    ends = [end for limit in g.limits for end in (limit.low, limit.high)]
    g.add("parameter_limits", "-> low, high of every limit that parameters set each other", [], ends)
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    end = symbols("end", 2)
    rows = [e for o in model.outside for e in o.interval(g.joint, (end[0], end[1]), v)]
    doc = "inputs, x and y at the end of the curve -> low, high of every warning"
    g.add("outside_limits", doc, [*v.values(), *end], rows)


@dataclass(frozen=True, slots=True)
class _Settled:
    """A regime that ended below u: its integral is a constant."""

    term: Smooth

    @property
    def lower(self) -> Any:
        return self.term.lower

    @property
    def upper(self) -> Any:
        return self.term.upper

    def spot(self, t: Any) -> float:
        return 0.0

    def integral(self, m: Any, u: Any) -> Any:
        return self.term.integral(m, self.term.upper)


def _regimes(spots: Spots) -> tuple[list[Any], list[Spots]]:
    """Log-areas where a costly term (Gauss-Legendre) begins or ends, and the law in between.

    Between two of them only the terms that are under way need their quadrature.
    """
    terms = [t for row in spots.terms.values() for t in row if isinstance(t, Smooth)]
    ends: list[Any] = []
    for t in terms:
        for end in (t.lower, t.upper):
            if not any(end is known for known in ends):
                ends.append(end)

    def place(end: Any) -> int:
        return next(i for i, known in enumerate(ends) if known is end)

    def at(term: Term, k: int) -> list[Term]:
        if not isinstance(term, Smooth):
            return [term]
        if place(term.upper) < k:
            return [_Settled(term)]
        return [term] if place(term.lower) < k else []

    nothing = Power(0.0, 1.0)
    return ends, [
        replace(
            spots,
            terms={
                n: tuple(new for t in row for new in at(t, k)) or (nothing,) for n, row in spots.terms.items()
            },
        )
        for k in range(len(ends) + 1)
    ]


def _law(g: Graph, law: Any, table: Sequence[str], state: Any = None) -> None:
    """The interface law: what the inversion, the tables and the outputs need of it."""
    spots, u = law.spots(), ca.SX.sym("u")
    switches, regimes = _regimes(spots)
    g.add("law_switches", "-> log-areas between which law_..._0, 1, ... are valid", [], switches)
    g.add("law_ends", "-> log-areas where a regime of the stiffness ends", [], spots.ends)
    head = [law.A_0, law.hardness, spots.reference, spots.m, spots.stiff_onset]
    g.add(
        "law_head",
        "-> A_0 [m2], hardness [Pa], reference area [m2], m, log-area of first stiffness",
        [],
        head,
    )
    for k, regime in enumerate(regimes):
        g.add(f"law_load_{k}", "log-area -> log of load, its slope", [u], regime.log_total("load", u))
        rows = [f(name, u) for name in ("load", *table) for f in (regime.total, regime.slope)]
        doc = f"log-area -> total and slope of load, {', '.join(table)}"
        g.add(f"law_table_{k}", doc, [u], rows)
        if state is not None:
            y = ca.vertcat(*map(ca.SX, state(regime, u)))
            slope = ca.jacobian(y, u)
            doc = "log-area -> state, its slopes, theirs, slope of du/d approach"
            rows = [y, slope, ca.jacobian(slope, u), _rate_slope(regime, u)]
            g.add(f"law_state_{k}", doc, [u], ca.densify(ca.vertcat(*rows)).nz)


def _rate_slope(spots: Spots, u: Any) -> Any:
    """Slope of du/d approach = K/F' in u, without a derivative of the sums."""
    largest = sum(term.spot(u) for term in spots.terms["load"])
    rise = spots.slope("load", u)
    bend = spots.m * (rise + spots.weight * ca.jacobian(largest, u))
    return (spots.slope("normal", u) - spots.total("normal", u) * bend / rise) / rise


def _closing(g: Graph) -> None:
    p, k, bend, z = symbols("x", 4)
    doc = "p, k, dk/dx at the end of the closing, z -> displacement from there, load, stiffness, its slope"
    g.add("closing", doc, [p, k, bend, z], closing(p, k, bend, z))


def _drive(g: Graph, model: Model) -> None:
    drive = g.joint
    _law(g, drive.law, ("normal", "tangential"))
    torque, peak, pressure, z, local, pair, slope = symbols("x", 7)
    g.add("peak", "torque -> peak pressure, its slope", [torque], harmonic_drive.peak_pressure(drive, torque))
    length = harmonic_drive.contact_length(drive)
    head = [length, drive.torque_smoothing, drive.max_torque, drive.pair_scale, drive.K_FTS0]
    g.add("drive_head", "-> contact length, T_s, largest torque, pair_scale, K_FTS0", [], head)
    height = harmonic_drive.height_at(drive, peak, pressure)
    g.add(
        "lobe_height",
        "peak, pressure -> height [m] where the axis has this pressure",
        [peak, pressure],
        [height],
    )
    g.add(
        "lobe_local",
        "peak, height -> pressure on the axis there",
        [peak, z],
        [harmonic_drive.local(drive, peak, z)],
    )
    end = harmonic_drive.angle_at(drive, local, pressure)
    g.add("lobe_end", "pressure on the axis, pressure -> t where it is met", [local, pressure], [end])
    sine, cosine = symbols("t", 2)
    point = harmonic_drive.lobe_point(drive, sine, cosine, z, local)
    y = [point.pressure, point.along**2, point.square - point.along**2, 2.0 / np.pi * point.stretch]
    doc = "sin t, cos t, height, pressure on the axis -> pressure, weights of k_n and k_t, d theta/d t"
    g.add("lobe", doc, [sine, cosine, z, local], y)
    doc = "K_TS on the paper's scale, its slope -> K_WTS, its slope"
    g.add("in_series", doc, [pair, slope], harmonic_drive.in_series(drive, pair, slope))
    v = {i.name: ca.SX.sym(i.name) for i in model.inputs}
    x, load, stiffness = symbols("curve", 3)
    if "tau" in v:
        argument, out = v["tau"], {"phi_rel": x, **harmonic_drive.parts(drive, load, stiffness)}
    else:
        argument = harmonic_drive.wind_up(drive, list(v.values()))
        out = harmonic_drive.torques(drive, list(v.values()), load, stiffness)
    g.add_with_seed("argument", "inputs -> argument of the curve", [*v.values()], [argument])
    y = [out[o.name] for o in model.outputs]
    doc = "inputs, wind-up, torque and stiffness of the curve -> outputs"
    g.add_with_seed("outputs", doc, [*v.values(), x, load, stiffness], y)


def _gear(g: Graph, model: Model) -> None:
    joint = g.joint

    def state(spots: Spots, u: Any) -> list[Any]:
        area = spots.total("area", u)
        return [area, spots.total("elastic_area", u) / area]

    _law(g, joint, ("normal",), state)
    _closing(g)
    f, approach, stiffness, area, elastic = symbols("x", 5)
    g.add_with_seed("argument", "inputs -> pressure", [f], [np.maximum(f, 0.0) / joint.A_0])
    out = gear_contact.contact(joint, f, approach, stiffness, area, elastic)
    doc = "inputs, approach, stiffness of the curve, real area, elastic part -> outputs"
    y = [out[o.name] for o in model.outputs]
    g.add_with_seed("outputs", doc, [f, approach, stiffness, area, elastic], y)


def _bolted(g: Graph, model: Model) -> None:
    joint = g.joint
    _law(g, joint, ("normal",), lambda s, u: [s.total("plastic_work", u), s.total("elastic_work", u)])
    _closing(g)
    equal, tilt, mean, shift = symbols("node", 4)
    preload, moment, *rest = symbols("v", 8)
    doc = "preload, moment -> mean pressure, pressure that the moment adds"
    bolts = bolted_joint.bolt_pressures(joint, preload, moment)
    g.add_with_seed("bolt_pressures", doc, [preload, moment], bolts)
    doc = "equal, tilt, bolt_pressures -> pressure of a node at tightening"
    pressure = bolted_joint.shaped_pressure(equal, tilt, mean, shift)
    g.add_with_seed("shaped_pressure", doc, [equal, tilt, mean, shift], [pressure], fixed=2)
    s_rel, v_rel = rest[:3], rest[3:]
    sums = dict(zip(bolted_joint.SUMS, symbols("sum", len(bolted_joint.SUMS)), strict=True))
    p_max = ca.SX.sym("p_max")
    out = bolted_joint.motion(joint, sums, s_rel, v_rel, p_max)
    doc = f"sums over the nodes ({', '.join(sums)}), s_rel, v_rel, largest pressure -> outputs"
    y = [out[o.name] for o in model.outputs]
    g.add_with_seed("outputs", doc, [*sums.values(), *s_rel, *v_rel, p_max], y)
