"""Reference of the package of Python by Sphinx, from its docstrings (target docs_api)."""
import supple

project, release = "Supple", supple.__version__
extensions = ["sphinx.ext.autodoc"]
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
html_theme = "classic"
html_show_copyright = False
