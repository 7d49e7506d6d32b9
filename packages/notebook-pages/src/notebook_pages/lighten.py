"""Remove from the HTML of a page what it repeats, so that it is light and looks the same.

Drawings are most of it: their coordinates are shortened, and outlines of letters, styles and
colours are written once. Code has fewer elements. Stills become files.
"""

import re
from collections import Counter
from hashlib import sha256

#: A path in one of the book's drawings, whose points are relative to one corner.
ABSOLUTE = re.compile(r'(?<= d=")M[MLQCZ\d. -]*(?=")')
MOVED = re.compile(r"(?<=translate\()[^)]*")


def tenths(numbers):
    """Return tenths as numbers, as a drawing writes them."""
    return re.sub(
        r"(?<!\d)0(?=\.)", "", " ".join(f"{number / 10:g}" for number in numbers)
    ).replace(" -", "-")


def in_steps(path):
    """Return a path with relative coordinates in tenths of a pixel, fine enough for the eye."""
    written, before, here = "", "", [0, 0]
    for letter, numbers in re.findall(r"([MLQCZ])([^A-Z]*)", path[0]):
        points = [round(10 * float(number)) for number in numbers.split()]
        steps = tenths(point - here[place % 2] for place, point in enumerate(points))
        if letter == "M":
            start = points
        here = start if letter == "Z" else points[-2:]
        same = letter == before != "Z"
        written += (" " if same and steps[0] != "-" else "" if same else letter.lower()) + steps
        before = "L" if letter == "M" else letter
    return written


def in_short(drawing):
    """Return a drawing with coordinates in tenths of a pixel; plots keep their precision."""

    def place(numbers):
        return tenths(round(10 * float(number)) for number in re.findall(r"-?[\d.]+", numbers[0]))

    drawing = MOVED.sub(place, ABSOLUTE.sub(in_steps, drawing))
    drawing = re.sub(r' [xy]="0"|(?<=scale\()0(?=\.)', "", drawing)
    return re.sub(r' clip-path="([^"]*)" style="([^"]*)', r' style="\2;clip-path:\1', drawing)


STYLED = re.compile(r' style="([^"]*)"')
BEGIN = re.compile(r'<svg\b(?:[^">]|"[^"]*")*>')


def name_styles(drawing):
    """Define each repeated style of a plot once, inside the plot, so that it stays with the plot.

    The name follows from the style, because plots of several pages may be in one document. The
    book's own drawings have classes and are left as they are.
    """
    uses = Counter(STYLED.findall(drawing))
    names = {
        style: f"s{sha256(style.encode()).hexdigest()[:6]}"
        for style, times in uses.items()
        if times > 2
    }
    if not names or " class=" in drawing:
        return drawing
    rules = "".join(f".{name}{{{style}}}" for style, name in names.items())
    drawing = BEGIN.sub(lambda begin: f"{begin[0]}<style>{rules}</style>", drawing, count=1)
    return STYLED.sub(
        lambda style: f' class="{names[style[1]]}"' if style[1] in names else style[0], drawing
    )


DEFINITIONS = re.compile(r"<defs>((?:<path [^>]*/>)+)</defs>")
OUTLINE = re.compile(r'<path ([^>]*?)\bid="([^"]*)" ?([^>]*)/>')
HIDDEN = (
    '<svg class="outlines" width="0" height="0" style="position:absolute" '
    'aria-hidden="true"><defs>{}</defs></svg>'
)
PLACED = re.compile(r'<use transform="translate\(([-.\d]+) ([-.\d]+)\)" href=')
USE = re.compile(r'<use ([^>]*)href="#([^"]*)"([^>]*)/>')


def share_outlines(body):
    """Move the outlines of letters from the drawings of a page into one table at its end.

    A space between two words has no outline, so it is removed wherever it is used.
    """
    numbers = {}

    def share(drawing):
        names, blanks = {}, set()

        def take(definitions):
            for before, name, after in OUTLINE.findall(definitions[1]):
                if re.search(r'\bd="[^"]', before + after):
                    names[name] = f"o{numbers.setdefault((before + after).strip(), len(numbers))}"
                else:
                    blanks.add(name)
            return ""

        def place(use):
            before, name, after = use.groups()
            return (
                "" if name in blanks else f'<use {before}href="#{names.get(name, name)}"{after}/>'
            )

        text = DEFINITIONS.sub(take, drawing[0].replace(" />", "/>"))
        text = USE.sub(place, PLACED.sub(r'<use x="\1" y="\2" href=', text))
        return name_styles(in_short(text))

    body = re.sub(r"<svg\b.*?</svg>", share, body, flags=re.DOTALL)
    table = "".join(f'<path id="o{number}" {outline}/>' for outline, number in numbers.items())
    return body + HIDDEN.format(table) if numbers else body


# A piece of code within the text or in the signature of a function.
LITERAL = re.compile(r'<code class="([^"]*)"><span class="pre">([^<]*)</span></code>')
NAME = re.compile(
    r'(<(?:span|em) class="(?:sig|n|o|default)[^"]*">)<span class="pre">([^<]*)</span>'
)
#: A block of code, and a coloured word in it.
PROGRAM = re.compile(r"<pre\b.*?</pre>", re.DOTALL)
TOKEN = re.compile(r'<span class="(\w{1,3})">([^<]*)</span>')
#: All kinds of numbers have one colour, and so do all kinds of strings.
KIND = re.compile(r"(?<=<i class=[ms])\w+")
#: The colour of a face of a drawing, which its class has in the style sheet of the page, too.
COLOUR = re.compile(r'(<path class="\w+ tone-\d"[^>]*?) fill="[^"]*" stroke="none"')


def lighten(body):
    """Remove repetitions from a page.

    Every figure contains the style sheet of all figures and the outlines of its letters, since in a
    notebook it is alone. There a screen reader needs its role, too; here it is inside an element
    with a name, or its drawing has one. Names, brackets, spaces and operators of a program have the
    colour of the text around them and need no element each. Neither does a single word within an
    element, nor a part of a string. A face of a drawing has the colour of its class.
    """
    first = {}

    def first_only(style):
        return style[0] if first.setdefault(style[0], style) is style else ""

    body = re.sub(r"<style>\.orientation-figure[^<]*</style>", first_only, body)
    body = re.sub(r'<figure (?=class="orientation-figure)', '<figure role="none" ', body)
    body = COLOUR.sub(r"\1", body)
    body = NAME.sub(r"\1\2", LITERAL.sub(r'<code class="\1">\2</code>', body))
    body = re.sub(r'<span class="(?:n|p|w|nn|o)">([^<]*)</span>', r"\1", body)

    def in_colour(program):
        text = KIND.sub("", TOKEN.sub(r"<i class=\1>\2</i>", program[0]))
        return re.sub(r"(?<=<i class=s>)([^<]*)((?:</i><i class=s>[^<]*)+)", joined, text)

    def joined(parts):
        return parts[1] + parts[2].replace("</i><i class=s>", "")

    return share_outlines(PROGRAM.sub(in_colour, body))


#: A still of a page that animates its own figure: its name, its style sheet, and the drawing with
#: its width, height, own style and words.
STILL = re.compile(
    r'(?<=data-stop=")([^"]*)"><style>([^<]*)</style>'
    r'<svg (viewBox="\S+ \S+ (\S+) (\S+)" style="([^"]*)" role="img" aria-label="([^"]*)")>'
    r"(.*?</svg>)",
    re.DOTALL,
)
DARK = re.compile(r'html\[data-theme="dark"\] ([^,{]*)[^{]*(\{[^}]*\})')


def move_stills_out(body, site, address_of):
    """Replace the stills of a page that animates its own figure by pictures that are files.

    They are seen on paper, without scripts and where the figure has no room, and are heavier than
    the rest of the page. The browser fetches them where they are shown. A picture does not have the
    colours of its page, so it follows the colour scheme that the page sets for it.
    """

    def as_picture(still):
        name, style, start, width, height, size, words, marks = still.groups()
        style = re.sub(r"\.orientation-figure(?:\.painted)?(?: svg)?", ":root", style)
        style = DARK.sub(r"@media (prefers-color-scheme:dark){\1\2}", style)
        (site / "stills").mkdir(exist_ok=True)
        (site / "stills" / f"{name}.svg").write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" {start}><style>{style}:root{{margin:0;'
            f"color-scheme:light dark;--pst-color-background:Canvas}}</style>{marks}",
            "utf8",
        )
        return (
            f'{name}"><img loading="lazy" src="{address_of(f"stills/{name}.svg", 1)}" '
            f'width="{width}" height="{height}" style="{size}" alt="{words}">'
        )

    return STILL.sub(as_picture, body)
