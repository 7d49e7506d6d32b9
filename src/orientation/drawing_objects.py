"""Things that carry frames, for the figures: an eye, a book, a camera on its gimbal."""
import numpy as np

from .direction_cosines import simple_dcm
from .drawing import Drawing, view_from


def draw_eye(drawing, point, size=40, colour='ink'):
    """Draw an eye, `size` pixels wide, that looks to the right."""
    def place(points):
        return drawing.on_sheet(point) + size * np.array(points)

    drawing.path('MQQ', place([(-0.5, 0), (0, -0.62), (0.5, 0.05), (0, 0.45), (-0.5, 0)]), f'paper {colour}')
    for x, y, outward in ((-0.3, -0.22, -0.12), (-0.05, -0.31, -0.02), (0.2, -0.24, 0.1)):
        drawing.path('ML', place([(x, y), (x + outward, y - 0.15)]), colour)
    drawing.dot(point, 'muted', 0.19 * size)
    return drawing.dot(point, colour, 0.09 * size)


def draw_book(drawing, dcm, origin=(0, 0, 0), colour='A', size=(0.8, 1.1, 0.22)):
    """Draw a closed book: the rows of `dcm` point across the cover, up the cover, and out of the cover."""
    rows, (width, height, depth) = np.asarray(dcm, dtype=float), size
    drawing.box(rows, size, origin, colour)
    if rows[2] @ drawing.view[2] > 0:
        for y, half in ((0.28, 0.28), (0.14, 0.2)):
            ends = np.array([(-half * width, y * height, depth / 2), (half * width, y * height, depth / 2)])
            drawing.line(origin + ends @ rows, colour, 'thick')
    return drawing


GIMBAL_ALT = (
    'A hand-held camera gimbal. The upright handgrip is frame A. On its top a motor turns link B about the upright z axis '
    'through psi. At the back end of link B a motor turns link C about the lengthwise x axis through theta. At the end of '
    'link C a motor turns the camera D about the crosswise y axis through phi. The three axes meet in the camera. ')


def gimbal_drawing(angles, alt=GIMBAL_ALT):
    """Draw a hand-held camera gimbal at the angles (psi, theta, phi), radians, with its frames beside it.

    The handgrip is frame $A$; $B$ turns about $z$, $C$ about $x$ and the camera $D$ about $y$, so that
    ${}^D\\mathbf{C}^A = \\mathbf{C}_y(\\varphi)\\,\\mathbf{C}_x(\\theta)\\,\\mathbf{C}_z(\\psi)$.
    """
    psi, theta, phi = (float(angle) for angle in angles)
    A = np.eye(3)
    B = np.asarray(simple_dcm('z', psi)) @ A
    C = np.asarray(simple_dcm('x', theta)) @ B
    D = np.asarray(simple_dcm('y', phi)) @ C
    drawing = Drawing(alt, view_from(np.radians(68), np.radians(22)), 112)

    def place(frame, *points):
        return np.array(points) @ frame

    def tube(frame, colour, *points):
        drawing.line(place(frame, *points), colour, 'tube')

    def motor(frame, colour, start, end, radius=0.19):
        drawing.cylinder(*place(frame, start, end), radius, colour)

    def joint(frame, axis, start, centre, name):
        drawing.turn(place(frame, axis)[0], 3.6, place(frame, start)[0], 0.38, rf'$\{name}$', place(frame, centre)[0])

    motor(A, 'A', (0, 0, -2.1), (0, 0, -1.12), 0.15)
    motor(A, 'A', (0, 0, -1.12), (0, 0, -0.93), 0.24)
    drawing.line(place(A, (0, 0, -0.9), (0, 0, 0.75)), 'muted', 'guide')
    tube(B, 'B', (0, 0, -0.86), (-1.45, 0, -0.86), (-1.45, 0, -0.12))
    joint(B, (1, 0, 0), (0, -0.7, 0.7), (-1.45, 0, 0), 'theta')
    motor(B, 'B', (-1.58, 0, 0), (-1.3, 0, 0))
    drawing.line(place(B, (-1.3, 0, 0), (0.9, 0, 0)), 'muted', 'guide')
    tube(C, 'C', (-1.24, 0, 0), (-1.1, 0, 0), (-1.1, 0.58, 0), (0, 0.58, 0))
    drawing.box(D, (0.76, 0.5, 0.54), colour='D')
    drawing.cylinder(*place(D, (0.38, 0, 0), (0.62, 0, 0)), 0.2, 'D')
    drawing.circle(D[0], 0.12 * (D[0] @ drawing.view[2] > 0), 0.62 * D[0], 'D', 'fill-38')
    motor(C, 'C', (0, 0.28, 0), (0, 0.6, 0))
    drawing.line(place(C, (0, 0.6, 0), (0, 1.1, 0)), 'muted', 'guide')
    joint(C, (0, 1, 0), (0.5, 0, -0.86), (0, 0.8, 0), 'varphi')
    joint(A, (0, 0, 1), (0.94, 0.34, 0), (0, 0, -1.03), 'psi')
    beside = drawing.view[0] * 2.5
    for row, (letter, frame) in enumerate(zip('DCBA', (D, C, B, A))):
        drawing.triad(letter, frame, beside + drawing.view[1] * (0.85 - 0.98 * row), 0.44)
    return drawing
