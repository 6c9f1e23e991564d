"""How Sphinx builds the site: Markdown pages by MyST, the theme Furo; nothing is loaded from a network."""

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx

from deploy.docs.rooms import PACKAGES
from station import __version__

project = "weldgate"
version = release = __version__
extensions = ["myst_parser"]
default_role = "code"
smartquotes = False
add_module_names = False
toc_object_entries = False
python_use_unqualified_type_names = True
suppress_warnings = ["config.cache"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
html_theme = "furo"
html_title = f"weldgate {__version__}"
html_static_path = ["style"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1d5f93", "color-brand-content": "#1d5f93"},
    "dark_css_variables": {"color-brand-primary": "#7db9e8", "color-brand-content": "#7db9e8"},
}
pygments_style = "friendly"
pygments_dark_style = "monokai"


def setup(app: Sphinx) -> None:
    """Take part in the build."""
    app.connect("doctree-read", _without_foreign_types)


def _without_foreign_types(_app: Sphinx, doctree: nodes.document) -> None:
    """Make names of types that are not ours plain text: looking for them takes a third of the time."""
    for node in list(doctree.findall(pending_xref)):
        if node.get("refdomain") != "py" or node.get("reftype") not in ("class", "obj"):
            continue
        if node["reftarget"].split(".")[0] in PACKAGES:
            del node["refspecific"]
        else:
            node.parent.replace(node, nodes.Text(node["reftarget"].split(".")[-1]))
