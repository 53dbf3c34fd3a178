# Settings of Sphinx for the manual, `make docs`. tools/docs/build.py writes the pages that it reads.
import os

project = "hifdm"
release = os.environ["HIFDM_VERSION"]
html_title = f"hifdm {release}"
html_theme = "furo"
extensions = ["myst_parser"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
# A page may be opened from a disk or from a server, so nothing is fetched from elsewhere, neither at once nor later.
html_show_search_summary = False
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["style.css"]
html_last_updated_fmt = None
highlight_language = "none"
# The input and output of programs is shown as it is: -- is no dash.
smartquotes = False
nitpicky = True
