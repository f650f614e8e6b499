"""`python -m jointfmu`: the command line as it is installed, which stands above this package."""

import sys
from importlib.metadata import entry_points

(command_line,) = entry_points(group="console_scripts", name="jointfmu")
sys.exit(command_line.load()())
