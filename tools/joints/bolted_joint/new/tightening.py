"""Assembly preload of the bolts: stated, from the tightening torque, or from Table A1 of VDI 2230."""

from dataclasses import dataclass, replace

from ....common.options import format_option_flag
from ....inputs.drawing import vdi2230
from ....inputs.drawing.part import DrawingOptions, ParameterSheet
from ....inputs.drawing.quantities import QUANTITIES, StatedNumber, parse_quantity
from ....inputs.drawing.tables import (
    Thread,
    TighteningMethod,
    property_class_strength,
    read_tightening_methods,
)

DEFAULT_PROPERTY_CLASS = "8.8"
"""Property class of bolts for the default preload, if none is stated."""
DEFAULT_TIGHTENING_METHOD = "torque-wrench"
"""Method of tightening if only a torque is stated."""


@dataclass(frozen=True, slots=True)
class AssemblyPreload:
    """Assembly preload of each bolt.

    preload_force        : F_M [N], the mean if it scatters
    min_preload_force, max_preload_force : range of the force [N]; both equal `preload_force` if none is known
    preload_origin       : origin of the value, see parameters.VALUE_ORIGINS
    preload_source       : source of value and range
    friction_at_max_preload : coefficient of friction in the thread [1] at `max_preload_force`; None: that at
                           `preload_force`
    yield_utilisation, max_yield_utilisation : comparative stress over yield strength [1] at `preload_force`
                           and at `max_preload_force`; None: the property class is not known
    preload_warnings     : one line each
    """

    preload_force: float
    min_preload_force: float
    max_preload_force: float
    preload_origin: str
    preload_source: str
    friction_at_max_preload: float | None = None
    yield_utilisation: float | None = None
    max_yield_utilisation: float | None = None
    preload_warnings: tuple[str, ...] = ()

    @property
    def has_range(self) -> bool:
        """Whether a range of the assembly preload is known."""
        return self.max_preload_force > self.min_preload_force

    def add_to_sheet(self, parameter_sheet: ParameterSheet) -> None:
        """Add the start value of the input `preload` to the parameter sheet, with its range."""
        parameter_sheet.add_parameter(
            "inputs.preload", self.preload_force, self.preload_origin, self.preload_source
        )
        if self.has_range:
            parameter_sheet.set_parameter_range(
                "inputs.preload", self.min_preload_force, self.max_preload_force
            )

    def describe_scatter_and_utilisation(self) -> dict[str, tuple[float, str, str]]:
        """Range of the preload and utilisation of the yield strength for the user, as far as known."""
        facts = {}
        if self.has_range:
            facts["preload_low"] = (self.min_preload_force, "N", "lower end of the range of the preload")
            facts["preload_high"] = (self.max_preload_force, "N", "upper end of the range of the preload")
        if self.yield_utilisation is not None:
            text = (
                "share of the yield strength that tension and torsion use in tightening (von Mises, VDI "
                f"2230; allowed are {vdi2230.YIELD_UTILISATION:g})"
            )
            facts["yield_utilisation"] = (self.yield_utilisation, "1", text)
        if self.has_range and self.max_yield_utilisation is not None:
            text = "share of the yield strength that is used at preload_high"
            facts["yield_utilisation_high"] = (self.max_yield_utilisation, "1", text)
        return facts


def find_assembly_preload(
    drawing_options: DrawingOptions, thread: Thread, bearing_diameter: float, hole_diameter: float
) -> AssemblyPreload:
    """Find the assembly preload from the options of a drawing.

    bearing_diameter, hole_diameter : outer and inner diameter of the face under the head [m]

    Raises ValueError, one line, for options that contradict each other, or a torque that no bolt bears.
    """
    _check_preload_options(drawing_options)
    friction = {
        name: parse_quantity(name, drawing_options[name])
        if drawing_options[name] is not None
        else StatedNumber(vdi2230.DEFAULT_BOLT_FRICTION, *vdi2230.BOLT_FRICTION_INTERVAL)
        for name in ("thread_friction", "head_friction")
    }
    mu_G = friction["thread_friction"].stated_value
    if drawing_options["torque"] is not None:
        preload = _preload_from_torque(drawing_options, thread, bearing_diameter, hole_diameter, friction)
    elif drawing_options["preload"] is not None:
        number = parse_quantity("preload", drawing_options["preload"])
        preload = AssemblyPreload(*number, "user", "stated on the drawing")
    else:
        name = drawing_options["property_class"] or DEFAULT_PROPERTY_CLASS
        force = vdi2230.assembly_preload(thread, property_class_strength(name, "yield", thread), mu_G)
        text = f"VDI 2230, Table A1: {thread.thread_name}-{name}, 90 % of the yield strength, mu_G = {mu_G:g}"
        preload = AssemblyPreload(force, force, force, "estimate", text)
    if drawing_options["torque"] is None and drawing_options["tightening"] is not None:
        method = read_tightening_methods()[drawing_options["tightening"]]
        preload = _add_scatter_range(preload, method)
    return _check_bolt_strength(drawing_options, preload, thread, mu_G)


def _check_preload_options(drawing_options: DrawingOptions) -> None:
    """Raise ValueError for options that contradict each other, or that would have no effect."""
    if drawing_options["preload"] is not None and drawing_options["torque"] is not None:
        raise ValueError("--torque with --preload: state one of them")
    for name in ("thread_friction", "head_friction"):
        if drawing_options[name] is None or drawing_options["torque"] is not None:
            continue
        if name == "head_friction" or drawing_options["preload"] is not None:
            raise ValueError(
                f"{format_option_flag(name)} has no effect without --torque; state --torque, or leave it out"
            )


def _preload_from_torque(
    drawing_options: DrawingOptions,
    thread: Thread,
    bearing_diameter: float,
    hole_diameter: float,
    friction_coefficients: dict[str, StatedNumber],
) -> AssemblyPreload:
    """Assembly preload from the tightening torque: F_M = M_A/(0.16 P + 0.58 d_2 mu_G + D_Km mu_K/2).

    VDI 2230: M_A torque, P pitch, d_2 pitch diameter, D_Km effective diameter of the friction under the head,
    mu_G and mu_K friction coefficients of thread and head.
    """
    torque, name = (
        parse_quantity("torque", drawing_options["torque"]),
        drawing_options["tightening"] or DEFAULT_TIGHTENING_METHOD,
    )
    method = read_tightening_methods()[name]
    diameter = vdi2230.head_friction_diameter(bearing_diameter, hole_diameter)

    def preload_at_torque(tightening_torque: float, mu_G: float, mu_K: float) -> float:
        """Preload [N] of a bolt at a torque [N.m] and coefficients of friction [1]."""
        d_2 = vdi2230.pitch_diameter(thread)
        return tightening_torque / vdi2230.torque_per_preload(thread.pitch, d_2, diameter, mu_G, mu_K)

    mu_G, mu_K = friction_coefficients["thread_friction"], friction_coefficients["head_friction"]
    mean, lowest, highest = (
        preload_at_torque(moment, mu_G.stated_value, mu_K.stated_value) for moment in torque
    )
    text = (
        f"VDI 2230: M_A = {torque.stated_value:g} N.m over 0.16 P + 0.58 d_2 mu_G + D_Km mu_K/2 of "
        f"{thread.thread_name}, D_Km = {diameter * 1e3:.4g} mm, "
        f"{_describe_friction(drawing_options, friction_coefficients)}"
    )
    is_known = all(drawing_options[each] is not None for each in friction_coefficients)
    preload = AssemblyPreload(mean, lowest, highest, "derived" if is_known else "estimate", text)
    preload = _add_scatter_range(preload, method)
    if not method.depends_on_friction or not (mu_G.is_range or mu_K.is_range):
        return preload
    low = preload_at_torque(torque.lower_limit, mu_G.upper_limit, mu_K.upper_limit)
    high = preload_at_torque(torque.upper_limit, mu_G.lower_limit, mu_K.lower_limit)
    return AssemblyPreload(
        preload.preload_force,
        min(preload.min_preload_force, low),
        max(preload.max_preload_force, high),
        preload.preload_origin,
        f"{preload.preload_source}; friction alone: {low * 1e-3:.4g} to {high * 1e-3:.4g} kN",
        mu_G.lower_limit if high > preload.max_preload_force else None,
    )


def _describe_friction(
    drawing_options: DrawingOptions, friction_coefficients: dict[str, StatedNumber]
) -> str:
    """Describe the coefficients of friction of thread and head as text, with their sources."""
    texts = []
    for name, symbol in (("thread_friction", "mu_G"), ("head_friction", "mu_K")):
        number, text = friction_coefficients[name], f"{symbol} = {friction_coefficients[name].stated_value:g}"
        interval = f"{number.lower_limit:g} to {number.upper_limit:g}"
        if drawing_options[name] is None:
            text += f" ({vdi2230.BOLT_FRICTION_SOURCE}: {interval})"
        elif number.is_range:
            text += f" (stated: {interval})"
        texts.append(text)
    return ", ".join(texts)


def _add_scatter_range(
    assembly_preload: AssemblyPreload, tightening_method: TighteningMethod
) -> AssemblyPreload:
    """Add the range of the assembly preload that follows from the scatter of a tightening method.

    The scatter is that of the greatest tightening factor alpha_A in Table A8 of VDI 2230.
    """
    least, greatest = tightening_method.tightening_factors
    scatter = vdi2230.preload_scatter(greatest)
    return AssemblyPreload(
        assembly_preload.preload_force,
        assembly_preload.min_preload_force * (1.0 - scatter),
        assembly_preload.max_preload_force * (1.0 + scatter),
        assembly_preload.preload_origin,
        f"{assembly_preload.preload_source}; {tightening_method.display_title}: alpha_A = {least:g} to "
        f"{greatest:g} (VDI 2230, Table A8), +-{scatter:.0%}",
    )


def _check_bolt_strength(
    drawing_options: DrawingOptions, stated_preload: AssemblyPreload, thread: Thread, thread_friction: float
) -> AssemblyPreload:
    """Add the utilisation of the yield strength to an assembly preload, and warnings if it is too high.

    `common.pressure` warns if the preload or its range exceeds the proof load.

    Raises ValueError for a torque whose preload is implausibly small, or at which the bolt yields (without a
    stated property class: the strongest bolt).
    """
    stated = drawing_options["property_class"]
    name = stated or vdi2230.STRONGEST_PROPERTY_CLASS
    strength = property_class_strength(name, "yield", thread)
    utilisation = vdi2230.comparative_stress(thread, stated_preload.preload_force, thread_friction) / strength
    bolt = f"{thread.thread_name}-{name}" + ("" if stated else ", the strongest class")
    allowed = vdi2230.assembly_preload(thread, strength, thread_friction)
    if drawing_options["torque"] is not None:
        torque, lowest = (
            parse_quantity("torque", drawing_options["torque"]).stated_value,
            QUANTITIES["preload"].plausible_range[0],
        )
        if stated_preload.preload_force < lowest:
            raise ValueError(
                f"--torque = {drawing_options['torque']!r} tightens to {stated_preload.preload_force:.3g} N, "
                f"plausible is at least {lowest:g} N; check the unit, as in {torque:g}kN.m"
            )
        if utilisation > 1.0:
            highest = torque * allowed / stated_preload.preload_force
            advice = f"; check the unit, as in {torque:g}N.mm" if utilisation > 10.0 else ""
            raise ValueError(
                f"--torque = {drawing_options['torque']!r} tightens to "
                f"{stated_preload.preload_force * 1e-3:.4g} kN, {utilisation:.3g} times the yield strength "
                f"of {bolt}; expected up to {highest:.3g} N.m (VDI 2230: "
                f"{vdi2230.YIELD_UTILISATION:.0%}){advice}"
            )
    proof_load = property_class_strength(name, "proof", thread) * vdi2230.stress_area(thread)
    max_friction = stated_preload.friction_at_max_preload
    max_utilisation = (
        vdi2230.comparative_stress(
            thread,
            stated_preload.max_preload_force,
            thread_friction if max_friction is None else max_friction,
        )
        / strength
    )
    allowed_utilisation = vdi2230.YIELD_UTILISATION * (1.0 + vdi2230.MAX_YIELD_UTILISATION_EXCESS)
    warnings = []
    if stated and stated_preload.preload_force <= proof_load and utilisation > allowed_utilisation:
        warnings.append(
            f"preload = {stated_preload.preload_force:.4g} N uses {utilisation:.0%} of the yield strength of "
            f"{bolt} in tightening (VDI 2230, von Mises), allowed are {vdi2230.YIELD_UTILISATION:.0%}: "
            f"{allowed:.4g} N"
        )
    if stated_preload.has_range and max_utilisation > allowed_utilisation:
        factor = vdi2230.YIELD_UTILISATION / max_utilisation
        advice = f"--preload {stated_preload.preload_force * factor:.4g}N"
        if drawing_options["torque"] is not None:
            torque = parse_quantity("torque", drawing_options["torque"]).stated_value
            advice = f"--torque {torque * factor:.3g}"
        warnings.append(
            f"preload_high = {stated_preload.max_preload_force:.4g} N uses {max_utilisation:.0%} of the "
            f"yield strength of {bolt} in tightening (VDI 2230, von Mises), allowed are "
            f"{vdi2230.YIELD_UTILISATION:.0%}: with this scatter and friction, state at most {advice}"
        )
    if stated is None:
        return replace(stated_preload, preload_warnings=tuple(warnings))
    source = f"{stated_preload.preload_source}; {vdi2230.describe_stated_bolt(thread.thread_name, name)}"
    return replace(
        stated_preload,
        preload_source=source,
        yield_utilisation=utilisation,
        max_yield_utilisation=max_utilisation,
        preload_warnings=tuple(warnings),
    )
