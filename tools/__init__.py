"""Tools of the authors: begin or check a chapter, begin a question, compare with other machines."""
