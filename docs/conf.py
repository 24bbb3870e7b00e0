"""The documentation site: Markdown pages read by MyST, built by `make site` with every warning an error."""

project = "swarm"
author = "The swarm runtime's contributors"

extensions = ["myst_parser"]
myst_heading_anchors = 3  # links to headings down to ### are checked too

html_theme = "furo"
html_title = "swarm"
html_show_copyright = False
