"""Membranes: closed forms of Hencky, the balloon, shear, spinning discs."""

from __future__ import annotations

import numpy as np
import pliant as pl


def test_pure_shear_of_a_film(record):
    # E12 = g/2: the tension field carries N11 = N22 = N12 = E h g/4 and stores h E g^2/8.
    e, h, g = 2e9, 1e-5, 0.01
    film = pl.SaintVenantKirchhoff(youngs_modulus=e, poisson_ratio=0.3, density=1400.0)
    for wrinkling, expected in ((0.0, e * h * g**2 / 8), (False, e * h * g**2 / (4 * 1.3))):
        model = pl.Model()
        mesh = pl.Mesh.rectangle(1, 1, divisions=(2, 2))
        # The metric of simple shear without change of the other two strains.
        shear = np.array([[1.0, g], [0.0, np.sqrt(1 - g**2)]])
        places = np.column_stack([mesh.points[:, :2] @ shear.T, np.zeros(len(mesh.points))])
        sheet = model.add_membrane(mesh, thickness=h, material=film, wrinkling=wrinkling, initial=places)
        stepper = pl.Stepper(model, step=1e-9)
        name = "film" if wrinkling is not False else "elastic sheet"
        found = float(stepper.energy.elastic)
        # Constant strain: rounding of strains of one in a hundred.
        assert record(
            f"pure shear of {name}, energy", found, expected, 1e-9 * expected, unit="J", source="closed form"
        )
        assert (stepper.strain(sheet).regime == (1 if name == "film" else 0)).all()


def test_slack_and_taut_films_are_told_apart():
    film = pl.SaintVenantKirchhoff(youngs_modulus=2e9, poisson_ratio=0.3, density=1400.0)
    for factors, regime in (((1.01, 1.01), 0), ((1.01, 0.98), 1), ((0.99, 0.98), 2)):
        model = pl.Model()
        mesh = pl.Mesh.rectangle(1, 1, divisions=(1, 1))
        sheet = model.add_membrane(
            mesh, thickness=1e-5, material=film, initial=mesh.points * np.array([*factors, 1.0])
        )
        assert pl.Stepper(model, step=1e-9).strain(sheet).regime == regime


def test_inflated_tube_of_rubber(record):
    """A quarter of a long tube, incompressible: p R/(mu h) = 1 - C33/l^2 with C33 = l^-2."""
    radius, thickness, mu, stretch = 1.0, 0.01, 1e6, 1.15
    rubber = pl.NeoHookean(youngs_modulus=3 * mu, poisson_ratio=0.5, density=1000.0)
    pressure = mu * thickness / radius * (1 - stretch**-4)

    def tube(u, v):
        return radius * np.cos(u), radius * np.sin(u), v

    model = pl.Model()
    mesh = pl.Mesh.surface(tube, (0, np.pi / 2), (0, 0.5), divisions=(4, 1))
    wall = model.add_shell(mesh, thickness=thickness, material=rubber)
    model.symmetry(wall.edge("u_min"), (0, 1, 0))
    model.symmetry(wall.edge("u_max"), (1, 0, 0))
    for edge in ("v_min", "v_max"):
        model.symmetry(wall.edge(edge), (0, 0, 1))
    model.add_pressure(wall, pressure)
    result = pl.solve_static(model, load_steps=4)
    found = float(result.track(wall.node(0)).position[-1, 0])
    # The stiffness of bending and the cubic line of a quarter circle are felt in the fifth digit.
    assert record("inflated tube, radius", found, stretch * radius, 3e-4, unit="m", source="closed form")


def disc(radius: float, rings: int) -> pl.Mesh:
    """A disc of quadrilaterals, a square in the middle whose sides bulge into circles."""
    x = np.linspace(-1, 1, 2 * rings + 1)
    u, v = np.meshgrid(x, x, indexing="ij")
    largest = np.maximum(abs(u), abs(v))
    round_ = np.hypot(u, v)
    scale = np.where(round_ > 0, largest / np.where(round_ > 0, round_, 1.0), 1.0)
    blend = largest**2
    factor = (1 - blend) * 0.8 + blend * scale
    points = radius * np.stack([u * factor, v * factor, 0 * u], axis=-1).reshape(-1, 3)
    n = 2 * rings + 1
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
    quads = np.stack([i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1], axis=1)
    return pl.Mesh(points, quads)


def test_circular_membrane_under_pressure(record):
    """Hencky's problem in Foeppl's theory: w0 = 0.653443 a (p a/(E h))^(1/3) for nu = 0.3."""
    radius, thickness, e = 1.0, 1e-3, 1e9
    pressure = 1e-5 * e * thickness / radius
    film = pl.SaintVenantKirchhoff(youngs_modulus=e, poisson_ratio=0.3, density=1400.0)
    mesh = disc(radius, 8)
    height = 0.65 * 1e-5 ** (1 / 3)
    bump = mesh.points.copy()
    bump[:, 2] = height * (1 - (bump[:, 0] ** 2 + bump[:, 1] ** 2) / radius**2)
    model = pl.Model()
    sheet = model.add_membrane(mesh, thickness=thickness, material=film, initial=bump)
    model.pin(sheet.edge("rim"))
    model.add_pressure(sheet, pressure)
    result = pl.solve_static(model)
    middle = sheet.at((0, 0, 0))
    found = float(result.track(middle).position[-1, 2])
    expected = 0.6534433449821498 * radius * (pressure * radius / (e * thickness)) ** (1 / 3)
    # Second order: 16 bilinear elements across, corners of the disc cut by 1e-3 of its area.
    assert record("Hencky's membrane, height", found, expected, 1e-2 * expected, unit="m", source="Hencky")


def test_forces_through_a_cut_of_a_swinging_curtain(record):
    """Both sides of a cut pull alike, and by what the part beyond it weighs and accelerates."""
    film = pl.SaintVenantKirchhoff(1e6, 0.3, 1000.0, retardation_time=1e-3)
    mesh = pl.Mesh.rectangle(1.0, 0.5, divisions=(4, 2))
    model = pl.Model(gravity=(0, 0, -9.81))
    sheet = model.add_membrane(mesh, thickness=1e-3, material=film)
    hook = model.pin(sheet.edge("u_min"))
    result = pl.simulate(model, duration=0.1, step=2e-3, output_every=10)
    beyond = np.arange(8) >= 4
    force = result.cut_force(sheet.faces(beyond))
    weight = 0.5 * 9.81
    # What Newton's iteration leaves over.
    other = result.cut_force(sheet.faces(~beyond))
    gap = float(np.abs(force + other).max() / weight)
    assert record("cut of a film, both sides", gap, 0.0, 1e-7, source="third law")
    # All of the film: what its hook carries is the rate of momentum less the weight.
    total = result.momentum_rate + [0.0, 0.0, weight]
    gap = float(np.abs(result.reaction(hook).force - total).max() / weight)
    assert record("film, rate of momentum", gap, 0.0, 1e-7, source="hook and weight")
    assert np.linalg.norm(force[-1]) > 0.05 * weight


# Energy per volume, stress (11, 22, 12): mu = 1.2, lambda = 2.5 at C; E = 2, nu = 0.3 at (E11, E22, 2 E12).
RUBBER = [
    ((1.44, 1, 0), 0.0654044093914, (0.519444444444, 0.22, 0)),
    ((1.2, 0.8, 0.3), 0.0865261121569, (0.0181646881477, -0.572752967778, 0.443188241945)),
    ((4, 4, 0), 2.84702243273, (1.16533018868, 1.16533018868, 0)),
    ((0.5, 2, -0.2), 0.324748316464, (-1.35208333333, 0.561979166667, -0.255208333333)),
]
FILM = [
    ((0.01, 0.004, 0.002), 0.000155384615385, (0.0246153846154, 0.0153846153846, 0.00153846153846)),
    ((0.01, -0.002, 0), 0.000101098901099, (0.0206593406593, 0.0021978021978, 0)),
    ((0.01, -0.02, 0), 0.0001, (0.02, 0, 0)),
    ((0, 0, 0.02), 0.0001, (0.01, 0.01, 0.01)),
    ((-0.01, -0.02, 0.001), 0, (0, 0, 0)),
    ((0.004, -0.01, 0.012), 3.86827332562e-05, (0.0109417746502, 0.00149731426439, 0.00404762587963)),
]


def energy_density(strain: np.ndarray, material: pl.NeoHookean | pl.SaintVenantKirchhoff) -> float:
    """Energy for each volume of a film of one face under a Green strain (11, 22, 12)."""
    metric = np.eye(2) + 2 * np.array([[strain[0], strain[2]], [strain[2], strain[1]]])
    values, axes = np.linalg.eigh(metric)
    stretch = axes * np.sqrt(values) @ axes.T
    mesh = pl.Mesh.rectangle(1, 1, divisions=(1, 1))
    places = np.column_stack([mesh.points[:, :2] @ stretch.T, np.zeros(4)])
    model, film = pl.Model(), isinstance(material, pl.SaintVenantKirchhoff)
    wrinkling = 0.0 if film else False
    model.add_membrane(mesh, thickness=1.0, material=material, wrinkling=wrinkling, initial=places)
    return float(pl.Stepper(model, step=1e-9).energy.elastic)


def test_laws_at_points_of_strain(record):
    """The reference found C33 and the relaxed energy by brute minimisation."""
    mu, lame = 1.2, 2.5
    youngs, nu = mu * (3 * lame + 2 * mu) / (lame + mu), lame / (2 * (lame + mu))
    rubber = pl.NeoHookean(youngs_modulus=youngs, poisson_ratio=nu, density=1.0)
    film = pl.SaintVenantKirchhoff(youngs_modulus=2.0, poisson_ratio=0.3, density=1.0)
    cases = [("rubber", rubber, 0.5 * (np.array(c) - [1, 1, 0]), w, s) for c, w, s in RUBBER]
    cases += [("film", film, np.array(e) * [1, 1, 0.5], w, s) for e, w, s in FILM]
    for k, (name, material, strain, energy, stress) in enumerate(cases):
        found = energy_density(strain, material)
        title = f"{name} at strain {k}"
        source = "independent prototype"
        # Twelve digits are given.
        assert record(f"{title}, energy", found, energy, 1e-11, source=source)
        h, slopes = 1e-5, []
        for axis in np.eye(3):
            # A shear counts twice in the energy.
            up, down = (energy_density(strain + sign * h * axis, material) for sign in (1, -1))
            slopes.append((up - down) / (2 * h) * (0.5 if axis[2] else 1.0))
        # Differences: h^2 of third derivatives of order 100, rounding over h; a kink counts with h.
        assert record(f"{title}, stress", slopes, stress, 2e-5, source=source)
