"""What the library holds of one joint: its component, and the records of the package Data that fill it in."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from jointfmu.parameters import ParameterFile

from .tables import TOLERANCE, InterpolationTable
from .text import COMPUTED, GIVEN, matrix, number, text

WorkingPoint = tuple[float, ...]
"""Values of the inputs Kind.working_point of a joint, SI; empty for a joint that has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelicaRecord:
    """A joint as a table.

    name   : of the record, an identifier
    title  : the same as words
    table  : load over displacement
    values : {name in the base record: expression} besides the table
    more   : what the table's error refers to, where not to each value
    """

    name: str
    title: str
    table: InterpolationTable
    values: Mapping[str, str] = field(default_factory=dict)
    more: str = ""

    @property
    def end(self) -> float:
        """Largest load of the table."""
        return float(self.table.rows[-1, 1])

    def content(self, base: str) -> dict[str, object]:
        """What the template of records needs; `base` is the record that it extends."""
        return {
            "name": self.name,
            "title": text(self.title),
            "base": base,
            "values": {**self.values, "table": matrix(self.table.rows)},
            "about": text(f"From the parameters {self.title}."),
            "error": f"{max(self.table.error, TOLERANCE):.0e}",
            "more": self.more,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelicaComponent:
    """COMPONENT in the folder `modelica` of a joint.

    The templates lie beside it as in the library: Components/NAME.mo and Data/BASE.mo. The component's gets
    the meanings of parameters `meta` and of outputs `docs`, the FMU's page `html`, the name of its first
    record `record`, and `texts`.

    name    : of the component, and of the FMU that it stands for
    base    : of its records
    points  : working points of the records unless others are asked for
    records : (parameters, working points) -> a record for each, the first the component's own
    texts   : first record -> {name: text}
    flanges : names of its flanges
    of_system : parameters -> {parameter of the component: text} that a system sets beside the record
    special : parameters of the joint that only these decide, not the record's table
    note    : HTML for the description of all components
    """

    name: str
    base: str
    points: Sequence[WorkingPoint] = ((),)
    records: Callable[[ParameterFile, Sequence[WorkingPoint]], list[ModelicaRecord]]
    texts: Callable[[ModelicaRecord], Mapping[str, str]]
    note: str = ""
    flanges: Sequence[str] = ("flange_a", "flange_b")
    of_system: Callable[[ParameterFile], Mapping[str, str]] = lambda file: {}
    special: Sequence[str] = ()


def given(values: Mapping[str, float]) -> dict[str, str]:
    """Values of a file as expressions."""
    return {name: number(value, GIVEN) for name, value in values.items()}


def computed(values: Mapping[str, float]) -> dict[str, str]:
    """Values computed from those of a file as expressions."""
    return {name: number(value, COMPUTED) for name, value in values.items()}
