"""Settings of the kernels that run the notebooks here.

`make` copies this file to a folder that replaces the user's own IPython settings.
"""

c = get_config()  # noqa: F821
c.IPKernelApp.log_level = "ERROR"
# Draw plots as SVG, identical from one run to the next.
c.InlineBackend.figure_formats = {"svg"}
c.InlineBackend.print_figure_kwargs = {"bbox_inches": "tight", "metadata": {"Date": None}}
c.InlineBackend.rc = {"svg.hashsalt": "orientation", "svg.fonttype": "path"}
