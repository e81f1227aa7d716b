"""The site: `pip install ".[docs]"`, then `python -m sphinx -nW docs site` (warnings are errors).

Sphinx with MyST and Furo: all three have releases within the year, links between pages and to
headings are checked, and a page that no navigation names is an error. The result needs no network.
"""

project = "Plant growth clips"
copyright = "the authors, MIT licence"

extensions = ["myst_parser"]
myst_heading_anchors = 4
exclude_patterns = ["gallery", "examples"]

html_theme = "furo"
html_title = "Plant growth clips"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f8a4c", "color-brand-content": "#1f8a4c"},
    "dark_css_variables": {"color-brand-primary": "#7ecf98", "color-brand-content": "#7ecf98"},
}
