"""Fit of a system to a measured record."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu_fmu_src.naming import check_fmu_name

from jointfmu.files.outputs import PARAMETER_FILE, check_output, write_parameter_text

from ..common.options import require_package
from ..inputs.fitting.outcome import FitResult
from ..systems.fit.system_text import format_fitted_system
from ..systems.system import find_system_file, load_system
from .frame import Table, TableDisplay
from .make import make_fit_table, plot_fit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class SystemFit(TableDisplay):
    """Result of a fit of a system; the printed table has each parameter with its uncertainty.

    outcome     : fitted parameters, their uncertainty, and facts about the fit
    system_file : system file with the start values

    >>> import jointfmu
    >>> fit = jointfmu.fit_system("arm.toml", "log.csv", ["link.J"])  # doctest: +SKIP
    >>> fit.outcome.solution.values["link.J"]  # doctest: +SKIP
    0.0651
    """

    outcome: FitResult
    system_file: Path

    def _build_table(self) -> Table:
        """Build the table that is printed for the fit: each parameter with its uncertainty."""
        return make_fit_table(self.outcome)

    def plot(self) -> "Figure":
        """Draw measured and simulated columns and residuals over time; returns a matplotlib figure."""
        return plot_fit(self.outcome)

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the system file with the fitted values; its comments are not kept.

        force : replace a file that jointfmu did not write, or that was edited

        Raises ValueError if the file may not or cannot be written, or if its name is not valid for a system.
        """
        path = Path(path)
        check_output(path, PARAMETER_FILE, force)
        write_parameter_text(path, self._format_system_file(path))
        return path

    def _format_system_file(self, target_path: Path) -> str:
        """Text of the system file with the fitted values, for a file in the folder of `target_path`."""
        check_fmu_name(target_path.stem)
        unknowns = {u.parameter_name: u.si_unit for u in self.outcome.solution.unknowns}
        return format_fitted_system(self.system_file, self.outcome.parameters, unknowns, target_path)


def fit_system(
    system: str | Path,
    file: str | Path,
    free: str | Sequence[str],
    *,
    hold_out: float = 0.0,
    columns: Sequence[str] = (),
) -> SystemFit:
    """Fit parameters of a system to a measured record, as `jointfmu fit system` does.

    system   : system file (TOML), or name of a shipped system; it has the start values
    file     : record (CSV); the heading names variables of the system and units
    free     : names of the parameters to fit, COMPONENT.PARAMETER, or one name; also states of bodies, whose
               start values are fitted then
    hold_out : fraction [1] of the record, at its end, that is predicted instead of fitted
    columns  : other headings in the file, `NAME=HEADING` or `NAME=HEADING [UNIT]`

    Raises ValueError for bad input, RuntimeError if the fit does not converge or the compiler fails.

    >>> import jointfmu
    >>> fit = jointfmu.fit_system("arm.toml", "log.csv", ["link.J"], hold_out=0.2)  # doctest: +SKIP
    >>> fit.save("fitted_arm.toml")  # doctest: +SKIP
    """
    described = load_system(str(system))
    names = [free] if isinstance(free, str) else free
    with require_package("fit a system"):
        from ..systems.fit.estimate import fit_system as fit_record

        return SystemFit(
            fit_record(described, Path(file), names, hold_out, columns), find_system_file(str(system))
        )
