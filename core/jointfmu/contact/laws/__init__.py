"""Interface laws, one module each. LAWS lists them all."""

from .hu2023 import Hu2023
from .roughness import RoughnessLaw
from .table import TableLaw
from .yu2022 import Yu2022
from .zhao2018 import Zhao2018

ROUGHNESS_LAW_NAME = "roughness"
"""Name of the law with roughness parameters (h, slope, ...) instead of the fractal parameters D and G."""
TABLE_LAW_NAME = "table"
"""Name of the law with measured or published points of the stiffness over the pressure."""
LAWS = {
    "zhao2018": Zhao2018,
    "hu2023": Hu2023,
    "yu2022": Yu2022,
    ROUGHNESS_LAW_NAME: RoughnessLaw,
    TABLE_LAW_NAME: TableLaw,
}
"""{name of the law: its parameter set class}; author and year of a paper, or what is known."""
