"""Command-line options that tools and joints define, and the check that an optional package is installed."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import KW_ONLY, dataclass


@dataclass(frozen=True, slots=True)
class Option:
    """Command-line option, also a keyword argument in Python, of a tool module.

    name         : name in Python; on the command line with hyphens
    help_text    : meaning of the option; for a number with its unit
    metavar      : placeholder of the value in the help
    default      : value if the user does not set the option
    choices      : allowed words; empty: any text
    is_list      : takes several values
    separator    : character between the numbers of one value, for example the x of 200x100
    is_flag      : takes no value
    lone_value   : value if the user states the option without a value; empty: the value is required
    is_required  : the user must set the option
    is_number    : the value is a number in the unit of `help_text`
    default_unit : unit of a number that the user states without a unit
    unit_option  : name of the option that sets the unit of numbers without a unit; this option itself is not
                   passed to the tool module
    """

    name: str
    help_text: str
    metavar: str = "VALUE"
    _: KW_ONLY
    default: float | str | None = None
    choices: Sequence[str] = ()
    is_list: bool = False
    separator: str = ""
    is_flag: bool = False
    lone_value: str = ""
    is_required: bool = False
    is_number: bool = False
    default_unit: str = ""
    unit_option: str = ""


def format_option_flag(argument_name: str) -> str:
    """Option of the command line that sets an argument: `--rated-torque` for `rated_torque`."""
    return "--" + argument_name.replace("_", "-")


@contextmanager
def require_package(package_purpose: str, extra_name: str = "build") -> Iterator[None]:
    """Context that turns a missing package into a one-line ValueError with the install command.

    package_purpose : what the package is needed for, a verb
    extra_name      : extra of jointfmu that installs the package
    """
    try:
        yield
    except ImportError as error:
        raise ValueError(
            f"the package {error.name or error} is missing, needed to {package_purpose}; "
            f"install it with: pip install 'jointfmu[{extra_name}]'"
        ) from None
