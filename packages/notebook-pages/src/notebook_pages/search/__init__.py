"""The search: an index of places, made from the built pages, and the palette that queries it.

The places, with their numbers, first sentences and characteristic words, come from the pages. Two
files are written for it by hand: ``appendix/synonyms.yml`` lists the readers' words for terms of
the book, and ``appendix/questions.txt`` lists what readers have asked.
"""

import json
import re
from collections import Counter
from hashlib import sha256
from pathlib import Path

import yaml
from bs4 import BeautifulSoup

from ..finish import pages_of
from ..paths import YAML, esbuild, is_solutions, parts

HERE = Path(__file__).parent
SCRIPT, WORDS = Path("_static") / "search.js", Path("_static") / "search-words.js"
WORD = re.compile(r"[a-z][a-z0-9_-]*[a-z0-9]")
# The page that accepts pasted text, if the book has it.
WORKBENCH = "workbench.html"
FIELDS = ("kind", "page", "anchor", "number", "title", "about", "asked")
KINDS = ("page", "section", "term", "function", "exercise", "example", "equation", "figure")
SYNONYMS, QUESTIONS = Path("appendix/synonyms.yml"), Path("appendix/questions.txt")
# Longer phrases are loaded later, before anyone has typed so many words.
LONG = 4
LONGEST_SENTENCE = 76
LATER = ("equation", "figure")
# Kinds whose first sentences are loaded later.
SAID_LATER = ("function", "exercise", "example")
# Entries that count no more than this are found by their titles alone.
LITTLE = 0.5
# Sections of every chapter, which nobody looks for by name.
EVERYWHERE = ("Summary", "Exercises", "Learning objectives")
REST = "script, style, svg, pre, .eqno, table, .admonition-title"


def text_of(element, left_out=()):
    """Return the words of an element, without those of the elements ``left_out``."""
    parts, waiting = [], [element]
    while waiting:
        part = waiting.pop()
        if isinstance(part, str):
            parts.append(part)
        elif id(part) not in left_out:
            waiting += reversed(part.contents)
    # Remove the invisible character for the application of a function.
    words = " ".join(" ".join(parts).replace("\u2061", "").split())
    return re.sub(r" (?=[,.;:)])|(?<=\() ", "", re.sub(r" ?∘", "°", words))


def first_sentence(element, left_out=()):
    """Return the first sentence of the text in ``element``, or as much of it as fits on a line."""
    if element.name in ("dd", "p"):
        paragraph = element
    # A line of nothing but emphasis is not part of the text.
    else:
        asides = [
            emphasis
            for emphasis in element.select(":scope > p > em:only-child")
            if text_of(emphasis) == text_of(emphasis.parent)
        ]
        beside = {id(emphasis.parent) for emphasis in asides}
        paragraph = next(
            (
                candidate
                for candidate in element.find_all("p", recursive=False)
                if id(candidate) not in beside
            ),
            None,
        )
    words = text_of(paragraph, left_out) if paragraph else ""
    return first_words(re.split(r"(?<=[.?!]) (?=[A-Z])", words)[0])


def first_words(text):
    """Return as much of a text as fits on a line."""
    return (
        text if len(text) <= LONGEST_SENTENCE else text[:LONGEST_SENTENCE].rpartition(" ")[0] + " …"
    )


def title_of(heading):
    """Return the number and the words of a heading."""
    number = heading.select_one(".section-number")
    words = number.extract().get_text().strip().rstrip(".") if number else ""
    return words, text_of(heading)


def captions():
    """Return the caption of the part of the book to which each page belongs."""
    return {page: caption for caption, pages in parts() for page in pages}


def entries_of_page(page, article):
    """Return the places of one page.

    The text of each, from which its words are chosen, is in ``text``.
    """
    tex = {
        box["id"]: " ".join(formula["data-tex"] for formula in box.select("[data-tex]"))
        for box in article.select("div.math[id]")
    }
    numbers = {
        box["id"]: text_of(box.select_one(".eqno")).strip("()# ")
        for box in article.select("div.math[id]:has(.eqno)")
    }
    for rest in article.select(".headerlink, .katex > [aria-hidden]"):
        rest.extract()
    rest = {id(part) for part in article.select(REST)}
    inner = rest | {id(part) for part in article.select("section")}
    for section in article.select("section[id]"):
        heading = section.find(["h1", "h2", "h3", "h4"], recursive=False)
        if heading is None:
            continue
        number, title = title_of(BeautifulSoup(str(heading), "lxml").find(heading.name))
        if title in EVERYWHERE and heading.name != "h1":
            continue
        kind = (
            "page"
            if heading.name == "h1"
            else "example"
            if title.startswith("Worked example")
            else "section"
        )
        anchor = "" if kind == "page" else section["id"]
        own = " ".join(
            text_of(part, inner)
            for part in section.contents
            if id(part) not in inner and part is not heading
        )
        yield {
            "kind": kind, "title": title, "number": number, "anchor": anchor,
            "about": first_sentence(section, rest), "text": own,
        }  # fmt: skip
        for box in section.select("div.math[id]"):
            if box.find_parent("section") is section and box["id"] in numbers:
                number = numbers[box["id"]]
                called = {
                    "kind": "equation",
                    "title": f"Equation {number}: {title}",
                    "number": number,
                }
                yield called | {"anchor": box["id"], "tex": tex[box["id"]]}
    for figure in article.select("figure[id]:has(> figcaption)"):
        caption = figure.find("figcaption", recursive=False)
        number = caption.select_one(".caption-number")
        number = text_of(number.extract()) if number else ""
        title, *rest = re.split(r"(?<=[.?!]) (?=[A-Z])", text_of(caption), maxsplit=1)
        called = {
            "kind": "figure",
            "title": title.rstrip("."),
            "number": number,
            "anchor": figure["id"],
        }
        yield called | ({"about": first_words(rest[0])} if rest else {})
    for exercise in article.select(".admonition.exercise[id]"):
        number, _, title = text_of(exercise.select_one(".admonition-title")).partition("(")
        body = exercise.select_one("section, div") or exercise
        called = {
            "kind": "exercise",
            "title": title.rstrip(" )") or number,
            "number": number.strip(),
        }
        yield called | {
            "anchor": exercise["id"],
            "about": first_sentence(body),
            "text": text_of(body),
        }
    for name in article.select("dl.glossary > dt[id]"):
        yield {
            "kind": "term",
            "title": text_of(name),
            "anchor": name["id"],
            "about": first_sentence(name.find_next("dd")),
        }
    for name in article.select("dl.py > dt.sig[id]"):
        words = name["id"].partition(".")[2]
        # Leave out methods of classes within modules.
        if name["id"].count(".") <= 2:
            yield {
                "kind": "function",
                "title": words,
                "anchor": name["id"],
                "about": first_sentence(name.find_next("dd")),
            }


def words_of(entry):
    """Return the words of an entry's text that are not in its title or first sentence.

    A word that occurs again counts twice.
    """
    count = Counter(word for word in WORD.findall(entry.pop("text", "").lower()) if len(word) > 2)
    shown = set(WORD.findall(f"{entry['title']} {entry.get('about', '')}".lower()))
    return " ".join(
        word for word, number in count.items() if word not in shown for _ in range(1 + (number > 2))
    )


def weight_of(page):
    """Return the weight of a page: chapters explain, and other pages contain supplements."""
    if is_solutions(page):
        return 0.3
    if page.startswith("exercises/"):
        return LITTLE
    return 0.9 if page.startswith("appendix/reference") else 1


def questions(path):
    """Iterate over the questions that readers ask and the places that answer them, best first."""
    for line in path.read_text("utf8").splitlines() if path.exists() else []:
        if not line.startswith("#"):
            typed, places, *_ = line.split("|")
            yield typed.strip(), [place.strip() for place in places.split(",")]


def index(site):
    """Return the data of the palette: pages, places and synonyms.

    Returns also each place's words and TeX, which are loaded later.
    """
    caption, pages, entries = captions(), [], []
    synonyms = yaml.load(SYNONYMS.read_text("utf8"), YAML) if SYNONYMS.exists() else {}
    asked = synonyms.pop("places", {})
    for question, (place, *_) in questions(QUESTIONS):
        page, _, anchor = place.partition("#")
        asked.setdefault(page, {}).setdefault(anchor, []).append(question)
    # Reading the pages takes most of the time, and few of them change between two builds.
    memory = (
        site.parent / f"search-entries-{sha256(Path(__file__).read_bytes()).hexdigest()[:12]}.json"
    )
    cached, used = json.loads(memory.read_text("utf8")) if memory.exists() else {}, {}
    for path in pages_of(site):
        page = path.relative_to(site).with_suffix("").as_posix()
        if page in ("search", "404", "appendix/subject-index"):
            continue
        # Drawings and code are most of a page, but no help in a search.
        text = re.sub(r"<(svg|pre|script)\b.*?</\1>", "", path.read_text("utf8"), flags=re.DOTALL)
        key = sha256(f"{page}\n{text[text.find('<article') :]}".encode()).hexdigest()
        if key in cached:
            entries_found = cached[key]
        else:
            article = BeautifulSoup(text, "lxml").article
            entries_found = list(entries_of_page(page, article)) if article else []
        used[key] = entries_found
        if not entries_found:
            continue
        pages.append([page, entries_found[0]["title"], caption.get(page, ""), weight_of(page)])
        phrases = asked.pop(page, {})
        entries += [
            entry
            | {
                "page": len(pages) - 1,
                "asked": phrases.pop(entry["anchor"], ""),
                "weight": weight_of(page),
            }
            for entry in entries_found
        ]
    for old in site.parent.glob("search-entries-*.json"):
        old.unlink()
    memory.write_text(json.dumps(used), "utf8")
    # Equations are found by their content, and figures are many but seldom looked for, so load both
    # later.
    first = [entry for entry in entries if entry["kind"] not in LATER]
    last = [entry for entry in entries if entry["kind"] in LATER and entry["weight"] > LITTLE]
    words = [words_of(entry) if entry["weight"] > LITTLE else "" for entry in first]
    for entry in first:
        if entry["weight"] <= LITTLE and not entry["asked"]:
            entry["about"] = ""
    long = [[phrase for phrase in entry["asked"] if len(phrase.split()) > LONG] for entry in first]
    for entry, some in zip(first, long, strict=True):
        entry["asked"] = [phrase for phrase in entry["asked"] if phrase not in some] or ""
    about = [
        [k, entry.pop("about")]
        for k, entry in enumerate(first)
        if entry["kind"] in SAID_LATER and entry.get("about")
    ]
    later = {
        "words": words,
        "about": about,
        "asked": [[k, some] for k, some in enumerate(long) if some],
        "entries": [row(entry) for entry in last],
        "tex": [[k, entry["tex"]] for k, entry in enumerate(last, len(first)) if "tex" in entry],
    }
    entries_found = {
        "pages": pages,
        "fields": FIELDS,
        "kinds": KINDS,
        "entries": [row(entry) for entry in first],
        "synonyms": synonyms,
    }
    return entries_found | ({"workbench": WORKBENCH} if (site / WORKBENCH).exists() else {}), later


def row(entry):
    """Return an entry as a list of values, without the empty ones at its end."""
    values = [KINDS.index(entry["kind"]), *(entry.get(field, "") for field in FIELDS[1:])]
    while values[-1] == "":
        values.pop()
    return values


def write(site):
    """Write the palette with its index as one script.

    It is a script because pages opened from a disk may fetch nothing else. The words of the text
    and the formulas, which are larger than all the rest, are loaded later, as another script.
    """
    flags = [
        "--bundle",
        "--minify",
        "--format=iife",
        "--legal-comments=none",
        "--log-level=warning",
    ]
    palette = esbuild(HERE / "js" / "palette.js", *flags)
    data_of_palette, later = index(site)
    text = f"self.searchWords={json.dumps(later, ensure_ascii=False, separators=(',', ':'))};"
    (site / WORDS).write_text(text, "utf8")
    data_of_palette["words"] = f"{WORDS.as_posix()}?v={sha256(text.encode()).hexdigest()[:8]}"
    data = json.dumps(data_of_palette, ensure_ascii=False, separators=(",", ":"))
    (site / SCRIPT).write_text(f"self.searchIndex={data};\n{palette}", "utf8")


def begin(app):
    # Sphinx's own search finds the words of a page but leads only to its top.
    app.builder.search = False


def add_page(app):
    yield "search", {"title": "Search"}, "search.html"


def add_address(app, pagename, templatename, context, doctree):
    context["search_script"] = context["pathto"](SCRIPT.as_posix(), 1)


def finish(app, exception):
    if not exception and app.builder.format == "html":
        write(Path(app.outdir))


def setup(app):
    app.connect("builder-inited", begin)
    app.connect("html-collect-pages", add_page)
    app.connect("html-page-context", add_address)
    # Run after all pages are written and before they state its version.
    app.connect("build-finished", finish, priority=970)
