"""What a clip says of the software that made it."""

from baker.interpolation.provenance import software


def test_the_packages_that_calculate_are_named() -> None:
    assert set(software()["packages"]) == {"numpy", "scipy", "numba", "open3d"}
