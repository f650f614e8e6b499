"""Pages and C from jinja templates."""

from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path

import jinja2
from markupsafe import Markup

from jointfmu.contact.laws import ROUGHNESS_LAW
from jointfmu.contact.laws.roughness import FEW_SPOTS
from jointfmu.parameters import ParameterFile

FRAME = Path(__file__).with_name("native")
"""Folder of the templates that the pages of joints extend."""


def template(path: Path, *shared: Path) -> jinja2.Template:
    """A template; a page escapes what it prints, an unknown name is an error; `number` prints a value,
    `policy` the Content-Security-Policy.

    shared : folders of templates that it extends or imports, beside its own
    """
    return _environment((path.parent, *shared), path.suffix == ".html").get_template(path.name)


@cache
def _environment(folders: tuple[Path, ...], escapes: bool) -> jinja2.Environment:
    """Kept, with the templates that it has compiled."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        autoescape=escapes,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.globals["number"] = _number
    environment.globals["policy"] = _policy
    return environment


def _policy(script: str = "", webassembly: bool = False, images: str = "data:") -> Markup:
    """The Content-Security-Policy of a self-contained page: no network, and no script but the page's own.

    script      : the whole text of the page's script element
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


def _number(value: float | str) -> str:
    """A value as all pages print it: six digits."""
    if isinstance(value, bool | str):
        return str(value).lower() if isinstance(value, bool) else value
    return f"{value:.6g}"


def law_terms(parameters: ParameterFile) -> dict[str, object]:
    """What the templates of joints ask of the law: its name, and `rough`, whether it is `roughness`."""
    return {"law": parameters.law, "rough": parameters.law == ROUGHNESS_LAW, "few_spots": FEW_SPOTS}
