"""Scratch folders on disk, measured and emptied, where a notebook cannot have one in memory.

What a student leaves behind may be hostile: folders nested a hundred thousand deep, without
permissions, or links elsewhere. Nothing here follows a link or recurses.

As a program, given a folder and a command, this starts the command, waits for its end and removes
the folder, since the caller may be killed meanwhile and the command may not see the folder.
"""

import contextlib
import os
import secrets
import sys

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


def remove_folder(path: str) -> None:
    """Remove a folder and everything in it."""
    top = os.open(path, _FOLDER)
    try:
        while names := os.listdir(top):
            for name in names:
                if _unlinked(name, top):
                    continue
                # For a folder, delete its files, move its folders up here, and remove it.
                inner = _opened(name, top)
                try:
                    for child in os.listdir(inner):
                        if not _unlinked(child, inner):
                            os.chmod(child, 0o700, dir_fd=inner)
                            os.rename(
                                child, secrets.token_hex(16), src_dir_fd=inner, dst_dir_fd=top
                            )
                finally:
                    os.close(inner)
                os.rmdir(name, dir_fd=top)
    finally:
        os.close(top)
    os.rmdir(path)


def _opened(name: str, folder: int) -> int:
    os.chmod(name, 0o700, dir_fd=folder)
    return os.open(name, _FOLDER, dir_fd=folder)


def _unlinked(name: str, folder: int) -> bool:
    try:
        os.unlink(name, dir_fd=folder)
    except IsADirectoryError:
        return False
    return True


def used_bytes(path: str, most: int) -> int:
    """Return the bytes that the files under `path` take; stop counting above `most`."""
    total, folders = 0, [path]
    while folders and total <= most:
        with contextlib.suppress(OSError), os.scandir(folders.pop()) as entries:
            for entry in entries:
                # An empty file takes space, too.
                total += 512
                with contextlib.suppress(OSError):
                    total += entry.stat(follow_symlinks=False).st_blocks * 512
                    if entry.is_dir(follow_symlinks=False):
                        folders.append(entry.path)
                if total > most:
                    break
    return total


def main(folder: str, *command: str) -> int:
    """Run a command, remove a folder when it has ended, and return its exit code."""
    child = os.fork()
    if child == 0:
        os.execv(command[0], command)
    # The handles belong to the command. If this process held them, others would not see its end.
    os.closerange(3, 1 << 16)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    with contextlib.suppress(OSError):
        remove_folder(folder)
    return status if status >= 0 else 128 - status


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
