"""Enclosed gas: balloons along the whole path, closed tubes, cushions from flat, bubbles that oscillate."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar
from verification.inflated import ATMOSPHERE, ball, balloon, cushion

RADIUS, THICKNESS, MU = 0.1, 1e-3, 1e5


def rubber(ratio: float | None) -> pl.NeoHookean:
    """Rubber with lambda = ratio mu, or incompressible."""
    nu = 0.5 if ratio is None else 0.5 * ratio / (1 + ratio)
    return pl.NeoHookean(youngs_modulus=2 * MU * (1 + nu), poisson_ratio=nu, density=1000.0)


def pressure_of(stretch: np.ndarray, ratio: float | None) -> np.ndarray:
    """Pressure of a spherical balloon in units of mu h/R: 2/l (1 - C33/l^2)."""
    area = stretch**4
    c33 = 1 / area if ratio is None else (2 + ratio) / (2 + ratio * area)
    return 2 / stretch * (1 - c33 / stretch**2)


@pytest.mark.parametrize("ratio", [None, 10.0, 2.0])
def test_balloon_through_its_limit_point(ratio, record):
    """Gas is let in: the pressure rises to a limit, and the balloon goes on where pressure would burst it."""
    air = pl.Gas()
    unit = MU * THICKNESS / RADIUS
    volume = np.pi / 6 * RADIUS**3
    limit = minimize_scalar(lambda x: -pressure_of(x, ratio), bounds=(1.1, 2.0), options={"xatol": 1e-12})
    runs = []
    for n in (2, 4):
        model, skin = balloon(n, RADIUS, THICKNESS, rubber(ratio))
        chamber = model.add_chamber(skin, air, inflow=5.0 * air.density * volume)
        result = pl.solve_static(model, load_steps=16)
        runs.append((result.chamber(chamber).pressure - ATMOSPHERE) / unit)

    def mass_of(stretch):
        return (ATMOSPHERE + unit * pressure_of(stretch, ratio)) / ATMOSPHERE * stretch**3

    filled = 1 + 5.0 * result.load_factor
    stretch = np.array([brentq(lambda x, m=m: mass_of(x) - m, 1.0, 3.0) for m in filled])
    exact = pressure_of(stretch, ratio)
    errors = [np.abs(run / exact - 1).max() for run in runs]
    assert 3.0 < errors[0] / errors[1] < 5.0, "bilinear faces: second order"
    best = (4 * runs[1] - runs[0]) / 3
    name = "incompressible" if ratio is None else f"lambda = {ratio:g} mu"
    # The two meshes extrapolated: fourth order.
    source = "closed form, C33 linear in plane stress"
    assert record(f"balloon ({name}), whole path", best, exact, 2e-3, "mu h/R", source=source)
    k = int(np.argmax(best))
    assert 2 < k < len(best) - 3
    top = np.polyfit(stretch[k - 2 : k + 3], best[k - 2 : k + 3], 4)
    found = np.polyval(top, stretch[k - 1] + np.linspace(0, stretch[k + 1] - stretch[k - 1], 2001)).max()
    source = "closed form, maximum found numerically"
    assert record(f"balloon ({name}), limit pressure", found, -limit.fun, 2e-3, "mu h/R", source=source)


def test_closed_tube_at_its_limit(record):
    """A tube with closed ends, p = 2/(l^2 lz) (...): its pressure is limited to 0.749868 mu h/R."""

    def tube(u, v):
        return RADIUS * np.cos(u), RADIUS * np.sin(u), v

    model = pl.Model()
    mesh = pl.Mesh.surface(tube, (0, np.pi / 2), (0, RADIUS), divisions=(4, 1))
    wall = model.add_shell(mesh, thickness=THICKNESS, material=rubber(None))
    model.symmetry(wall.edge("u_min"), (0, 1, 0))
    model.symmetry(wall.edge("u_max"), (1, 0, 0))
    model.symmetry(wall.edge("v_min"), (0, 0, 1))
    # The other end is free: a lid closes it, and pulls at the wall.
    air = pl.Gas()
    start = air.density * np.pi / 4 * RADIUS**3
    chamber = model.add_chamber(wall, air, inflow=4.0 * start)
    result = pl.solve_static(model, load_steps=24)
    gas = result.chamber(chamber)
    assert gas.volume[0] / (np.pi / 4 * RADIUS**3) == pytest.approx(gas.mass[0] / start, rel=2e-2)
    pressure = (gas.pressure - ATMOSPHERE) / (MU * THICKNESS / RADIUS)
    k = int(np.argmax(pressure))
    assert k < len(pressure) - 1
    top = np.polyfit(gas.volume[k - 1 : k + 2], pressure[k - 1 : k + 2], 2)
    found = np.polyval(top, -top[1] / (2 * top[0]))
    # Bending of the wall, h/R = 1e-2, and cubic lines for circles: the fourth digit.
    source = "closed form, maximum found numerically"
    assert record("closed tube, limit pressure", found, 0.749868, 1e-3, "mu h/R", source=source)
    end = result.positions(wall)[k].reshape(-1, 2, 3)[:, 1]
    assert record("closed tube, stretch along it there", end[0, 2] / RADIUS, 1.17819, 1e-2, source=source)


def test_long_tube_between_planes(record):
    """Plane strain between planes of symmetry: p R/(mu h) = 1 - l^-4; the volume counts all that is there."""

    def tube(u, v):
        return RADIUS * np.cos(u), RADIUS * np.sin(u), v

    model = pl.Model()
    mesh = pl.Mesh.surface(tube, (0, np.pi / 2), (0.3, 0.5), divisions=(4, 1))
    wall = model.add_shell(mesh, thickness=THICKNESS, material=rubber(None))
    model.symmetry(wall.edge("u_min"), (0, 1, 0))
    model.symmetry(wall.edge("u_max"), (1, 0, 0))
    for edge in ("v_min", "v_max"):
        model.symmetry(wall.edge(edge), (0, 0, 1))
    air = pl.Gas()
    chamber = model.add_chamber(wall, air, inflow=air.density * np.pi / 4 * RADIUS**2 * 0.2)
    result = pl.solve_static(model, load_steps=4)
    gas = result.chamber(chamber)
    # A straight side and a rim of cubics: the circle's area to 1e-4.
    stretch = np.sqrt(gas.volume[-1] / (np.pi / 4 * RADIUS**2 * 0.2))
    found = (gas.pressure[-1] - ATMOSPHERE) / (MU * THICKNESS / RADIUS)
    assert record("long tube, pressure by mass", found, 1 - stretch**-4, 5e-4, "mu h/R", source="closed form")
    assert result.positions(wall)[-1, 0, 0] / RADIUS == pytest.approx(stretch, rel=2e-4)


@pytest.mark.parametrize(
    ("n", "wrinkling", "name"),
    [(8, 1e-3, "height"), pytest.param(32, 1e-4, "height, finer", marks=pytest.mark.slow)],
)
def test_cushion_from_flat(n, wrinkling, name, record):
    """The square airbag inflated from flat; what is published is that of a tension field."""
    model, sheet = cushion(n, wrinkling)
    model.add_pressure(sheet, 5000.0)
    height = float(pl.solve_static(model).positions(sheet)[-1, 0, 2])
    source = "Contri & Schrefler, Kang & Im: 0.216 to 0.217 m"
    # Values in print scatter by half a percent; a residual stiffness of 1e-3 lowers it by as much.
    assert record(f"cushion, {name}", height, 0.2165, 2.5e-3, "m", source=source)


def filled_cushion(n):
    """The same by the mass of gas at 5 kPa in 0.1249 m^3: volume and pressure are found."""
    model, sheet = cushion(n, 1e-3)
    air = pl.Gas()
    volume = 0.1249 / 8
    chamber = model.add_chamber(sheet, air, inflow=(ATMOSPHERE + 5000.0) / ATMOSPHERE * air.density * volume)
    result = pl.solve_static(model)
    return result.chamber(chamber), result.positions(sheet)[-1], result.strain(sheet).regime[-1]


def test_gas_presses_as_a_pressure_does():
    gas, filled, regime = filled_cushion(8)
    assert (regime == 1).sum() > len(regime) / 2, "most of it wrinkles"
    model, sheet = cushion(8, 1e-3)
    model.add_pressure(sheet, gas.pressure[-1] - ATMOSPHERE)
    pressed = pl.solve_static(model).positions(sheet)[-1]
    # The same equilibrium, to Newton's tolerance; where the film is slack it is soft.
    assert np.abs(pressed[0] - filled[0]).max() < 1e-8
    # A film that carries compression takes another shape.
    model, sheet = cushion(8, False)
    model.add_pressure(sheet, 5000.0)
    assert pl.solve_static(model).positions(sheet)[-1, 0, 2] < 0.205


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_bubble_that_oscillates(exponent, record):
    """A balloon that breathes, against its equation of motion rho h R^2 r'' = (p - p_a) r^2 - h R W'(r/R)."""
    speed, duration = 3.0, 8e-3
    model, skin = balloon(4, RADIUS, THICKNESS, rubber(None), velocity=lambda x: speed * x / RADIUS)
    chamber = model.add_chamber(skin, pl.Gas(exponent=exponent))
    result = pl.simulate(model, duration=duration, step=2e-5, spectral_radius=0.9)

    def rates(t, y):
        stretch = y[0] / RADIUS
        pressure = ATMOSPHERE * (stretch ** (-3 * exponent) - 1)
        wall = THICKNESS * RADIUS * 2 * MU * (stretch - stretch**-5)
        return [y[1], (pressure * y[0] ** 2 - wall) / (1000.0 * THICKNESS * RADIUS**2)]

    exact = solve_ivp(rates, (0, duration), [RADIUS, speed], rtol=1e-10, atol=1e-12, dense_output=True)
    radius = np.linalg.norm(result.positions(skin), axis=2).mean(axis=1)
    amplitude = np.ptp(exact.sol(result.time)[0]) / 2

    def period(r):
        middle = r - RADIUS
        down = np.flatnonzero((middle[:-1] > 0) & (middle[1:] <= 0))
        crossings = result.time[down] + middle[down] / (middle[down] - middle[down + 1]) * 2e-5
        return np.diff(crossings).mean()

    kind = "isothermal" if exponent == 1.0 else "adiabatic"
    # A sphere of flat faces: its mass and its volume are a percent too small, their ratio half of that.
    found, expected = period(radius), period(exact.sol(result.time)[0])
    assert record(f"bubble ({kind}), period", found, expected, 1e-2 * expected, "s", source="solve_ivp")
    assert np.ptp(radius) / 2 == pytest.approx(amplitude, rel=2e-2)
    gas, energy = result.chamber(chamber), result.energy
    law = gas.pressure * gas.volume**exponent
    # Newton's tolerance on the volume.
    assert np.ptp(law) < 1e-7 * law[0]
    assert np.abs(energy.work).max() == 0.0
    # Second order in time, three hundred steps a period.
    assert np.ptp(energy.total) < 3e-5 * np.ptp(energy.kinetic)
    cooled = gas.temperature / 293.15 - 1
    # p V^gamma and p V/T: T V^(gamma - 1).
    assert np.allclose(cooled, (gas.volume / gas.volume[0]) ** (1 - exponent) - 1, atol=1e-7)


def test_free_balloon_keeps_its_momentum():
    """A whole balloon, thrown and spun while gas flows in: nothing from outside but the work of the pump."""
    drift = []
    for step in (2e-4, 1e-4):
        model = pl.Model()
        skin = model.add_membrane(
            ball(2, RADIUS, whole=True),
            thickness=THICKNESS,
            material=rubber(None),
            wrinkling=False,
            velocity=(1.0, 2.0, -0.5),
            angular_velocity=(3.0, -2.0, 5.0),
        )
        start = pl.Gas().density * 4 / 3 * np.pi * RADIUS**3
        chamber = model.add_chamber(skin, inflow=lambda t, m=start: 200 * m * np.sin(np.pi * t / 0.02) ** 2)
        result = pl.simulate(model, duration=0.02, step=step, spectral_radius=0.9)
        gas, energy = result.chamber(chamber), result.energy
        assert gas.mass[-1] / gas.mass[0] == pytest.approx(1 + 2.0 * start / gas.mass[0], rel=1e-9)
        momentum = result.momentum
        # A closed surface feels no force: rounding, and what Newton's tolerance leaves.
        assert np.abs(momentum - momentum[0]).max() < 1e-9 * np.linalg.norm(momentum[0])
        spin = result.angular_momentum
        drift.append(
            [np.abs(spin - spin[0]).max() / np.linalg.norm(spin[0]), np.ptp(energy.total) / energy.work[-1]]
        )
        assert energy.work[-1] > 1.0
    # Second order in time.
    for coarse, fine in np.array(drift).T:
        assert fine < 2e-3
        assert coarse / fine > 3.0


def test_two_sheets_make_a_pillow():
    """Faces of two bodies, welded at their rims, from flat; one with the wrong normals is refused."""
    film = pl.SaintVenantKirchhoff(youngs_modulus=1e8, poisson_ratio=0.3, density=1000.0)
    mesh = pl.Mesh.rectangle(0.4, 0.4, divisions=(6, 6))
    under = pl.Mesh(mesh.points, mesh.quads[:, ::-1])
    air = pl.Gas()
    found = []
    for lower in (under, mesh):
        model = pl.Model()
        top = model.add_membrane(mesh, thickness=1e-4, material=film)
        bottom = model.add_membrane(lower, thickness=1e-4, material=film)
        rim = [(0, 0, 0), (0.4, 0, 0), (0.4, 0.4, 0), (0, 0.4, 0)]
        pairs = list(zip(rim, rim[1:] + rim[:1], strict=True))
        if lower is mesh:
            with pytest.raises(pl.ModelError, match="normals"):
                model.add_chamber([top, bottom])
            continue
        chamber = model.add_chamber([top, bottom], air, inflow=air.density * 1.35e-2)
        with pytest.raises(pl.ModelError, match="nothing joins them"):
            pl.solve_static(model)
        for pair in pairs:
            model.weld(top.edge(pair), bottom.edge(pair))
        middle = (model.pin(top.node(24), directions=axis) for axis in np.eye(3)[:2])
        assert len(list(middle)) == 2
        model.pin(top.node(0), directions=(0, 0, 1))
        model.pin(top.node(6), directions=(0, 0, 1))
        model.pin(top.node(42), directions=(0, 0, 1))
        model.pin(top.node(48), directions=(1, -1, 0))
        result = pl.solve_static(model)
        gas = result.chamber(chamber)
        assert gas.volume[-1] == pytest.approx(1.35e-2 * ATMOSPHERE / gas.pressure[-1], rel=1e-9)
        x, y = result.positions(top)[-1], result.positions(bottom)[-1]
        # The same above and below.
        assert np.allclose(x[24, 2] - x[0, 2], x[0, 2] - y[24, 2], rtol=1e-6)
        found.append(gas.pressure[-1] - ATMOSPHERE)
    assert 100.0 < found[0] < 1e5


def test_what_the_planes_of_symmetry_carry(record):
    """Half a balloon pulls at its plane of symmetry as the pressure on its disc does."""
    model, skin = balloon(4, RADIUS, THICKNESS, rubber(None))
    air = pl.Gas()
    chamber = model.add_chamber(skin, air, inflow=air.density * np.pi / 6 * RADIUS**3)
    planes = list(model.joints)
    result = pl.solve_static(model)
    pressure = result.chamber(chamber).pressure[-1] - ATMOSPHERE
    points = result.positions(skin)[-1]
    for k, plane in enumerate(planes):
        rim = points[np.abs(skin_start(skin, model)[:, k]) < 1e-9][:, [(k + 1) % 3, (k + 2) % 3]]
        rim = rim[np.argsort(np.arctan2(rim[:, 1], rim[:, 0]))]
        area = 0.5 * np.abs(np.sum(rim[:-1, 0] * rim[1:, 1] - rim[1:, 0] * rim[:-1, 1]))
        force = result.reaction(plane).force[-1, k]
        # Equilibrium of the octant: rounding.
        assert record(
            f"balloon, force on its plane {'xyz'[k]}", -force, pressure * area, 1e-6, "N", source="statics"
        )


def skin_start(skin: pl.Membrane, model: pl.Model) -> np.ndarray:
    """Positions of its nodes at the start."""
    return pl.Stepper(model, step=1e-6).positions(skin)


def test_a_run_goes_on_with_its_gas(tmp_path):
    """Gas stays in the chamber from statics to a run, through files, and bit for bit through checkpoints."""
    model, skin = balloon(2, RADIUS, THICKNESS, rubber(None))
    air = pl.Gas(exponent=1.4)
    start = air.density * np.pi / 6 * RADIUS**3
    pump = pl.Input("pump", initial=0.0)
    chamber = model.add_chamber(skin, air, inflow=pump + 0.8 * start * pl.Table([0, 1, 2], [1, 1, 1]))
    still = pl.solve_static(model)
    inflated = still.chamber(chamber)
    empty = pl.Stepper(model, step=1e-4).chamber(chamber)
    assert inflated.mass[-1] == pytest.approx(empty.mass + 0.8 * start, rel=1e-12)
    still.save(tmp_path / "still.h5")
    for begin in (still, pl.Result.load(tmp_path / "still.h5")):
        stepper = pl.Stepper(model, step=1e-4, start=begin)
        now = stepper.chamber(chamber)
        assert now.mass == pytest.approx(inflated.mass[-1], rel=1e-12)
        assert now.pressure == pytest.approx(inflated.pressure[-1], rel=1e-9)
    stepper.set_input("pump", 5 * start)
    stepper.advance(20)
    stepper.save(tmp_path / "run")
    stepper.advance(20)
    other = pl.Stepper.load(tmp_path / "run")
    other.advance(20)
    assert np.array_equal(other.coordinates, stepper.coordinates)
    one, two = stepper.chamber(chamber), other.chamber(chamber)
    assert (one.pressure, one.volume, one.mass) == (two.pressure, two.volume, two.mass)
    # In the first step the input goes from 0 to its value.
    gained = (0.8 * 40 + 5 * 39.5) * 1e-4 * start
    assert one.mass - now.mass == pytest.approx(gained, rel=1e-9)
    document = tmp_path / "model.json"
    model.save(document)
    assert pl.Model.load(document)["chamber1"].name == "chamber1"
    assert "chamber" in str(model)


def test_gas_stiffens_modes(record):
    """Breathing of a linear shell with gas: omega^2 = (2 E/((1 - nu) R^2) + 3 gamma p/(R h))/rho."""
    e, nu, rho, radius, thickness = 1e6, 0.3, 1000.0, 1.0, 1e-3
    film = pl.SaintVenantKirchhoff(youngs_modulus=e, poisson_ratio=nu, density=rho)
    exact = 2 * e / ((1 - nu) * radius**2 * rho)
    gas = 3 * 1.4 * ATMOSPHERE / (radius * thickness * rho)
    for exponent, expected in ((None, exact), (1.4, exact + gas)):
        model = pl.Model()
        skin = model.add_membrane(
            ball(2, radius), thickness=thickness, material=film, wrinkling=False, velocity=lambda x: 1e-4 * x
        )
        for axis in np.eye(3):
            first, second = np.roll(axis, 1), np.roll(axis, 2)
            model.symmetry(skin.edge([first, (first + second) / np.sqrt(2), second]), axis)
        if exponent is not None:
            model.add_chamber(skin, pl.Gas(exponent=exponent))
        modes = pl.solve_modes(model, count=model.dof - model.constraints)
        shapes = modes.positions(skin)
        start = skin_start(skin, model)
        breathing = np.abs(np.einsum("knc,nc->k", shapes, start))
        k = int(np.argmax(breathing))
        name = "shell that breathes" + ("" if exponent is None else ", with gas")
        omega = 2 * np.pi * modes.frequencies[k]
        # Flat faces, two for 45 degrees: two percent of the volume and the area.
        found, expected = float(omega), float(np.sqrt(expected))
        assert record(name, found, expected, 3e-2 * expected, "1/s", source="closed form")


@pytest.mark.parametrize("n", [2, 6])
def test_modes_of_an_inflated_balloon(n):
    """With damping the gas is a border of the matrices, without it an equation: the same modes."""
    found = []
    for damping in (0.0, 1e-7):
        skin_of = pl.NeoHookean(
            youngs_modulus=3 * MU, poisson_ratio=0.5, density=1000.0, retardation_time=damping
        )
        model, skin = balloon(n, RADIUS, THICKNESS, skin_of)
        air = pl.Gas()
        model.add_chamber(skin, inflow=5.0 * air.density * np.pi / 6 * RADIUS**3)
        inflated = pl.solve_static(model, load_steps=2)
        modes = pl.solve_modes(model, count=5, about=inflated)
        # Beyond its limit point: only the enclosed gas holds it.
        assert modes.stable
        found.append(modes.frequencies)
    # The square of damping ratios of 1e-4.
    assert np.allclose(found[0], found[1], rtol=1e-6)


def test_steps_chosen_by_their_error_and_paths_by_arc_length():
    model, skin = balloon(2, RADIUS, THICKNESS, rubber(None), velocity=lambda x: 20 * x)
    model.add_chamber(skin, pl.Gas(exponent=1.4))
    energy = pl.simulate(model, duration=5e-3, step="auto").energy
    assert np.ptp(energy.total) < 1e-3 * np.ptp(energy.kinetic)
    model, skin = balloon(2, RADIUS, THICKNESS, rubber(None))
    chamber = model.add_chamber(skin, inflow=5.0 * pl.Gas().density * np.pi / 6 * RADIUS**3)
    plain, path = pl.solve_static(model), pl.solve_static(model, arc_length=True)
    assert path.load_factor[-1] == 1.0
    # No limit point where the mass is given.
    assert path.critical_points == ()
    ends = [result.chamber(chamber).pressure[-1] for result in (plain, path)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-9)
