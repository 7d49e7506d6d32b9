"""Compare the outputs that a notebook stores with those of another run."""

import nbval.plugin

from notebook_pages.moves import moves

compare_strictly = nbval.plugin.IPyNbCell.compare_outputs
format_difference = nbval.plugin.IPyNbCell.format_output_compare


def compare_outputs(cell, test, ref, skip_compare=None):
    """Compare outputs as nbval does, except for numbers that changed by a small amount.

    `notebook_pages.moves` gives the limit.
    """
    for now, stored in zip(test, ref):
        _undo_small_moves(now.get("data", {}), stored.get("data", {}), cell.sanitize)
        _undo_small_moves(now, stored, cell.sanitize)
    return compare_strictly(cell, test, ref, skip_compare)


def _undo_small_moves(now, stored, sanitize):
    for kind in now.keys() & stored.keys():
        if isinstance(now[kind], str) and isinstance(stored[kind], str):
            if not any(move.too_far for move in moves(sanitize(stored[kind]), sanitize(now[kind]))):
                now[kind] = stored[kind]


def format_output_compare(cell, key, left, right):
    format_difference(cell, key, left, right)
    cell.comparison_traceback += [f"\n  {move}" for move in moves(left, right) if move.too_far][:5]
