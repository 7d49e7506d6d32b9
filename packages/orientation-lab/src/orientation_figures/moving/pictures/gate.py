"""The picture of a walk past a car: the error of the heading over time."""

# The edges of the plot in seconds and in degrees. The car is between two of the seconds.
FIRST = 8
LAST = 45
LARGEST = 60
CAR = (28, 33)
LEFT = -132
RIGHT = 168
TOP = -96
BOTTOM = 96


def across(time):
    return LEFT + (RIGHT - LEFT) * (time - FIRST) / (LAST - FIRST)


def down(error):
    return (TOP + BOTTOM) / 2 - (BOTTOM - TOP) / 2 * max(-1, min(1, error / LARGEST))


def picture(sheet, curves):
    origin = [0, 0, 0]
    near, far = across(CAR[0]), across(CAR[1])
    corners = [[near, TOP], [far, TOP], [far, BOTTOM], [near, BOTTOM]]
    sheet.area([sheet.placed(right, below) for right, below in corners], "N", 16, False)
    sheet.label(origin, r"$\mathrm{car}$", "muted", [(near + far) / 2, TOP + 12], 14)
    for error, words in [[-60, "$-60$"], [-30, "$-30$"], [0, "$0$"], [30, "$30$"], [60, "$60$"]]:
        sheet.path("ML", [[LEFT, down(error)], [RIGHT, down(error)]], "faint muted")
        sheet.label(origin, words, "muted", [LEFT - 22, down(error)], 14)
    for time, words in [[10, "$10$"], [20, "$20$"], [30, "$30$"], [40, "$40$"]]:
        sheet.path("ML", [[across(time), TOP], [across(time), BOTTOM]], "faint muted")
        sheet.label(origin, words, "muted", [across(time), BOTTOM + 14], 14)
    sheet.label(origin, r"$t\ \mathrm{(s)}$", "ink", [across(44), BOTTOM + 16], 16)
    sheet.label(origin, r"$\mathrm{heading\ error\ (degrees)}$", "ink", [0, TOP - 16], 16)
    sheet.layer = 1
    for curve in curves:
        points = [[across(FIRST + second), down(error)] for second, error in enumerate(curve)]
        sheet.path("M" + "L" * (len(points) - 1), points, "D")


def drawing(figure, Sheet):
    walks = figure.of_all_walks
    gate = f"a gate that rejects {100 * figure.gate:g} per cent" if figure.gate else "no gate"
    ends = ", ".join(f"{curve[-1]:.0f}" for curve in walks["curves"])
    sheet = Sheet(
        "The error of a phone's heading over 37 seconds of a walk, for five walks. From 28 to 33 "
        f"seconds the route leads past a car that adds {figure.steel} microtesla. The filter has "
        f"{gate}. The five curves end at {ends} degrees. Of a hundred walks, half end "
        f"within {walks['middle']} degrees of the true heading, and the worst is {walks['worst']} "
        f"degrees off. The filter rejected {100 * walks['rejected']:.0f} per cent of the field "
        "measurements."
    )
    return sheet.paint(picture, walks["curves"])
