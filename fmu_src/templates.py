"""HTML pages from jinja templates."""

from pathlib import Path

import jinja2


def template(path: Path, *shared: Path) -> jinja2.Template:
    """A template; what it prints is escaped, an unknown name is an error.

    shared : folders of templates that it extends or imports, beside its own
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([path.parent, *shared]),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template(path.name)
