"""What surface a point stands for: on sheets the square of its reach, on thin twigs far less."""

import numpy as np
import pytest

from baker.geometry.spacing import Surroundings, reaches


def surface(points):
    found = Surroundings.of(points, surface=True).surface
    assert found is not None
    return found


def sheet(count, seed=0):
    rng = np.random.default_rng(seed)
    return np.c_[rng.uniform(0, 1, (count, 2)), np.zeros(count)]


def twig(count, radius, seed=0):
    """The skin of a rod one long."""
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0, 2 * np.pi, count)
    return np.c_[rng.uniform(0, 1, count), radius * np.cos(turn), radius * np.sin(turn)]


def test_on_a_sheet_it_is_the_square_of_the_reach():
    points = sheet(2000)
    square = reaches(points, 8) ** 2
    assert np.isclose(surface(points), square).mean() > 0.6
    assert (surface(points) <= square * (1 + 1e-9)).all()


@pytest.mark.parametrize("radius", [0.002, 0.004])
def test_a_twig_thinner_than_its_spacing_has_less_the_thinner_it_is(radius):
    thin, half = (np.median(surface(twig(100, r))) for r in (radius, radius / 2))
    assert half == pytest.approx(thin / 2, rel=0.2)
    assert thin < 0.5 * np.median(reaches(twig(100, radius), 8)) ** 2


def test_it_grows_with_the_square_of_the_unit():
    points = np.concatenate([sheet(300), np.add(twig(60, 0.003), [0, 0, 1])])
    np.testing.assert_allclose(surface(1000 * points), 1e6 * surface(points), rtol=1e-6)


def test_order_does_not_matter():
    points = np.concatenate([sheet(300), np.add(twig(60, 0.003), [0, 0, 1])])
    order = np.random.default_rng(1).permutation(len(points))
    np.testing.assert_allclose(surface(points[order]), surface(points)[order], rtol=1e-9)


def test_surroundings_are_the_same_whether_surfaces_are_asked_or_not():
    points = sheet(500)
    one, two = Surroundings.of(points), Surroundings.of(points, surface=True)
    assert one.spacing == two.spacing
    np.testing.assert_array_equal(one.reach, two.reach)
    assert one.surface is None


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_points_have_some_surface(count):
    assert np.isfinite(surface(np.eye(3)[:count])).all()
