"""Andrews' squeezer mechanism: seven bodies, ten hinges, a spring, a motor, and milliseconds.

Bodies, angles and numbers as in Schiehlen (1990), Multibody Systems Handbook, and Hairer & Wanner (1996),
Solving Ordinary Differential Equations II, section VII.7. Every point is a fixed one plus arms z exp(i w.q)
in the plane, with the seven angles q = (beta, Theta, gamma, Phi, delta, Omega, epsilon).
"""

import numpy as np
import pliant as pl
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

MASS = np.array([0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498])
INERTIA = np.array([2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5])
A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j
STIFFNESS, LENGTH, TORQUE = 4530.0, 0.07785, 0.033
START = np.array(
    [
        -0.0617138900142764496,
        0.0,
        0.4552798191630703803,
        0.2226683901658858847,
        0.4873649795438425502,
        -0.2226683901658858847,
        1.2305474445498211925,
    ]
)
BETA, THETA, GAMMA, PHI, DELTA, OMEGA, EPSILON = np.eye(7)
TURNS = np.array([BETA, BETA + THETA, GAMMA, PHI + DELTA, DELTA, OMEGA + EPSILON, EPSILON])
"""Angle of each body, by the angles of the mechanism."""
CRANK, BAR = (0.007, BETA), (-0.028, BETA + THETA)
KNEE_5, KNEE_7 = (0.04, DELTA), (-0.04j, EPSILON)
CENTRES = [
    (0, [(0.00092, BETA)]),
    (0, [CRANK, (-0.0115, BETA + THETA)]),
    (B, [(0.01043 - 0.01874j, GAMMA)]),
    (A, [KNEE_5, (-1j * (0.02 - 0.01421), PHI + DELTA)]),
    (A, [(0.02308 + 0.00916j, DELTA)]),
    (A, [KNEE_7, (0.02 - 0.01421, OMEGA + EPSILON)]),
    (A, [(-0.00449 - 0.01228j, EPSILON)]),
]
HOOK = (B, [(0.02 - 0.018j, GAMMA)])
MEETING = (0, [CRANK, BAR])
CHAINS = [
    (B, [(-0.035j, GAMMA)]),
    (A, [KNEE_5, (-0.02j, PHI + DELTA)]),
    (A, [KNEE_7, (0.02, OMEGA + EPSILON)]),
]
"""Where three bodies meet the bar."""


def place(point, q):
    return point[0] + sum(z * np.exp(1j * (w @ q)) for z, w in point[1])


def gradient(point, q):
    return sum(1j * z * np.exp(1j * (w @ q)) * w for z, w in point[1])


def bend(point, q, v):
    """Acceleration of a point at constant rates of the angles."""
    return sum(-z * np.exp(1j * (w @ q)) * (w @ v) ** 2 for z, w in point[1])


def rates(_, y):
    """Lagrange's equations of the first kind in the seven angles, closures differentiated twice."""
    q, v = y[:7], y[7:]
    mass = (TURNS.T * INERTIA) @ TURNS
    force = TORQUE * BETA
    for m, point in zip(MASS, CENTRES, strict=True):
        by = gradient(point, q)
        mass = mass + m * np.real(np.outer(by.conj(), by))
        force = force - m * np.real(by.conj() * bend(point, q, v))
    stretch = place(HOOK, q) - C
    pull = STIFFNESS * (abs(stretch) - LENGTH) * stretch / abs(stretch)
    force = force - np.real(np.conj(pull) * gradient(HOOK, q))
    closures = [gradient(MEETING, q) - gradient(chain, q) for chain in CHAINS]
    left = [bend(chain, q, v) - bend(MEETING, q, v) for chain in CHAINS]
    g = np.array([part for row in closures for part in (row.real, row.imag)])
    b = np.array([part for row in left for part in (row.real, row.imag)])
    matrix = np.block([[mass, g.T], [g, np.zeros((6, 6))]])
    return np.concatenate([v, np.linalg.solve(matrix, np.concatenate([force, b]))[:7]])


def squeezer():
    model = pl.Model()
    centres = [place(point, START) for point in CENTRES]
    turns = TURNS @ START
    bodies = [
        model.add_rigid_body(
            mass=m,
            inertia=(inertia, inertia, inertia),
            position=(c.real, c.imag, 0),
            orientation=Rotation.from_euler("z", turn),
        )
        for m, inertia, c, turn in zip(MASS, INERTIA, centres, turns, strict=True)
    ]

    def at(k, point):
        local = (point - centres[k]) * np.exp(-1j * turns[k])
        return bodies[k].at((local.real, local.imag, 0))

    def hinge(one, other, point):
        return model.hinge(at(one, point), None if other is None else at(other, point))

    shaft = hinge(0, None, 0)
    hinge(1, 0, place((0, [CRANK]), START))
    meeting = place(MEETING, START)
    for other in (2, 3, 5):
        hinge(other, 1, meeting)
    for one, fixed in ((2, B), (4, A), (6, A)):
        hinge(one, None, fixed)
    hinge(3, 4, place((A, [KNEE_5]), START))
    hinge(5, 6, place((A, [KNEE_7]), START))
    model.add_spring(at(2, place(HOOK, START)), (C.real, C.imag, 0), STIFFNESS, length=LENGTH)
    model.drive(shaft, torque=TORQUE)
    return model, bodies, shaft


def test_andrews_squeezer(record):
    # The numbers of the start close the loops.
    for chain in CHAINS:
        assert abs(place(chain, START) - place(MEETING, START)) < 1e-15
    times = np.linspace(0, 0.03, 31)
    exact = solve_ivp(
        rates, (0, 0.03), [*START, *np.zeros(7)], "DOP853", t_eval=times, rtol=1e-11, atol=1e-11
    ).y
    model, bodies, shaft = squeezer()
    # Ten hinges hold 50 of 42 freedoms, and leave one.
    assert sum(one.equations for one in model.redundant) == 9
    places = np.array([[place(point, q) for point in CENTRES] for q in exact[:7].T])
    crank, centres = [], []
    for h in (2e-5, 1e-5):
        result = pl.simulate(model, duration=0.03, step=h, output_every=round(1e-3 / h))
        crank.append(np.abs(result.joint(shaft).position + START[0] - exact[0]).max())
        tracks = np.stack([result.track(body.center).position for body in bodies], axis=1)
        assert np.abs(tracks[..., 2]).max() < 1e-9
        centres.append(np.abs(tracks[..., 0] + 1j * tracks[..., 1] - places).max())
    source = "seven angles, Lagrange of the first kind, DOP853"
    for what, errors in (("crank", crank), ("centres", centres)):
        assert record(
            f"Andrews' squeezer, order of {what}", np.log2(errors[0] / errors[1]), 2.0, 0.1, source=source
        )
    # The crank turns by 1140 rad/s at the most: (omega h)^2 a radian, growing over two and a half turns.
    assert record("Andrews' squeezer, crank", crank[-1], 0.0, 1e-3, unit="rad", source=source)
    # Arms of 7 to 40 mm.
    assert centres[-1] < 1e-5
    # Of 1.5 J.
    energy = result.energy
    assert np.ptp(energy.total) < 1e-3 * energy.kinetic.max()
    # The published angle of the crank at the end (Mazzia & Magherini 2008, Test set for IVP solvers), to the
    # tolerance of the reference above.
    published = 15.81077119629904
    name = "Andrews' squeezer, crank of the reference"
    assert record(name, exact[0, -1], published, 1e-6, unit="rad", source="test set for IVP solvers")
