# Sphinx's settings for the manual, `make docs`; tools/docs/build.py writes the pages that it reads.
import os

project = "hifdm"
release = os.environ["HIFDM_VERSION"]
html_title = f"hifdm {release}"
html_theme = "furo"
extensions = ["myst_parser"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
# A page is opened from a disk as well as from a server: nothing is fetched from elsewhere, nor later on.
html_show_search_summary = False
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["style.css"]
html_last_updated_fmt = None
highlight_language = "none"
# What programs print and take is shown as it is: -- is no dash.
smartquotes = False
nitpicky = True
