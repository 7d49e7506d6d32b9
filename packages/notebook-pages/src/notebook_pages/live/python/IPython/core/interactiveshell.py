"""Here because ipywidgets imports the name; the page's own shell is ``session.Shell``."""


class InteractiveShell:
    @staticmethod
    def initialized():
        return False
