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

DEFAULT_CLASS = "8.8"
"""Property class of bolts for the default preload, if none is stated."""
DEFAULT_METHOD = "torque-wrench"
"""Method of tightening if only a torque is stated."""


@dataclass(frozen=True, slots=True)
class AssemblyPreload:
    """Assembly preload of each bolt.

    force                : F_M [N], the mean if it scatters
    min_force, max_force : range of the force [N]; both equal `force` if none is known
    origin               : origin of the value, see parameters.ORIGINS
    source               : source of value and range
    utilisation          : comparative stress over yield strength [1] at `force`; None: unknown property class
    warnings             : one line each
    """

    force: float
    min_force: float
    max_force: float
    origin: str
    source: str
    utilisation: float | None = None
    warnings: tuple[str, ...] = ()

    @property
    def has_range(self) -> bool:
        """Whether a range of the assembly preload is known."""
        return self.max_force > self.min_force

    def add_to(self, parameter_sheet: ParameterSheet) -> None:
        """Add the start value of the input `preload` to the sheet, with its range."""
        parameter_sheet.add_parameter("inputs.preload", self.force, self.origin, self.source)
        if self.has_range:
            parameter_sheet.set_parameter_range("inputs.preload", self.min_force, self.max_force)

    def facts(self) -> dict[str, tuple[float, str, str]]:
        """Facts for the user: range of the preload and utilisation of the yield strength, as far as known."""
        facts = {}
        if self.has_range:
            facts["preload_low"] = (self.min_force, "N", "lower end of the range of the preload")
            facts["preload_high"] = (self.max_force, "N", "upper end of the range of the preload")
        if self.utilisation is not None:
            text = (
                "share of the yield strength that tension and torsion use in tightening (von Mises, VDI "
                f"2230; allowed are {vdi2230.YIELD_UTILISATION:g})"
            )
            facts["yield_utilisation"] = (self.utilisation, "1", text)
        return facts


def find_preload(
    options: DrawingOptions, thread: Thread, bearing_diameter: float, hole_diameter: float
) -> AssemblyPreload:
    """Find the assembly preload from the options of a drawing.

    bearing_diameter, hole_diameter : outer and inner diameter of the face under the head [m]

    Raises ValueError, one line, for options that contradict each other, or a torque that no bolt bears.
    """
    _check_options(options)
    friction = {
        name: parse_quantity(name, options[name])
        if options[name] is not None
        else StatedNumber(vdi2230.DEFAULT_FRICTION, *vdi2230.FRICTION_INTERVAL)
        for name in ("thread_friction", "head_friction")
    }
    mu_G = friction["thread_friction"].value
    if options["torque"] is not None:
        preload = _preload_from_torque(options, thread, bearing_diameter, hole_diameter, friction)
    elif options["preload"] is not None:
        number = parse_quantity("preload", options["preload"])
        preload = AssemblyPreload(*number, "user", "stated on the drawing")
    else:
        name = options["property_class"] or DEFAULT_CLASS
        force = vdi2230.assembly_preload(thread, property_class_strength(name, "yield", thread), mu_G)
        text = f"VDI 2230, Table A1: {thread.name}-{name}, 90 % of the yield strength, mu_G = {mu_G:g}"
        preload = AssemblyPreload(force, force, force, "estimate", text)
    if options["torque"] is None and options["tightening"] is not None:
        method = read_tightening_methods()[options["tightening"]]
        preload = _scatter(preload, method)
    return _check_strength(options, preload, thread, mu_G)


def _check_options(options: DrawingOptions) -> None:
    """Raise ValueError for options that contradict each other, or that would have no effect."""
    if options["preload"] is not None and options["torque"] is not None:
        raise ValueError("--torque with --preload: state one of them")
    for name in ("thread_friction", "head_friction"):
        if options[name] is None or options["torque"] is not None:
            continue
        if name == "head_friction" or options["preload"] is not None:
            raise ValueError(
                f"{format_option_flag(name)} has no effect without --torque; state --torque, or leave it out"
            )


def _preload_from_torque(
    options: DrawingOptions,
    thread: Thread,
    bearing_diameter: float,
    hole_diameter: float,
    friction: dict[str, StatedNumber],
) -> AssemblyPreload:
    """Assembly preload from the tightening torque: F_M = M_A/(0.16 P + 0.58 d_2 mu_G + D_Km mu_K/2)."""
    torque, name = parse_quantity("torque", options["torque"]), options["tightening"] or DEFAULT_METHOD
    method = read_tightening_methods()[name]
    diameter = vdi2230.head_friction_diameter(bearing_diameter, hole_diameter)

    def force(moment: float, mu_G: float, mu_K: float) -> float:
        """Preload [N] of a bolt at a torque [N.m] and coefficients of friction [1]."""
        d_2 = vdi2230.pitch_diameter(thread)
        return moment / vdi2230.torque_per_preload(thread.pitch, d_2, diameter, mu_G, mu_K)

    mu_G, mu_K = friction["thread_friction"], friction["head_friction"]
    mean, lowest, highest = (force(moment, mu_G.value, mu_K.value) for moment in torque)
    text = (
        f"VDI 2230: M_A = {torque.value:g} N.m over 0.16 P + 0.58 d_2 mu_G + D_Km mu_K/2 of {thread.name}, "
        f"D_Km = {diameter * 1e3:.4g} mm, {_friction_text(options, friction)}"
    )
    is_known = all(options[each] is not None for each in friction)
    preload = AssemblyPreload(mean, lowest, highest, "derived" if is_known else "estimate", text)
    preload = _scatter(preload, method)
    if not method.depends_on_friction or not (mu_G.is_range or mu_K.is_range):
        return preload
    low = force(torque.low, mu_G.high, mu_K.high)
    high = force(torque.high, mu_G.low, mu_K.low)
    return AssemblyPreload(
        preload.force,
        min(preload.min_force, low),
        max(preload.max_force, high),
        preload.origin,
        f"{preload.source}; friction alone: {low * 1e-3:.4g} to {high * 1e-3:.4g} kN",
    )


def _friction_text(options: DrawingOptions, friction: dict[str, StatedNumber]) -> str:
    """Coefficients of friction of thread and head, with their sources."""
    texts = []
    for name, symbol in (("thread_friction", "mu_G"), ("head_friction", "mu_K")):
        number, text = friction[name], f"{symbol} = {friction[name].value:g}"
        interval = f"{number.low:g} to {number.high:g}"
        if options[name] is None:
            text += f" ({vdi2230.FRICTION_SOURCE}: {interval})"
        elif number.is_range:
            text += f" (stated: {interval})"
        texts.append(text)
    return ", ".join(texts)


def _scatter(preload: AssemblyPreload, method: TighteningMethod) -> AssemblyPreload:
    """Assembly preload with the scatter of a method of tightening.

    The scatter is that of the greatest alpha_A in Table A8 of VDI 2230.
    """
    least, greatest = method.tightening_factors
    scatter = vdi2230.preload_scatter(greatest)
    return AssemblyPreload(
        preload.force,
        preload.min_force * (1.0 - scatter),
        preload.max_force * (1.0 + scatter),
        preload.origin,
        f"{preload.source}; {method.title}: alpha_A = {least:g} to {greatest:g} (VDI 2230, Table A8), "
        f"+-{scatter:.0%}",
    )


def _check_strength(
    options: DrawingOptions, preload: AssemblyPreload, thread: Thread, thread_friction: float
) -> AssemblyPreload:
    """Add the utilisation of the yield strength to an assembly preload, and a warning if it is too high.

    A preload above the proof load is warned of by `common.pressure`.

    Raises ValueError for a torque whose preload is implausibly small, or at which the bolt yields (without a
    stated property class: the strongest bolt).
    """
    stated = options["property_class"]
    name = stated or vdi2230.STRONGEST_PROPERTY_CLASS
    strength = property_class_strength(name, "yield", thread)
    utilisation = vdi2230.comparative_stress(thread, preload.force, thread_friction) / strength
    bolt = f"{thread.name}-{name}" + ("" if stated else ", the strongest class")
    allowed = vdi2230.assembly_preload(thread, strength, thread_friction)
    if options["torque"] is not None:
        torque, lowest = (
            parse_quantity("torque", options["torque"]).value,
            QUANTITIES["preload"].plausible_range[0],
        )
        if preload.force < lowest:
            raise ValueError(
                f"--torque = {options['torque']!r} tightens to {preload.force:.3g} N, plausible is at least "
                f"{lowest:g} N; check the unit, as in {torque:g}kN.m"
            )
        if utilisation > 1.0:
            highest = torque * allowed / preload.force
            advice = f"; check the unit, as in {torque:g}N.mm" if utilisation > 10.0 else ""
            raise ValueError(
                f"--torque = {options['torque']!r} tightens to {preload.force * 1e-3:.4g} kN, "
                f"{utilisation:.3g} times the yield strength of {bolt}; expected up to {highest:.3g} N.m "
                f"(VDI 2230: {vdi2230.YIELD_UTILISATION:.0%}){advice}"
            )
    if stated is None:
        return preload
    proof_load = property_class_strength(name, "proof", thread) * vdi2230.stress_area(thread)
    warnings = []
    if preload.force <= proof_load and utilisation > vdi2230.YIELD_UTILISATION * (
        1.0 + vdi2230.MAX_UTILISATION_ERROR
    ):
        warnings = [
            f"preload = {preload.force:.4g} N uses {utilisation:.0%} of the yield strength of {bolt} in "
            f"tightening (VDI 2230, von Mises), allowed are {vdi2230.YIELD_UTILISATION:.0%}: {allowed:.4g} N"
        ]
    source = f"{preload.source}; {vdi2230.describe_stated_bolt(thread.name, name)}"
    return replace(preload, source=source, utilisation=utilisation, warnings=tuple(warnings))
