"""The page to mark in: safe against other pages and its own content, and usable by keys alone."""

import asyncio
import base64
import functools
import http.client
import io
import re
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path
from urllib.parse import quote

import nbformat
import psutil
import pytest
from grading_class import (
    RIGHT,
    SETUP,
    give,
    grade_quietly,
    handed_in,
    notebook,
    put,
    write_sources,
)
from tornado import httpserver, netutil
from trial_course import PROJECT

from coursework.__main__ import main
from coursework.grading.grade import regrade
from coursework.grading.judging.journal import Journal
from coursework.grading.record import Record
from coursework.grading.review import POLICY, Class, application
from coursework.grading.store import Store

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

SCRIPT = "<script>alert(1)</script><img src=x onerror=alert(2)>"
UNUSUAL = "sine = sm.sin(alpha)*sm.cos(beta)**7 + sm.Rational(3, 17)*sm.cos(alpha - 2*beta)"


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """The results of a small class, graded once."""
    place = tmp_path_factory.mktemp("review")
    solutions, submissions = write_sources(place / "solutions"), place / "submissions"
    for number in range(6):
        put(
            submissions,
            f"rounded-{number}",
            handed_in(sum=f"sine = sm.sin(alpha + beta)*1.000{number + 1}"),
        )
    for student in ("copies", "was-copied"):
        put(submissions, student, handed_in(sum=UNUSUAL))
    put(
        submissions,
        "pokes",
        handed_in(sum="try:\n    open('/etc/passwd')\nexcept OSError:\n    pass\nsine = 0"),
    )
    put(submissions, "hostile", handed_in(sum=f"# {SCRIPT}\nsine = sm.Symbol({SCRIPT!r})"))
    put(submissions, "right", handed_in())
    put(submissions, "blank", notebook([SETUP["turns"], RIGHT["turns/sum"]]))
    grade_quietly(submissions, place / "out", solutions)
    return place


@pytest.fixture
def out(graded, tmp_path):
    return shutil.copytree(graded / "out", tmp_path / "out")


class Served:
    """The page, served from a thread, with requests to it."""

    def __init__(self, folder, **options):
        self.ready = threading.Event()
        serving = functools.partial(self.serve, folder, **options)
        self.thread = threading.Thread(target=lambda: asyncio.run(serving()))

    async def serve(self, folder, grader="Ann", **options):
        sockets = netutil.bind_sockets(0, "127.0.0.1")
        self.port = sockets[0].getsockname()[1]
        made = application(Class(folder), grader, self.port, **options)
        self.secret = made.settings["secret"]
        server = httpserver.HTTPServer(made)
        server.add_sockets(sockets)
        self.loop, self.over = asyncio.get_running_loop(), asyncio.Event()
        self.ready.set()
        await self.over.wait()
        server.stop()
        await server.close_all_connections()

    def __enter__(self):
        self.thread.start()
        assert self.ready.wait(60)
        return self

    def __exit__(self, *error):
        self.loop.call_soon_threadsafe(self.over.set)
        self.thread.join()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}/{self.secret}/"

    def ask(self, path, method="GET", body=None, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        headers = {
            "Host": f"127.0.0.1:{self.port}",
            **{name.replace("_", "-"): value for name, value in headers.items()},
        }
        connection.request(method, path, body, headers)
        response = connection.getresponse()
        text = response.read().decode()
        connection.close()
        return response, text

    def decide(self, cluster, body="credit=1", seen=None, **headers):
        """Decide on what the page shows now, or showed when it was ``seen``."""
        body += f"&seen={quote(self.seen(cluster) if seen is None else seen)}"
        headers = {
            "Origin": f"http://127.0.0.1:{self.port}",
            "Content_Type": "application/x-www-form-urlencoded",
            **headers,
        }
        return self.ask(f"/{self.secret}/answer/{cluster}", "POST", body, **headers)[0]

    def seen(self, cluster):
        return re.search(
            r'name="seen" value="([^"]*)"', self.ask(f"/{self.secret}/answer/{cluster}")[1]
        )[1]


def first_of(served, show="waiting"):
    _, text = served.ask(f"/{served.secret}/?show={show}")
    return re.findall(r"answer/([0-9a-f]{16})", text)[0]


def test_only_this_machine_this_name_and_this_page_are_heard(out):
    with Served(out) as served:
        assert served.ask(f"/{served.secret}/")[0].status == 200
        assert served.ask("/wrong/")[0].status == 404 and served.ask("/")[0].status == 404
        # Somebody else's host name leads to this machine.
        assert served.ask(f"/{served.secret}/", Host="evil.example")[0].status == 403
        assert served.ask(f"/{served.secret}/", Host=f"evil.example:{served.port}")[0].status == 403
        cluster = first_of(served)
        for headers in (
            {"Origin": "http://evil.example"},
            {"Origin": "null"},
            {"Origin": f"http://127.0.0.1:{served.port + 1}"},
            {"Sec_Fetch_Site": "cross-site"},
            {"Sec_Fetch_Site": "same-site"},
        ):
            assert served.decide(cluster, **headers).status == 403
        body = served.ask(f"/{served.secret}/answer/{cluster}", "POST", "credit=1")[0]
        assert body.status == 403  # There is no origin.
        assert Journal(out).by_people == []
        assert served.decide(cluster).status == 303 and len(Journal(out).by_people) == 1


def test_what_a_student_wrote_is_shown_and_never_obeyed(out):
    with Served(out) as served:
        response, _ = served.ask(f"/{served.secret}/")
        policy = response.getheader("Content-Security-Policy")
        assert policy == POLICY and "unsafe" not in policy and "script-src 'self'" in policy
        assert response.getheader("Referrer-Policy") == "same-origin"
        _, text = served.ask(f"/{served.secret}/?show=invalid&search=script")
        (cluster,) = set(re.findall(r"answer/([0-9a-f]{16})", text))
        _, page = served.ask(f"/{served.secret}/answer/{cluster}")
        assert "&lt;script&gt;alert(1)" in page
        for shown in (text, page):
            assert (
                "<script>alert" not in shown
                and "<img" not in shown
                and "onerror=alert(2)>" not in shown
            )
            assert len(re.findall("<script", shown)) == 1
        _, text = served.ask(f"/{served.secret}/?search=%22%3E%3Cscript%3Ealert(1)")
        assert "<script>alert" not in text


def test_a_cluster_or_one_of_it_is_decided_and_regrading_keeps_it(graded, out):
    with Served(out, grader="Ann") as served:
        served_class = Class(out)
        (cluster,) = [
            candidate
            for candidate in served_class.clusters.values()
            if len(candidate.members) == 2 and candidate.mark.outcome == "wrong"
        ]
        assert (
            served.decide(
                cluster.id, "credit=&given=0%2C5&comment=Half+of+it.&rubric=Copied%3F&why=appeal"
            ).status
            == 303
        )
        place = [record.student for record in cluster.members].index("copies")
        assert served.decide(cluster.id, f"credit=1&only={place}").status == 303
        for body, status in (
            ("credit=9", 409),
            ("credit=-1", 409),
            ("credit=x", 409),
            ("credit=&given=nan", 409),
            ("credit=&given=", 409),
            ("", 400),
            ("credit=1&only=9", 400),
        ):
            assert served.decide(cluster.id, body).status == status
        _, page = served.ask(f"/{served.secret}/answer/{cluster.id}")
        # Enter in a field presses the first button, which gives no points.
        assert (
            re.search(r'decide">\s*<button[^>]* hidden>', page)
            and "by Ann" in page
            and "Copied?" in page
            and "appeal" in page
        )
    moved = {
        move.student: move.after for move in regrade(out, solutions=graded / "solutions").moves
    }
    assert moved == {"copies": 6, "was-copied": 5.5}
    mark = Store(out).read("was-copied", "turns").marks["turns/sum"]
    assert mark.messages == ("Copied?", "Half of it.") and mark.before.outcome == "wrong"
    assert regrade(out, solutions=graded / "solutions").moves == []
    page = (out / "feedback" / "was-copied" / "turns.html").read_text()
    assert (
        "Decided by a person" in page
        and "Half of it." in page
        and "appeal" not in page.partition("<main>")[2]
    )
    # It is decided, can be found as such, and can be taken back.
    with Served(out) as served:
        assert first_of(served, "decided") == cluster.id
        served.decide(cluster.id, "credit=back")
        served.decide(cluster.id, "credit=back")
        assert served.decide(cluster.id, "credit=back").status == 409
    assert {move.after for move in regrade(out, solutions=graded / "solutions").moves} == {5}


def test_two_who_judge_at_once_are_told_and_lose_nothing(out):
    with Served(out, grader="Ann") as first, Served(out, grader="Ben") as second:
        name = first_of(first)
        seen = first.seen(name)
        assert second.decide(name, "credit=0.5&comment=Half", seen).status == 303
        headers = {
            "Origin": f"http://127.0.0.1:{first.port}",
            "Content_Type": "application/x-www-form-urlencoded",
        }
        body = f"credit=1&comment=All+of+it&seen={quote(seen)}"
        response, page = first.ask(f"/{first.secret}/answer/{name}", "POST", body, **headers)
        assert response.status == 409 and "Ben gave 0.5" in page and "All of it" in page
        assert {decision.who for decision in Journal(out).by_people} == {"Ben"}
        # Ann cannot take back Ben's decision, but she can decide after it.
        assert first.decide(name, "credit=back").status == 409
        assert first.decide(name, "credit=1").status == 303
        assert second.decide(name, "credit=back").status == 303
        assert {decision.who for decision in Journal(out).standing().decisions.values()} == {"Ann"}


def test_names_are_hidden_on_request(out):
    with Served(out, hide_names=True) as served:
        _, text = served.ask(f"/{served.secret}/answer/{first_of(served, 'all')}")
        shown = re.sub(r'(value|href)="[^"]*"', "", text)
        assert "student " in shown and not re.search("copies|was-copied|pokes", shown)


def test_a_folder_without_what_is_needed_is_named(out, tmp_path):
    with pytest.raises(SystemExit, match="no records"):
        main(["review", str(tmp_path / "empty")])
    with pytest.raises(SystemExit, match="does not exist.*made no decisions"):
        main(["merge", str(out), str(tmp_path / "none")])


def test_who_stops_judging_has_the_decisions_in_the_marks(out):
    command = [sys.executable, "-m", "coursework", "review", str(out)]
    # Tests started in the background, and everything that they start, would ignore Ctrl+C.
    hear = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=hear) as page:
        assert "Open this address" in page.stdout.readline()
        # Only this machine can open it.
        listening = psutil.Process(page.pid).net_connections("inet")
        assert {connection.laddr.ip for connection in listening} == {"127.0.0.1"}
        Journal(out).add(Store(out).read("rounded-1", "turns"), "turns/sum", 0.5, comment="Nearly.")
        page.send_signal(signal.SIGINT)
        said = page.stdout.read()
    assert "'rounded-1', turns: 5 -> 5.5" in said and "Marks changed: 0." in said
    assert "Nearly." in (out / "feedback" / "rounded-1" / "turns.html").read_text()


# ---- free text and plots

PLOT = [
    ("code", "import matplotlib.pyplot as plt\n\nfrom coursework import check"),
    ("code", "### BEGIN SOLUTION\nplt.plot([0, 1, 2], [0, 1, 4])\n### END SOLUTION"),
    ("code", '### BEGIN SOLUTION\nseen = "It bends upwards, as a square does."\n### END SOLUTION'),
    (
        "code",
        "check('plots/seen', seen)\n"
        "### BEGIN HIDDEN TESTS\n"
        "question('plots/seen', kind='free text', worth=4, rubric=['sees the bend', 'names the "
        "square'])\n"
        "### END HIDDEN TESTS",
    ),
]


def picture(color):
    """Return a plot as Jupyter stores it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure, data = Figure(figsize=(5, 3), dpi=80), io.BytesIO()
    figure.subplots().plot([0, 1, 2], [0, 1, 4], color=color)
    FigureCanvasAgg(figure).print_png(data)
    return base64.b64encode(data.getvalue()).decode()


@pytest.fixture(scope="module")
def plotted(tmp_path_factory):
    """The results of a class that drew and wrote; some of its drawings are not pictures."""
    place = tmp_path_factory.mktemp("plots")
    (place / "solutions").mkdir()
    nbformat.write(notebook(PLOT), place / "solutions" / "plots.ipynb")
    drawn = {
        "ada": [{"image/png": picture("C0"), "text/plain": "<Figure>"}],
        "ben": [
            {"image/png": picture("C3")},
            {"image/png": base64.b64encode(SCRIPT.encode()).decode()},
        ],
        "eve": [
            {"image/svg+xml": f"<svg>{SCRIPT}</svg>"},
            {"image/png": f'"> {SCRIPT}'},
            {"text/html": SCRIPT},
        ],
    }
    for student, shown in drawn.items():
        cells = [
            PLOT[0],
            "plt.plot([0, 1, 2], [0, 1, 4])",
            f"seen = 'It bends upwards, says {student}.'",
        ]
        made = notebook([*cells, "check('plots/seen', seen)"])
        made.cells[2].source = f"plt.plot([0, 1, 2], [0, 1, 4])\n{made.cells[2].source}"
        made.cells[2].outputs = [nbformat.v4.new_output("display_data", data) for data in shown]
        put(place / "submissions", student, made, "plots.ipynb")
    grade_quietly(place / "submissions", place / "out", place / "solutions")
    return place / "out"


def test_plots_are_seen_beside_the_text_and_only_pictures_are_shown(plotted):
    with Served(plotted) as served:
        assert "img-src data:;" in POLICY
        _, text = served.ask(f"/{served.secret}/")
        answers = re.findall(r"answer/([0-9a-f]{16})", text)
        pages = [
            served.ask(f"/{served.secret}/answer/{answer}")[1] for answer in dict.fromkeys(answers)
        ]
    assert len(pages) == 3
    for page in pages:
        (student,) = re.findall(r"bends upwards, says (\w+)", page.partition("The cells of")[0])
        beside, _, code = page.partition("<form")
        assert (
            beside.count('<img src="data:image/png;base64,') == (student != "eve")
            and "<img" not in code
        )
        assert f'<p class="prose">It bends upwards, says {student}.</p>' in beside
        assert "sees the bend" in page and "<svg>" not in page and "onerror=alert(2)>" not in page
        assert len(re.findall("<script", page)) == 1


# ---- in a browser


def on_a_telephone(out, plotted, browser, scheme):
    """Open the pages for instructors and for students, one after another."""
    with Served(out) as served, Served(plotted) as of_plots:
        # The page's own policy lets no script in. It is tested elsewhere and bypassed here.
        context = browser.new_context(
            color_scheme=scheme, viewport={"width": 380, "height": 800}, bypass_csp=True
        )
        page = context.new_page()
        written = [out / "report.html", *(out / "feedback").glob("[hb]*/turns.html")]
        assert len(written) == 3
        for place in (
            f"{served.address}?show=all",
            f"{served.address}answer/{first_of(served, 'wrong')}?show=wrong",
            f"{of_plots.address}answer/{first_of(of_plots)}",
            *(path.as_uri() for path in written),
        ):
            page.goto(place)
            yield page
        context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_fit_a_telephone_and_are_accessible(out, plotted, browser, scheme):
    places = (
        folder / "node_modules" / "axe-core" / "axe.min.js"
        for folder in (PROJECT, *PROJECT.parents)
    )
    axe = next(filter(Path.is_file, places), None)
    if axe is None:
        pytest.skip(
            "axe-core is not here: `npm install --no-save axe-core` in the folder of this project "
            "fetches it"
        )
    for page in on_a_telephone(out, plotted, browser, scheme):
        assert page.evaluate("document.documentElement.scrollWidth") <= 380
        page.evaluate(axe.read_text("utf8"))
        violations = page.evaluate(
            "async () => (await axe.run()).violations.map(v => v.id + ': ' + v.nodes[0].html)"
        )
        assert violations == []


MANY = 12


def test_many_answers_are_reviewed_by_keys_alone(tmp_path, browser, graded):
    """Decide on many different answers without a mouse and lose none.

    Single keys decide nothing before somebody has switched them on.
    """
    out = shutil.copytree(graded / "out", tmp_path / "out")
    store = Store(out)
    rounded = store.read("rounded-0", "turns")
    for record in store.all():
        store.place(record.student, record.assignment).unlink()
    for number in range(MANY):
        content = rounded.as_json()
        content["student"] = f"student-{number:03}"
        content["marks"]["turns/sum"]["group"] = f"{number:016x}"
        content["answers"]["turns/sum"]["plain"]["nodes"][0][-1] = f"1.000{number:03}"
        give(store, Record.from_json(content, "one"))
    with Served(out) as served:
        # The page's own policy forbids a test's scripts, too; its content is tested above.
        page = browser.new_context(bypass_csp=True).new_page()
        requests = []
        page.on("request", lambda request: requests.append(request.url))
        page.goto(served.address)
        page.keyboard.press("n")
        assert page.url == served.address and not page.locator("kbd").first.is_visible()
        while not page.evaluate("document.activeElement.id === 'keys'"):
            page.keyboard.press("Tab")
        page.keyboard.press("Space")
        with page.expect_navigation():
            page.keyboard.press("n")
        for number in range(MANY):
            # The page's policy forbids waiting by a script, so wait for its text.
            page.locator(".steps", has_text=re.compile(rf"\b1 of {MANY - number}\b")).wait_for(
                timeout=60_000
            )
            if number == 3:
                page.keyboard.press("c")
                page.keyboard.type("Rounded: 4 digits")  # In a field, a character is no command.
                page.keyboard.press("Escape")
            with page.expect_navigation():
                page.keyboard.press("4" if number % 2 else "2")
        page.goto(served.address)
        assert "0 answers wait" in page.text_content("main")
        page.context.close()
    assert all(url.startswith("http://127.0.0.1:") for url in requests)
    decided = Journal(out).standing().decisions
    assert sorted(decision.credit for decision in decided.values()) == [0.5] * (MANY // 2) + [1] * (
        MANY // 2
    )
    assert [decision.comment for decision in decided.values() if decision.comment] == [
        "Rounded: 4 digits"
    ]


#: Libraries that must know their system before it is another.
LIBRARIES = "import nbformat, sympy, tornado.httpserver, tornado.ioloop, tornado.web\n"
#: Code that runs before the command and imitates Windows: what it lacks, and how it locks a file.
ON_WINDOWS = """
import os, shutil, subprocess, sys, types
for name in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules[name] = None
del os.O_DIRECTORY
really_open = os.open
def refuses_folders(path, *more, **others):
    if os.path.isdir(path):
        raise PermissionError(13, "Permission denied")
    return really_open(path, *more, **others)
os.open = refuses_folders
# Nor does Python remove folders there by opening them.
shutil._use_fd_functions = False
held = set()
def locking(number, mode, count):
    place = (os.fstat(number).st_ino, os.lseek(number, 0, os.SEEK_CUR))
    assert (mode, count) == (7, 1) and place[1] > 1 << 30, "a place that no file reaches"
    if place in held:
        raise OSError(36, "Resource deadlock avoided")
    held.add(place)
sys.modules["msvcrt"] = types.SimpleNamespace(LK_NBLCK=7, locking=locking)
"""


def on_windows(program, *arguments, libraries=""):
    command = [sys.executable, "-c", libraries + ON_WINDOWS + program, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.long
def test_on_windows_what_runs_nobody_s_code_runs(out, tmp_path):
    """Commands that do run students' code say where they can run."""
    command = "from coursework.__main__ import main\nmain(sys.argv[1:])"
    runs = functools.partial(on_windows, libraries=LIBRARIES)
    done = runs(command, "export", out, "--feedback", tmp_path / "feedback.zip")
    assert done.returncode == 0 and (tmp_path / "feedback.zip").is_file(), done.stderr
    (out / "term.toml").write_text(
        'time-zone = "Europe/Paris"\n[assignments.turns]\ndue = 2026-10-05T23:59:00\n'
    )
    done = runs(command, "term", out)
    assert done.returncode == 0 and "course.csv" in done.stdout, done.stderr
    other = shutil.copytree(out, tmp_path / "other")
    program = (
        "from pathlib import Path\nfrom coursework.grading.review import Class\n"
        "Class(Path(sys.argv[1]))"
    )
    done = runs(program, other)
    assert done.returncode == 0, done.stderr
    for arguments in (("grade", out, "--out", tmp_path / "new"), ("regrade", out)):
        done = runs(command, *arguments)
        assert done.returncode == 1 and "WSL" in done.stderr and "Traceback" not in done.stderr, (
            done.stderr
        )
        assert len(done.stderr.splitlines()) == 1


def test_on_windows_a_file_is_one_process_s_own(tmp_path):
    program = (
        "from coursework.grading.store import InUse, Store\n"
        "with Store(sys.argv[1]).locked():\n"
        "    try:\n        with Store(sys.argv[1]).locked():\n            print('twice')\n"
        "    except InUse as error:\n        print(error)\n"
    )
    done = on_windows(program, tmp_path)
    assert "Another run is using" in done.stdout and "twice" not in done.stdout, done.stderr
