"""The class Joint: parameters of a joint, its evaluation, plots, FMUs and reports."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.contact.laws import LAWS
from jointfmu.files.outputs import HTML_FILE, PARAMETER_FILE, check_output, write_parameter_text
from jointfmu.joints import KINDS
from jointfmu.joints.model import Model, TabulatedJoint
from jointfmu.parameters import ParameterFile, format_parameter_file
from jointfmu.progress import set_status_text, show_status

from ..common import plots
from ..common.judgement import find_rms_height
from ..common.options import require_package
from ..common.pressure import judge_joint_stiffness
from ..common.shown import format_quantity, list_parameter_file_entries
from ..run.engine import JointEngine, open_joint
from ..run.ramps.ramp import broadcast_columns
from .frame import Frame, Table, TableDisplay
from .law import Law

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DerivedResults = Mapping[str, tuple[float, str, str]]
"""Additional results of a joint: {name: (value [SI], unit, meaning)}."""


@dataclass(frozen=True, repr=False)
class Joint(TableDisplay):
    """A joint with its parameters. The object is immutable: `with_values` returns a new one.

    file  : parameter file, with the source of each number
    facts : additional results {name: (value [SI], unit, meaning)} of a joint from a drawing or a catalogue
    notes : warnings from making the joint, one line each

    >>> import jointfmu
    >>> joint = jointfmu.load("GearContact")
    >>> joint.values["e"]
    0.2
    """

    file: ParameterFile
    facts: DerivedResults = field(default_factory=dict)
    notes: Sequence[str] = ()

    @property
    def name(self) -> str:
        """Name of the parameter set."""
        return self.file.name

    @property
    def values(self) -> dict[str, Any]:
        """Parameters and start values of inputs: {structured name: value [SI]}."""
        return {
            **self.file.values_by_name,
            **{f"inputs.{name}": value for name, value in self.file.inputs.items()},
        }

    @property
    def fmus(self) -> dict[str, Model]:
        """FMUs that can be built of the joint: {name: model with inputs and outputs}.

        Methods evaluate the first one by default.
        """
        return {model.name: model for model in KINDS[self.file.joint].models}

    @property
    def law(self) -> Law:
        """Interface law of the joint.

        Raises ValueError if the joint has none, for example a drive given by a table or by catalogue lines.
        """
        parameters = KINDS[self.file.joint].extract_law(self.file.values)
        if parameters is None:
            raise ValueError(
                f"{self.name}: law = {self.file.law!r} is not the law of an interface; expected one of "
                f"{', '.join(LAWS)}"
            )
        return Law(self.file.law, parameters, find_rms_height(self.file))

    @property
    def warnings(self) -> list[str]:
        """Warnings about the parameters and the stiffness, one line each."""
        return [*self.notes, *judge_joint_stiffness(self.file).warnings]

    @property
    def parameters(self) -> Table:
        """Table of all parameters with value, unit, meaning, kind (origin of the value) and source."""
        rows = [
            (
                entry.entry_name,
                *format_quantity(entry.entry_value, entry.si_unit),
                entry.entry_meaning,
                entry.value_origin,
                entry.value_source,
            )
            for entry in list_parameter_file_entries(self.file)
        ]
        return Table(self._title, ("name", "value", "unit", "meaning", "kind", "source"), rows)

    @property
    def _title(self) -> str:
        """First line of the printed joint: name of the parameter set, kind of joint, law."""
        return f"{self.name}: {KINDS[self.file.joint].title}, law {self.file.law}"

    def _build_table(self) -> Table:
        """Build the table that is printed for the joint: warnings, additional results, parameters."""
        texts = (
            (name, " ".join(format_quantity(v, u, 4)), text) for name, (v, u, text) in self.facts.items()
        )
        facts = [f"{name} = {value.strip()}: {text}" for name, value, text in texts]
        table = self.parameters
        rows = [(name, value, unit, kind, source) for name, value, unit, _, kind, source in table.rows]
        lines = [*facts, *(f"warning: {text}" for text in self.warnings)]
        return Table(table.title, ("name", "value", "unit", "kind", "source"), rows, lines)

    def with_values(self, values: Mapping[str, Any] | None = None, **more: Any) -> "Joint":
        """Return the joint with changed parameters (SI units), names as in the property `values`.

        Raises ValueError, one line, for an unknown name or a value outside its interval.

        >>> import jointfmu
        >>> jointfmu.load("GearContact").with_values(e=0.3).values["e"]
        0.3
        """
        changes = {**(values or {}), **more}
        inputs = {n.removeprefix("inputs."): changes.pop(n) for n in [*changes] if n.startswith("inputs.")}
        known = {v.name for model in self.fmus.values() for v in model.inputs}
        if unknown := [name for name in inputs if name not in known]:
            raise ValueError(f"unknown input {unknown[0]!r}, allowed are {', '.join(sorted(known))}")
        file = self.file.with_values(changes, "user", "set in Python")
        origins = {f"inputs.{name}": "user" for name in inputs}
        file = replace(
            file,
            inputs={**file.inputs, **inputs},
            origins={**file.origins, **origins},
            sources={**file.sources, **dict.fromkeys(origins, "set in Python")},
        )
        return replace(self, file=file, facts={}, notes=())

    def model(self, fmu: str | None = None) -> Model:
        """Model of one of the joint's FMUs: inputs, outputs, units. Raises ValueError for an unknown name."""
        return KINDS[self.file.joint].find_model(fmu).with_parameters(self.file.joint, self.file.values)

    @cached_property
    def spring(self) -> TabulatedJoint:
        """Joint ready for evaluation: parameters and load-displacement tables, which give all outputs."""
        return KINDS[self.file.joint].models[0].tabulate(self.file.values)

    def evaluate(self, fmu: str | None = None, /, **inputs: ArrayLike) -> Frame:
        """Compute every output for given inputs. Each point is loaded on a straight path from rest.

        fmu    : name of one of the joint's FMUs; default: the first
        inputs : numbers or arrays (n) [SI]; inputs that are not named have their start values

        Raises ValueError for an unknown input, a value outside its interval, or arrays of different lengths.

        >>> import jointfmu
        >>> plate = jointfmu.load("BoltedJoint")
        >>> frame = plate.evaluate(preload=9e3, s_rel_x=[0.0, 1e-6])
        >>> bool(frame["f_x"][1] < frame["f_x"][0] == 0.0)
        True
        """
        return self._evaluate_input_points(fmu, inputs, restart_at_each_point=True)

    def follow(self, fmu: str | None = None, /, **inputs: ArrayLike) -> Frame:
        """Compute every output along a path of inputs from rest. Friction keeps its history along the path.

        fmu    : name of one of the joint's FMUs; default: the first
        inputs : numbers or arrays (n) [SI]; inputs that are not named have their start values

        Raises ValueError for an unknown input, a value outside its interval, or arrays of different lengths.

        >>> import jointfmu
        >>> plate = jointfmu.load("BoltedJoint")
        >>> path = plate.follow(preload=9e3, s_rel_x=[0.0, 5e-6, 0.0])
        >>> bool(path["f_x"][2] > 0.0 and path["E_loss"][2] > 0.0)
        True
        """
        return self._evaluate_input_points(fmu, inputs, restart_at_each_point=False)

    def _evaluate_input_points(
        self, fmu_name: str | None, inputs: Mapping[str, ArrayLike], *, restart_at_each_point: bool
    ) -> Frame:
        """Evaluate the joint at one point of the inputs after the other.

        Inputs are broadcast to the same length.
        """
        model = self.model(fmu_name)
        names = [v.name for v in model.inputs]
        if unknown := [name for name in inputs if name not in names]:
            raise ValueError(f"{model.name}: unknown input {unknown[0]!r}, allowed are {', '.join(names)}")
        columns = {name: np.ravel(np.asarray(value, dtype=np.float64)) for name, value in inputs.items()}
        columns, _ = broadcast_columns(columns, model.name)
        for variable in model.inputs:
            outside = [x for x in columns.get(variable.name, ()) if not variable.interval.contains(x)]
            if outside:
                allowed = f"{variable.interval} {variable.unit}"
                raise ValueError(f"{model.name}: {variable.name} = {outside[0]:g} is outside {allowed}")
        if model.name not in self._joint_engines:
            self._joint_engines[model.name] = open_joint(model, self.file)
        found = self._joint_engines[model.name].evaluate_path(
            columns, restart_at_each_point=restart_at_each_point
        )
        units = {v.name: v.unit for v in (*model.inputs, *model.outputs)}
        shown = {n: found.variable_columns[n] for n in units if n in columns or n not in names}
        return Frame(shown, units, found.validity_warnings)

    @cached_property
    def _joint_engines(self) -> dict[str, JointEngine]:
        """Joints that are open for evaluation: {name of the FMU: joint with its compiled library}."""
        return {}

    def __getstate__(self) -> dict[str, Any]:
        """Fields of the object for pickle, without the opened joints, which belong to this process."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    @plots.apply_plot_style()
    def plot(self, fmu: str | None = None) -> "Figure":
        """Draw the outputs as functions of the load, and hysteresis loops, if any; returns a figure."""
        with require_package("draw"):
            from ..pages.report.figure import draw_panels
            from ..pages.report.joint import make_loop_figure, make_ramp_figure
            from ..pages.report.load_history import LoadHistory
        with show_status(f"{self.name}: plot"):
            set_status_text("curves over the load and loops")
            course = LoadHistory(self.model(fmu), self.file)
            panels = list(make_ramp_figure(course).plot_panels)
            loops = course.compute_loops() if course.model.load_cycle else None
        if loops and any(loop.energy_loss for loop in loops.loops):
            panels += make_loop_figure(course, loops).plot_panels
        figure = plots.create_figure((4.4 * len(panels), 3.8))
        draw_panels(figure, panels)
        return figure

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the parameter file (TOML), with the facts as comments at its head.

        force : replace a file that jointfmu did not write, or that was edited

        Raises ValueError if the file may not or cannot be written.
        """
        check_output(path, PARAMETER_FILE, force)
        facts = [
            f"# {name} = {value:.6g} {unit}: {text}\n" for name, (value, unit, text) in self.facts.items()
        ]
        head = "# Computed in addition to the parameters:\n" if facts else ""
        write_parameter_text(path, head + "".join(facts) + format_parameter_file(self.file))
        return Path(path)

    def build(
        self,
        out: str | Path = "dist",
        flavour: str | Sequence[str] = ("fmi2", "fmi3"),
        *,
        fmu: str | None = None,
        name: str | None = None,
        force: bool = False,
    ) -> list[Path]:
        """Build the joint's FMUs as OUT/FLAVOUR/NAME.fmu; returns the paths.

        flavour : fmi2, fmi3, python, or several of them
        fmu     : name of one FMU, a key of `fmus`; default: all
        name    : model name of this one FMU, in place of its own
        force   : replace FMUs of these names that jointfmu did not write

        Raises ValueError for an unknown name or flavour, or a folder that cannot be written.
        """
        flavours = [flavour] if isinstance(flavour, str) else [*flavour]
        names = [*self.fmus] if fmu is None else [self.model(fmu).name]
        with require_package("build"):
            from jointfmu_fmu_src import building

            with show_status(f"{self.name}: build"):
                set_status_text(f"{', '.join(names)} into {out}")
                return building.build_fmus(
                    names, flavours, self.file, Path(out), fmu_alias=name, replace_foreign_files=force
                )

    def report(self, path: str | Path, fmu: str | None = None, *, force: bool = False) -> Path:
        """Write a page about the joint (HTML): curves, loops, sources of its numbers.

        fmu   : FMU that the page describes; default: the first
        force : replace a file that jointfmu did not write

        Raises ValueError if the file may not or cannot be written.
        """
        check_output(path, HTML_FILE, force)
        with require_package("write a report"):
            from ..pages.report.joint import write_joint_report
        with show_status(f"{self.name}: report"):
            write_joint_report(Path(path), self.file, fmu)
        return Path(path)
