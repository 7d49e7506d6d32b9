"""The system calls that student code may make: a seccomp filter, written for x86-64 and ARM64.

The filter refuses what is not on the list. The list has what computing needs: memory, threads, time
and files (which files is decided elsewhere). It has no socket, new process, other program, other
process's memory or signals, namespace, change of modes, owners or limits, and no memory outside the
process (shared segments, anonymous files). The resource limits of one process are thus the limits
of the notebook.

The filter sees numbers, not names, so it cannot tell one file from another.
"""

import ctypes
import errno
import os
import platform
import struct
from collections.abc import Sequence

# name: (number on x86-64, number on ARM64)
ALLOWED = {
    # files
    "read": (0, 63),
    "write": (1, 64),
    "readv": (19, 65),
    "writev": (20, 66),
    "pread64": (17, 67),
    "pwrite64": (18, 68),
    "lseek": (8, 62),
    "close": (3, 57),
    "close_range": (436, 436),
    "dup": (32, 23),
    "dup2": (33, None),
    "dup3": (292, 24),
    "pipe": (22, None),
    "pipe2": (293, 59),
    "poll": (7, None),
    "ppoll": (271, 73),
    "select": (23, None),
    "pselect6": (270, 72),
    "epoll_create1": (291, 20),
    "epoll_ctl": (233, 21),
    "epoll_wait": (232, None),
    "epoll_pwait": (281, 22),
    "open": (2, None),
    "openat": (257, 56),
    "stat": (4, None),
    "lstat": (6, None),
    "fstat": (5, 80),
    "newfstatat": (262, 79),
    "statx": (332, 291),
    "access": (21, None),
    "faccessat": (269, 48),
    "faccessat2": (439, 439),
    "readlink": (89, None),
    "readlinkat": (267, 78),
    "getdents64": (217, 61),
    "getcwd": (79, 17),
    "chdir": (80, 49),
    "fchdir": (81, 50),
    "mkdir": (83, None),
    "mkdirat": (258, 34),
    "rmdir": (84, None),
    "unlink": (87, None),
    "unlinkat": (263, 35),
    "rename": (82, None),
    "renameat": (264, 38),
    "renameat2": (316, 276),
    "link": (86, None),
    "linkat": (265, 37),
    "symlink": (88, None),
    "symlinkat": (266, 36),
    "ftruncate": (77, 46),
    "fallocate": (285, 47),
    "fsync": (74, 82),
    "fdatasync": (75, 83),
    "statfs": (137, 43),
    "fstatfs": (138, 44),
    "umask": (95, 166),
    "fadvise64": (221, 223),
    "sendfile": (40, 71),
    "copy_file_range": (326, 285),
    # memory
    "mmap": (9, 222),
    "mprotect": (10, 226),
    "munmap": (11, 215),
    "mremap": (25, 216),
    "madvise": (28, 233),
    "brk": (12, 214),
    "msync": (26, 227),
    "mincore": (27, 232),
    # Its own signals, time and threads
    "rt_sigaction": (13, 134),
    "rt_sigprocmask": (14, 135),
    "rt_sigreturn": (15, 139),
    "rt_sigtimedwait": (128, 137),
    "rt_sigsuspend": (130, 133),
    "rt_sigpending": (127, 136),
    "sigaltstack": (131, 132),
    "pause": (34, None),
    "alarm": (37, None),
    "setitimer": (38, 103),
    "getitimer": (36, 102),
    "nanosleep": (35, 101),
    "clock_nanosleep": (230, 115),
    "clock_gettime": (228, 113),
    "clock_getres": (229, 114),
    "gettimeofday": (96, 169),
    "time": (201, None),
    "restart_syscall": (219, 128),
    "futex": (202, 98),
    "set_robust_list": (273, 99),
    "rseq": (334, 293),
    "set_tid_address": (218, 96),
    "membarrier": (324, 283),
    "sched_yield": (24, 124),
    "sched_getaffinity": (204, 123),
    "getcpu": (309, 168),
    "wait4": (61, 260),
    "waitid": (247, 95),
    "exit": (60, 93),
    "exit_group": (231, 94),
    # Its own identity and surroundings
    "getpid": (39, 172),
    "gettid": (186, 178),
    "getppid": (110, 173),
    "getuid": (102, 174),
    "geteuid": (107, 175),
    "getgid": (104, 176),
    "getegid": (108, 177),
    "getgroups": (115, 158),
    "getresuid": (118, 148),
    "getresgid": (120, 150),
    "getpgrp": (111, None),
    "getpgid": (121, 155),
    "getsid": (124, 156),
    "uname": (63, 160),
    "sysinfo": (99, 179),
    "times": (100, 153),
    "getrusage": (98, 165),
    "getrlimit": (97, 163),
    "getrandom": (318, 278),
    "getpriority": (140, 141),
}
# Calls allowed for some values of one argument: name: (numbers, which argument, values).
ALLOWED_FOR = {
    # Duplicate, close-on-exec and status flags, but no locks on shared files or signals by F_SETOWN
    "fcntl": ((72, 25), 1, (0, 1, 2, 3, 4, 1030, 1032)),
    # Whether it is a terminal, how many bytes wait, close-on-exec, non-blocking
    "ioctl": ((16, 29), 1, (0x5401, 0x802C542A, 0x5413, 0x541B, 0x5421, 0x5450, 0x5451)),
    # Names of threads and of memory areas
    "prctl": ((157, 167), 0, (3, 15, 16, 23, 0x53564D41)),
}
# The first argument must be the process's own ID.
ONLY_ITSELF = {"kill": (62, 129), "tgkill": (234, 131)}
CLONE, PRLIMIT, SECCOMP = (56, 220), (302, 261), (317, 277)
# The second contains every kind of new namespace.
CLONE_THREAD, CLONE_NEW = 0x00010000, 0x7E020080
# From this number on, all processors share the numbers, and C libraries work without the calls.
FIRST_NEW = 424

LOAD, JUMP_EQUAL, JUMP_AT_LEAST, JUMP_ANY_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
ALLOW, REFUSE, UNKNOWN = 0x7FFF0000, 0x00050000 | errno.EPERM, 0x00050000 | errno.ENOSYS
KILL = 0x80000000
NUMBER, ARCHITECTURE, ARGUMENTS = 0, 4, 16
# ~machine: (the kernel's name for it, the column of the tables above)
MACHINES = {"x86_64": (0xC000003E, 0), "aarch64": (0xC00000B7, 1)}


class FilterProgram(ctypes.Structure):
    _fields_ = [("length", ctypes.c_ushort), ("filter", ctypes.c_void_p)]


def program(own_number: int, machine: str | None = None) -> bytes:
    """Return the filter for the process `own_number`, 8 bytes for each instruction."""
    machine = machine or platform.machine()
    if machine not in MACHINES:
        raise OSError(errno.ENOSYS, f"there is no system-call filter for {machine}")
    architecture, column = MACHINES[machine]
    code: list[bytes] = []

    def add(operation: int, value: int, if_true: int = 0, if_false: int = 0) -> None:
        code.append(struct.pack("=HBBI", operation, if_true, if_false, value))

    def for_call(number: int | None, steps: Sequence[tuple[int, ...]]) -> None:
        if number is not None:
            add(JUMP_EQUAL, number, 0, len(steps))
            for step in steps:
                add(*step)

    def load(argument: int, high: bool = False) -> tuple[int, ...]:
        return (LOAD, ARGUMENTS + 8 * argument + 4 * high)

    add(LOAD, ARCHITECTURE)
    add(JUMP_EQUAL, architecture, 1, 0)
    add(RETURN, KILL)
    add(LOAD, NUMBER)
    for numbers in ALLOWED.values():
        for_call(numbers[column], [(RETURN, ALLOW)])
    for numbers, argument, values in ALLOWED_FOR.values():
        steps = [load(argument)]
        for value in values:
            steps += [(JUMP_EQUAL, value, 0, 1), (RETURN, ALLOW)]
        for_call(numbers[column], [*steps, (RETURN, REFUSE)])
    for numbers in ONLY_ITSELF.values():
        for_call(
            numbers[column],
            [load(0), (JUMP_EQUAL, own_number, 0, 1), (RETURN, ALLOW), (RETURN, REFUSE)],
        )
    # Allow a thread, but no process or new namespace.
    for_call(
        CLONE[column],
        [
            load(0),
            (JUMP_ANY_BIT, CLONE_NEW, 2, 0),
            (JUMP_ANY_BIT, CLONE_THREAD, 0, 1),
            (RETURN, ALLOW),
            (RETURN, REFUSE),
        ],
    )
    # Its own limits may be read but not changed, so the third argument (the new limits) must be
    # null.
    for_call(
        PRLIMIT[column],
        [
            load(2),
            (JUMP_EQUAL, 0, 0, 5),
            load(2, high=True),
            (JUMP_EQUAL, 0, 0, 3),
            load(0),
            (JUMP_EQUAL, 0, 0, 1),
            (RETURN, ALLOW),
            (RETURN, REFUSE),
        ],
    )
    # 0x40000000 marks the x32 calls of x86-64, which are refused like everything not named above.
    add(JUMP_AT_LEAST, FIRST_NEW, 0, 2)
    add(JUMP_AT_LEAST, 0x40000000, 1, 0)
    add(RETURN, UNKNOWN)
    add(RETURN, REFUSE)
    return b"".join(code)


def install() -> None:
    """Put the filter on this process for good. `no_new_privs` must be set."""
    library = ctypes.CDLL(None, use_errno=True)
    code = program(os.getpid())
    buffer = ctypes.create_string_buffer(code, len(code))
    description = FilterProgram(len(code) // 8, ctypes.addressof(buffer))
    number = SECCOMP[MACHINES[platform.machine()][1]]
    # Mode 1 is a filter. Flag 4 avoids a slower processor mode for code that shares its process
    # with secrets, of which this one has none.
    if library.syscall(number, 1, 4, ctypes.byref(description)) != 0:
        error = ctypes.get_errno()
        raise OSError(error, f"seccomp: {os.strerror(error)}")
