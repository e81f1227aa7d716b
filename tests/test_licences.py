"""The project is under MIT: nothing that it imports may be under the GPL."""

import re

import pytest

from tests.licences import installed, licence

# Of a library that is used as it is, and may be exchanged, the LGPL asks for no more.
LESSER = re.compile(r"LGPL|Lesser General Public", re.IGNORECASE)
COPYLEFT = re.compile(r"GPL|General Public", re.IGNORECASE)


@pytest.mark.parametrize("extras", [(), ("e57",), ("pandas", "usd", "cluster")], ids=str)
def test_no_package_of_the_runtime_is_under_the_gpl(extras):
    packages = installed(extras)
    assert {"numpy", "open3d-cpu", "open3d"} & {*packages}
    found = {name: licence(package) for name, package in packages.items()}
    bad = {n: text for n, text in found.items() if COPYLEFT.search(LESSER.sub("", text))}
    assert not bad


def test_a_package_under_the_gpl_is_seen():
    packages = installed(("test",))
    assert COPYLEFT.search(licence(packages["plyfile"]))
