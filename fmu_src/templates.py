"""Jinja templates of documentation pages and generated C."""

from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from jointfmu.contact.laws import ROUGHNESS_LAW
from jointfmu.contact.laws.roughness import FEW_SPOTS_STIFFNESS_FACTOR
from jointfmu.contact.laws.table import StiffnessTable
from jointfmu.parameters import ParameterFile

PAGE_FOLDER = Path(__file__).with_name("native")
"""Folder of the page templates that the pages of joints extend."""


def load_template(path: Path, *template_folders: Path) -> jinja2.Template:
    """Load a Jinja template; HTML templates escape their values, and an undefined name is an error.

    All templates can call `number` (format a value) and `policy` (Content-Security-Policy of a page).

    template_folders : folders of further templates that this one extends or imports
    """
    return _make_environment((path.parent, *template_folders), path.suffix == ".html").get_template(path.name)


@cache
def _make_environment(folders: tuple[Path, ...], escape_html: bool) -> jinja2.Environment:
    """Make the Jinja environment of template folders; cached, because it keeps compiled templates."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        autoescape=escape_html,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.globals["number"] = _format_number
    environment.globals["policy"] = _security_policy
    return environment


def _security_policy(script: str = "", webassembly: bool = False, images: str = "data:") -> Markup:
    """HTML meta element with the Content-Security-Policy of a page: no network, only the page's own script.

    script      : full text of the script element; empty: no script is allowed
    webassembly : whether the script compiles WebAssembly
    images      : sources of images, as the policy names them
    """
    digest = b64encode(sha256(script.encode()).digest()).decode()
    allowed = f"'sha256-{digest}'" + (" 'wasm-unsafe-eval'" if webassembly else "") if script else "'none'"
    content = (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src {images}; "
        "base-uri 'none'; form-action 'none'"
    )
    return Markup('<meta http-equiv="Content-Security-Policy" content="{}">').format(Markup(content))


def _format_number(value: float | str) -> str:
    """Format a value for a page: six significant digits, booleans in lower case, text unchanged."""
    if isinstance(value, bool | str):
        return str(value).lower() if isinstance(value, bool) else value
    return f"{value:.6g}"


def law_variables(parameters: ParameterFile) -> dict[str, object]:
    """{name: value} of the interface law that the template of a joint's page uses.

    The values are the name of the law, whether it is `roughness` or `table`, their template, and numbers.
    """
    table: Any = getattr(parameters.values, "table", None)
    is_rough, is_table = parameters.law == ROUGHNESS_LAW, isinstance(table, StiffnessTable)
    return {
        "law": parameters.law,
        "rough": is_rough,
        "tabular": is_table,
        "has_law_page": is_rough or is_table,
        "law_page": "table.html" if is_table else "roughness.html",
        "few_spots": FEW_SPOTS_STIFFNESS_FACTOR,
        "point_pressures": table.pressure if is_table else (),
    }
