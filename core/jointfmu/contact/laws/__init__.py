"""Interface laws, a file each; LAWS is the only list of them."""

from .hu2023 import Hu2023
from .roughness import Roughness
from .yu2022 import Yu2022
from .zhao2018 import Zhao2018

ROUGHNESS_LAW = "roughness"
"""Name of the law whose parameters are the roughness itself, without D and G."""
LAWS = {"zhao2018": Zhao2018, "hu2023": Hu2023, "yu2022": Yu2022, ROUGHNESS_LAW: Roughness}
"""{author and year, or what it starts from: parameters of the law}."""
