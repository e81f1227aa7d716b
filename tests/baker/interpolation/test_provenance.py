"""What a clip says of the software that made it."""

from pathlib import Path

from baker.interpolation.provenance import software


def test_open3d_is_named_where_its_numbers_are_in_the_clip() -> None:
    usual = {"numpy", "scipy", "numba"}
    assert set(software()["packages"]) == usual
    assert set(software([Path("a.ply"), Path("b.xyz")])["packages"]) == usual
    assert set(software([Path("a.ply"), Path("b.obj.gz")])["packages"]) == {*usual, "open3d"}
    assert set(software([Path("a.ply")], outliers=2.0)["packages"]) == {*usual, "open3d"}
