"""`python -m jointfmu`: runs the installed command `jointfmu`, found by its entry point."""

import sys
from importlib.metadata import entry_points

(command_line,) = entry_points(group="console_scripts", name="jointfmu")
sys.exit(command_line.load()())
