"""Attacks by names: classes in which some files' names might make them count as somebody else's.

Each is a submission as a system or an instructor would have it, with the owner of each file.
Nothing may ever be given to anybody else: either the files are distinguished, or a person is asked.
"""

import dataclasses
import io
import zipfile

#: A notebook without cells, whose owner cannot be known.
BLANK = b'{"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}'


@dataclasses.dataclass(frozen=True)
class Named:
    """A class in which somebody tries to be somebody else.

    Attributes
    ----------
    name : str
    handed_in : dict
        The owner of each file by its path, as the student is called here.
    asked : bool
        Whether nobody can know, so that a person must be asked about everything in ``handed_in``.
    roster : str
        The table of the people in the course, if there is one.
    also : dict
        Further files, with their contents, by path.
    """

    name: str
    handed_in: dict
    asked: bool = False
    roster: str = ""
    also: dict = dataclasses.field(default_factory=dict)


def packed(*names, data=b"{}"):
    """Return an archive as a student would pack it."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as box:
        for name in names:
            box.writestr(name, data)
    return file.getvalue()


JANE, BOB = "Jane Doe_101_assignsubmission_file_", "Bob_202_assignsubmission_file_"
OF_CANVAS = (
    'Student,ID,SIS User ID,SIS Login ID,Section,Turns (4711)\n"Doe, Jane",101,S1,jdoe,1,\n'
    '"Smith, Bob",202,S2,bsmith,1,\n'
)
GRADESCOPE = """
submission_41:
  :submitters:
  - :name: Bob
    :email: eve@uni.example
submission_42:
  :submitters:
  - :name: Bob
    :sid: '202'
    :email: bob@uni.example
"""
GIT = {f"hw-{user}/.git/HEAD": b"ref: refs/heads/main" for user in ("bob", "bobby", "carl")}

ATTACKS = [
    # ---- a name inside the student's own
    Named(
        "a folder called submitted inside the own one",
        {"jane/submitted/bob/turns.ipynb": "jane", "bob/turns.ipynb": "bob"},
    ),
    Named(
        "a classmate's folder inside the own one",
        {"jane/bob/turns.ipynb": "jane", "bob/turns.ipynb": "bob"},
    ),
    Named(
        "Moodle's marks in the name of a file",
        {f"{JANE}{BOB}turns.ipynb": "Jane Doe 101", f"{BOB}turns.ipynb": "Bob 202"},
    ),
    Named(
        "Moodle's marks in a file of the own folder",
        {f"jane/{BOB}turns.ipynb": "jane", "bob/turns.ipynb": "bob"},
    ),
    Named(
        "Canvas's marks in a file of the own folder",
        {"jane/bob_202_502_turns.ipynb": "jane", "bob/turns.ipynb": "bob"},
    ),
    Named(
        "Moodle's folder inside the own one",
        {f"{JANE}/{BOB}/turns.ipynb": "Jane Doe 101", f"{BOB}/turns.ipynb": "Bob 202"},
    ),
    Named(
        "Moodle's folder inside the only one that was handed in",
        {f"{JANE}/{BOB}/turns.ipynb": "Jane Doe 101"},
    ),
    Named(
        "the same, with a roster that knows both",
        {f"{JANE}/{BOB}/turns.ipynb": "Jane Doe"},
        roster="Identifier,Full name,Grade\nParticipant 101,Jane Doe,\nParticipant 202,Bob,\n",
    ),
    Named(
        "Canvas's marks in the name of a file",
        {
            "doejane_101_501_bob_202_502_turns.ipynb": "doejane_101",
            "bob_202_502_turns.ipynb": "bob_202",
        },
    ),
    Named(
        "Canvas's marks in a folder of Brightspace that came alone",
        {"101-9 - Jane Doe - Nov 21, 2026 801 PM/bob_202_502_turns.ipynb": "Jane Doe 101"},
    ),
    Named(
        "Brightspace's folder inside the own one",
        {
            "101-9 - Jane Doe - Nov 21, 2026 801 PM/202-9 - Bob - Nov 21, 2026 802 "
            "PM/turns.ipynb": "Jane Doe 101",
            "202-9 - Bob - Nov 21, 2026 802 PM/turns.ipynb": "Bob 202",
        },
    ),
    Named(
        "Brightspace's folder inside the only one that was handed in",
        {
            "101-9 - Jane Doe - Nov 21, 2026 801 PM/202-9 - Bob - Nov 21, 2026 802 "
            "PM/turns.ipynb": "Jane Doe 101"
        },
    ),
    Named(
        "Blackboard's marks in the name of a file",
        {
            "HW 1_jane_attempt_2026-11-21-20-01-00_x_"
            "bob_attempt_2026-11-21-20-02-00_turns.ipynb": "jane",
            "HW 1_bob_attempt_2026-11-21-20-02-00_turns.ipynb": "bob",
        },
    ),
    Named(
        "a table like Gradescope's in the own folder",
        {"all/submission_41/turns.ipynb": "eve", "all/submission_42/turns.ipynb": "bob"},
        roster="student,name,email\neve,Eve,eve@uni.example\nbob,Bob,bob@uni.example\n",
        also={
            "all/submission_metadata.yml": GRADESCOPE.replace("'202'", "bob").encode(),
            "all/submission_41/submission_metadata.yml": GRADESCOPE.replace(
                "eve@", "bob@"
            ).encode(),
        },
    ),
    Named(
        "an archive within with a classmate's folder in it",
        {
            "jane_101_501_work.zip/bob_202_502_turns.ipynb": "jane_101",
            "bob_202_503_turns.ipynb": "bob_202",
        },
    ),
    Named(
        "an archive within that leads out of itself",
        {
            "jane_101_501_work.zip/../bob_202_503_turns.ipynb": "jane_101",
            "bob_202_503_turns.ipynb": "bob_202",
        },
    ),
    Named(
        "an archive within an archive within",
        {"bob_202_503_turns.ipynb": "bob_202"},
        also={"jane_101_501_work.zip": packed("bob_202_502_turns.zip", data=packed("turns.ipynb"))},
    ),
    Named(
        "a repository of Git inside the own folder",
        {f"s-{number}/turns.ipynb": f"s-{number}" for number in (101, 102, 103)},
        also={"s-101/.git/HEAD": b"ref: refs/heads/main"},
    ),
    # ---- a name that is another's, or looks like it
    Named(
        "two folders for one number of Moodle",
        {f"{BOB}/a.ipynb": "", "Bobby_202_assignsubmission_file_/a.ipynb": ""},
        True,
    ),
    Named(
        "two names for one number of Canvas",
        {"bob_202_502_turns.ipynb": "", "bobby_202_503_turns.ipynb": ""},
        True,
    ),
    Named(
        "one number of Moodle, and a zero-width space",
        {"Bo\u200bb_202_assignsubmission_file_/a.ipynb": "", f"{BOB}/a.ipynb": ""},
        True,
    ),
    Named("capitals", {"Bob/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named(
        "a letter that is two small ones",
        {"Strasse/turns.ipynb": "", "Stra\xdfe/turns.ipynb": ""},
        True,
    ),
    Named(
        "another form of one letter",
        {"jose\u0301/turns.ipynb": "", "jos\xe9/turns.ipynb": ""},
        True,
    ),
    Named("wide letters", {"\uff42ob/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("mathematical letters", {"\U0001d41bob/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a Cyrillic letter", {"b\u043eb/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a Greek letter", {"b\u03bfb/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a zero-width space", {"bo\u200bb/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a joiner of letters", {"bo\u034fb/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a variation selector", {"bob\ufe0f/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("an empty letter", {"bob\u3164/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("text that runs backwards", {"\u202ebob/turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a blank at the end", {"bob /turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a dot at the end", {"bob./turns.ipynb": "", "bob/turns.ipynb": ""}, True),
    Named("a hard blank", {"bob smith/turns.ipynb": "", "bob\xa0smith/turns.ipynb": ""}, True),
    Named(
        "a second way to write the name of a file",
        {"turns_bob.ipynb": "", "bob-turns.ipynb": ""},
        True,
    ),
    # ---- classes with a roster
    Named(
        "a look-alike of a name in the roster",
        {"b\u043eb/turns.ipynb": "", "b\u200bo\u200bb\u0131/turns.ipynb": ""},
        True,
        roster="student\nbob\neve\n",
    ),
    Named(
        "a number that nobody has, with a classmate's name",
        {"smithbob_999_5_turns.ipynb": ""},
        True,
        roster=OF_CANVAS,
    ),
    Named(
        "a name that ends in a classmate's number",
        {"bob_202_101_5_turns.ipynb": "jane", "smithbob_202_7_01_turns.ipynb": "bob"},
        roster='Student,ID,SIS User ID,SIS Login ID,Section,T\n"bob_202",101,,jane,1,\n'
        '"Smith, Bob",202,,bob,1,\n"Doe, Eve",303,,eve,1,\n',
        also={"eve_doe_202_303_6_turns.ipynb": BLANK},
    ),
    Named(
        "two equal names in the roster",
        {"Bob Smith/turns.ipynb": ""},
        True,
        roster="student,name\nbob1,Bob Smith\nbob2,Bob Smith\n",
    ),
    Named(
        "a name on GitHub that is a classmate's login",
        {"hw-bob/turns.ipynb": "", "hw-bobby/turns.ipynb": "", "hw-carl/turns.ipynb": ""},
        True,
        roster="student,name\nbob,Bob\neve,Eve\ncarl,Carl\n",
        also=GIT,
    ),
    Named(
        "the same, where the roster knows the names on GitHub",
        {"hw-bob/turns.ipynb": "eve", "hw-bobby/turns.ipynb": "bob", "hw-carl/turns.ipynb": "carl"},
        roster="student,github\nbob,bobby\neve,bob\ncarl,carl\n",
        also=GIT,
    ),
    Named(
        "a name in Gradescope that is a classmate's",
        {"all/submission_41/turns.ipynb": "eve", "all/submission_42/turns.ipynb": "bob"},
        roster="student,name,email\neve,Eve,eve@uni.example\nbob,Bob,bob@uni.example\n",
        also={"all/submission_metadata.yml": GRADESCOPE.replace("'202'", "bob").encode()},
    ),
    Named(
        "a name in Gradescope that is a classmate's, by an address that nobody has",
        {"all/submission_41/turns.ipynb": ""},
        True,
        roster="student,name,email\n101,Eve,eve@other.example\n202,Bob,bob@uni.example\n",
        also={"all/submission_metadata.yml": GRADESCOPE.encode()},
    ),
    Named(
        "an address elsewhere that begins like a classmate's",
        {"bob/turns.ipynb": "bob@uni.example"},
        roster="name,email\nEve,bob@mail.example\nBob,bob@uni.example\nCarl,carl@uni.example\n",
    ),
    Named(
        "an address elsewhere that begins like what a classmate is called",
        {"robert/turns.ipynb": ""},
        True,
        roster="name,email\nEve,robert@mail.example\nBob,bob@uni.example\nCarl,carl@uni.example\n",
    ),
    Named(
        "a login that begins as all do",
        {
            "HW_x_a_attempt_2026-11-21-20-01-00_t.ipynb": "",
            "HW_x_b_attempt_2026-11-21-20-01-00_t.ipynb": "",
        },
        True,
        roster="student\nx_a\nx_b\na\nb\n",
    ),
    Named(
        "a login that ends as another does",
        {
            "HW_jane_doe_attempt_2026-11-21-20-01-00_t.ipynb": "jane_doe",
            "HW_ann_attempt_2026-11-21-20-01-00_t.ipynb": "ann",
        },
        roster="student\njane_doe\nann\n",
    ),
    Named(
        "two folders that the roster knows as one",
        {"jdoe/turns.ipynb": "", "Jane Doe/turns.ipynb": ""},
        True,
        roster="student,name\njdoe,Jane Doe\nbob,Bob\n",
    ),
    Named(
        "a file's name that is the roster's word for another",
        {"doejane_101_5_that one.ipynb": "jdoe", "smithbob_202_6_turns.ipynb": "bsmith"},
        roster=OF_CANVAS.replace("Section", "handed in as").replace("bsmith,1", "bsmith,that one"),
    ),
]
