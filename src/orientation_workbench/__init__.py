"""A bench for what others have measured or computed: in which conventions it is, and how wrong."""
