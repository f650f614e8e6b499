"""The class Law: an interface law with its parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.contact.interface import evaluate_at_largest_spot, evaluate_at_pressure
from jointfmu.contact.laws import LAWS
from jointfmu.quantity import Array, flatten_fields, flatten_parameters

from ..common import plots
from ..common.judgement import assess_law_stiffness
from ..common.shown import format_quantity
from ..inputs.laws import LAW_OUTPUT_COLUMNS, LAW_OUTPUT_UNITS, build_law_parameters, find_surface_rms_height
from ..run.ramps.ramp import broadcast_columns
from .frame import Frame, Table, TableDisplay

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Law(TableDisplay):
    """An interface law: load, stiffness, real area and dissipation of two rough surfaces in contact.

    parameters : parameter set of the law, see `values`; numbers or arrays (n)
    h          : rms height of both surfaces together [m], to judge the stiffness; None: not known

    >>> import jointfmu
    >>> law = jointfmu.law("roughness", Ra1=0.8e-6, Ra2=0.8e-6)
    >>> K = law.at_pressure([1e6, 2e6])["K_N"]
    >>> bool(1.9 < K[1] / K[0] < 2.1)
    True
    """

    name: str
    parameters: Any
    h: Any = None

    @property
    def values(self) -> dict[str, object]:
        """Parameters of the law: {structured name: value [SI]}."""
        return flatten_parameters(self.parameters)

    def _build_table(self) -> Table:
        """Build the table that is printed for the law: name, value, unit and meaning of its parameters."""
        fields = {name: item.metadata for name, item in flatten_fields(type(self.parameters))}
        rows = [
            (name, *format_quantity(value, fields[name].get("unit")), fields[name]["doc"])
            for name, value in self.values.items()
        ]
        return Table(f"law {self.name}", ("name", "value", "unit", "meaning"), rows)

    def at_pressure(self, pressure: ArrayLike) -> Frame:
        """Evaluate the law at nominal pressures (n) [Pa].

        Columns of the result, for the nominal area A_0: load F [N], normal and tangential stiffness K_N and
        K_T [N/m], real contact area A_r [m2].
        The `messages` of the result warn if the stiffness is implausible, or if a pressure is outside the
        range of the law. Arrays of parameters are not judged.

        Raises ValueError for a pressure that is negative, NaN, infinite or not representable, or arrays of
        different lengths.
        """
        state = evaluate_at_pressure(self.parameters, self._to_parameter_column("pressure", pressure))
        if many := ", ".join(self._array_parameters):
            return self._build_result_frame(
                state, (f"stiffness and pressure are not checked for plausibility with arrays of {many}",)
            )
        return self._build_result_frame(
            state, assess_law_stiffness(self.parameters, state["pressure"].tolist(), self.h).warnings
        )

    def at_largest_spot(self, area: ArrayLike) -> Frame:
        """Evaluate the law for areas (n) [m2] of the largest contact spot."""
        return self._build_result_frame(
            evaluate_at_largest_spot(self.parameters, self._to_parameter_column("largest_spot", area)), ()
        )

    @property
    def _array_parameters(self) -> dict[str, Array]:
        """Parameters of the law that are arrays: {structured name: array (n)}."""
        return {name: value for name, value in self.values.items() if isinstance(value, np.ndarray)}

    def _to_parameter_column(self, column_name: str, column_values: ArrayLike) -> Array:
        """Convert values to an array (n) or (1). Raises ValueError if parameters have another length."""
        column = np.ravel(np.asarray(column_values, dtype=np.float64))
        broadcast_columns({column_name: column, **self._array_parameters}, f"law {self.name}")
        return column

    def _build_result_frame(
        self, contact_quantities: Mapping[str, Any], warning_lines: tuple[str, ...]
    ) -> Frame:
        """Build the result from contact quantities {symbol: values}, with warnings as its messages."""
        names = [
            name
            for name in (*LAW_OUTPUT_COLUMNS, *(n for n in contact_quantities if n not in LAW_OUTPUT_COLUMNS))
            if name in contact_quantities
        ]
        defined = {
            name: contact_quantities[name]
            for name in names
            if not np.size(contact_quantities[name]) or not np.all(np.isnan(contact_quantities[name]))
        }
        return Frame(defined, LAW_OUTPUT_UNITS, warning_lines)

    @plots.apply_plot_style()
    def plot(self, pressure: ArrayLike | None = None) -> "Figure":
        """Draw normal and tangential stiffness per area as functions of the pressure; returns a figure."""
        p = (
            np.geomspace(1e5, 1e8, 60)
            if pressure is None
            else np.ravel(np.asarray(pressure, dtype=np.float64))
        )
        frame = self.at_pressure(p)
        figure = plots.create_figure((6.4, 4.0))
        axes = figure.subplots()
        for name, color in (("K_N", plots.BLUE), ("K_T", plots.RED)):
            if name in frame and np.all(np.isfinite(frame[name])):
                axes.loglog(p / 1e6, frame[name] / self.parameters.A_0 * 1e-12, color=color, label=name)
        axes.set(xlabel="pressure [MPa]", ylabel="stiffness per area [N/(um mm2)]", title=self.name)
        axes.legend()
        return figure


def law(name: str, **parameters: Any) -> Law:
    """Make an interface law: `roughness`, `table`, `zhao2018`, `hu2023` or `yu2022`.

    parameters : values or arrays (n) [SI] by name, structured names as `**{"surface.D": 1.42}`. Parameters
        that are not named have the values of the shipped joint with this law.
        `roughness` takes Ra1, Ra2, Rq1, Rq2 or h.

    Raises ValueError for an unknown law or parameter, or a value outside its interval.

    >>> import jointfmu
    >>> jointfmu.law("zhao2018", **{"surface.D": 1.42}).values["surface.D"]
    1.42
    """
    if name not in LAWS:
        raise ValueError(f"law = {name!r}, allowed are {', '.join(LAWS)}")
    settings = {n: np.ravel(v) if np.ndim(v) else v for n, v in parameters.items()}
    values = build_law_parameters(name, None, settings)
    return Law(name, values, find_surface_rms_height(name, values, None, settings))
