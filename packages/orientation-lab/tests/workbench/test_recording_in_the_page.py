"""A recording that is dropped onto the workbench: what the cell shows, and
that the page hands over the file.
"""

import base64
import re

from simulated_recordings import as_text, simulate

from orientation_workbench.recording.page import judged


def test_what_is_dropped_is_judged_and_can_be_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert repr(judged()) == "no recording yet"
    (tmp_path / "dropped").mkdir()
    assert "no recording yet" in judged()._repr_html_()
    given = simulate(3)
    given["magnetometer"] = given["magnetometer"] + [20.0, -10, 15]
    (tmp_path / "dropped" / "walk <1>.csv").write_text(as_text(given, quaternion=True), "utf8")
    report = judged(convention="xyzw")
    shown = report._repr_html_()
    kept = base64.b64decode(
        re.search(r'download="report.html" href="data:text/html;base64,([^"]+)"', shown)[1]
    ).decode()
    assert "<title>walk &lt;1&gt;.csv on the bench</title>" in kept
    for page in (shown, kept):
        assert re.search(
            r'<tr class="wrong"><td>wrong</td><th scope="row">offset of the magnetometer', page
        )
        assert "<b>Wrong</b>: offset of the magnetometer." in page
        assert page.count("<svg") >= 3 and "<1>" not in page and "<script" not in page
    rows = re.search(r'download="corrected.csv" href="data:text/csv;base64,([^"]+)"', shown)[1]
    heading, *corrected = base64.b64decode(rows).decode().splitlines()
    assert heading.endswith("qx,qy,qz,qw") and len(corrected) == len(report.examined.time)
    # Of several files, the first need not be the recording.
    (tmp_path / "dropped" / "about.txt").write_text("Dear all,\nI am here.\nBye\n", "utf8")
    assert all("offset of the magnetometer" in repr(each) for each in (report, judged()))


def test_what_cannot_be_judged_says_why_with_line_and_column(tmp_path):
    (tmp_path / "letter.txt").write_text("Dear all,\nI am here.\nBye\n", "utf8")
    assert "letter.txt cannot be judged" in repr(judged(tmp_path)) and "Line 2" in repr(
        judged(tmp_path)
    )
    (tmp_path / "letter.txt").write_text(
        "\n".join(
            line if k % 9 else line.replace(",", ",x", 1)
            for k, line in enumerate(as_text(simulate(2, poses=2)).splitlines())
        ),
        "utf8",
    )
    assert "line 10, column 2" in judged(tmp_path)._repr_html_()
