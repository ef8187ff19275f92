"""Settings of the documentation site: `make docs` builds it into docs/_build/html."""

import os
import re
import tomllib
from pathlib import Path

from docutils import nodes
from sphinx import addnodes

# Gallery scripts and their children solve on one thread: the page builds alike on busy machines.
os.environ.setdefault("DUCC0_NUM_THREADS", "1")

ROOT = Path(__file__).parents[1]
METADATA = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = METADATA["name"]
version = release = METADATA["version"]
author = "the restitution contributors"
copyright = author  # Sphinx calls it that

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "sphinx-mathjax-offline",  # formulas show without internet
]
exclude_patterns = ["_build", "gallery"]

myst_enable_extensions = ["amsmath", "attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# Docstrings write code in single backticks.
default_role = "literal"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {name: name for name in ("Array", "ArrayLike", "Values")}
autodoc_member_order = "bysource"
python_use_unqualified_type_names = True
napoleon_custom_sections = ["Source"]
napoleon_use_ivar = True
napoleon_attr_annotations = False
# Public names must resolve. Internal modules have no page here, and pages of NumPy and Python are
# not looked up, so that the site builds without internet.
nitpick_ignore_regex = [("py:.*", r"(?!restitution\.(theory\.)?\w+$).*")]

html_theme = "furo"
html_title = f"{project} {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {"navigation_with_keys": True, "top_of_page_buttons": []}
html_copy_source = False
html_show_sphinx = False
pygments_style = "friendly"
pygments_dark_style = "monokai"
copybutton_exclude = ".linenos, .gp, .go"

# `make docs-links` asks every address. Publishers answer 403 to programs.
linkcheck_timeout = 20
linkcheck_ignore = [r"https://doi\.org/.*"]

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "write_computation_times": False,
    "image_scrapers": ("matplotlib",),
    "image_srcset": ["2x"],
    "remove_config_comments": True,
    "show_signature": False,
    "copyfile_regex": "",
}


# What autodoc writes for types and defaults, and what the reader sees instead.
SHORTER = {
    r"(~numpy\.)?ndarray\[tuple\[(~typing\.)?Any, \.\.\.\], "
    r"(~numpy\.)?dtype\[(~numpy\.)?(?P<kind>\w+)\]\]": r"NDArray[\g<kind>]",
    r"TypeAliasForwardRef\('(\w+)'\)": r"\1",
    r"<factory>": "{}",  # of the only dataclass whose default is made for each object
}


def _escape_docstring(app, what, name, value, options, lines):  # the signature is Sphinx'
    """Let |z| be an absolute value and "K. L. Johnson" a name, not a substitution and a list."""
    for i, line in enumerate(lines):
        bars = re.sub(r"(`[^`]*`)|\|", lambda match: match[1] or r"\|", line)
        lines[i] = re.sub(r"^( *[A-Z])\. ", r"\1\. ", bars)


def _shorten(text):
    """Apply `SHORTER` to the text of a signature."""
    for long, short in SHORTER.items():
        text = re.sub(long, short, text)
    return text


def _shorten_signature(app, what, name, value, options, arguments, result):
    """Show readable types in signatures, and no arguments of a protocol."""
    if what == "class" and arguments == "(*args, **kwargs)":
        return "", ""
    return None if arguments is None else (_shorten(arguments), _shorten(result or ""))


def _shorten_properties(app, doctree, page):
    """Show readable types of properties, which are not in their signatures."""
    for annotation in doctree.findall(addnodes.desc_annotation):
        if (text := annotation.astext()) != (shorter := _shorten(text)):
            annotation[:] = [nodes.Text(shorter)]


def setup(app):
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", _escape_docstring)
    app.connect("autodoc-process-signature", _shorten_signature)
    app.connect("doctree-resolved", _shorten_properties)
