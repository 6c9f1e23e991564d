"""How Sphinx builds the site: Markdown pages by MyST, the theme Furo; nothing is loaded from a network."""

from station import __version__

project = "weldgate"
version = release = __version__
extensions = ["myst_parser"]
default_role = "code"
smartquotes = False
add_module_names = False
toc_object_entries = False
python_use_unqualified_type_names = True
suppress_warnings = ["config.cache", "ref.python"]  # a field named as a type is not an error
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
