"""Jinja templates of documentation pages and generated C."""

from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from jointfmu.contact.laws import ROUGHNESS_LAW_NAME
from jointfmu.contact.laws.roughness import FEW_SPOTS_STIFFNESS_FACTOR
from jointfmu.contact.laws.table import StiffnessTable
from jointfmu.parameters import ParameterFile

PAGE_TEMPLATE_FOLDER = Path(__file__).with_name("native")
"""Folder of the page templates that the pages of joints extend."""


def load_jinja_template(template_path: Path, *template_folders: Path) -> jinja2.Template:
    """Load a Jinja template of a page or C file; in HTML values are escaped, undefined names are errors.

    Templates can call `number` (format a value) and `policy` (Content-Security-Policy of a page).

    template_folders : folders of further templates that this one extends or imports
    """
    return _make_jinja_environment(
        (template_path.parent, *template_folders), template_path.suffix == ".html"
    ).get_template(template_path.name)


@cache
def _make_jinja_environment(template_folders: tuple[Path, ...], escape_html: bool) -> jinja2.Environment:
    """Make the Jinja environment of template folders; cached, because it keeps compiled templates."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(template_folders),
        autoescape=escape_html,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.globals["number"] = _format_page_value
    environment.globals["policy"] = _make_security_policy_element
    return environment


def _make_security_policy_element(
    page_script: str = "", uses_webassembly: bool = False, image_sources: str = "data:"
) -> Markup:
    """HTML meta element with the Content-Security-Policy of a page: no network, only the page's own script.

    page_script : full text of the script element; empty: no script is allowed
    uses_webassembly : whether the script compiles WebAssembly
    image_sources : sources of images, as the policy names them
    """
    digest = b64encode(sha256(page_script.encode()).digest()).decode()
    allowed = (
        f"'sha256-{digest}'" + (" 'wasm-unsafe-eval'" if uses_webassembly else "")
        if page_script
        else "'none'"
    )
    content = (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src {image_sources}; "
        "base-uri 'none'; form-action 'none'"
    )
    return Markup('<meta http-equiv="Content-Security-Policy" content="{}">').format(Markup(content))


def _format_page_value(page_value: float | str) -> str:
    """Format a value for a page: six significant digits, booleans in lower case, text unchanged."""
    if isinstance(page_value, bool | str):
        return str(page_value).lower() if isinstance(page_value, bool) else page_value
    return f"{page_value:.6g}"


def make_law_template_variables(parameter_file: ParameterFile) -> dict[str, object]:
    """Variables {name: value} that describe the interface law on a joint's documentation page.

    `law_page` is the template that explains the laws `roughness` and `table`; other laws have none.
    """
    table: Any = getattr(parameter_file.values, "table", None)
    is_rough, is_table = parameter_file.law == ROUGHNESS_LAW_NAME, isinstance(table, StiffnessTable)
    return {
        "law": parameter_file.law,
        "rough": is_rough,
        "tabular": is_table,
        "has_law_page": is_rough or is_table,
        "law_page": "table.html" if is_table else "roughness.html",
        "few_spots": FEW_SPOTS_STIFFNESS_FACTOR,
        "point_pressures": table.pressure if is_table else (),
    }
