"""The stills of the moving figures, one module for each kind: what is drawn with NumPy and Matplotlib."""
