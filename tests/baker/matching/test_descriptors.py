"""Where organs are attached, whatever else they touch."""

import numpy as np
import pytest

from baker.matching.descriptors import OrganDescriptors, describe_organs

STEM = np.linspace([0, 0, 0], [0, 0, 20], 200)
LOWER = np.linspace([0, 0, 6], [8, 0, 6], 80)


def arch(height: float, reach: float, tip_height: float) -> np.ndarray:
    """A leaf that rises from the stem and hangs down to its tip."""
    u = np.linspace(0, 1, 200)[:, None]
    start, middle, end = [0, 0, height], [reach / 2, 0, height + 6], [reach, 0, tip_height]
    return (1 - u) ** 2 * start + 2 * u * (1 - u) * middle + u**2 * end


def described(*organs: np.ndarray) -> OrganDescriptors:
    labels = np.repeat(np.arange(len(organs)), [*map(len, organs)])
    return describe_organs(np.concatenate(organs), labels, 0)


@pytest.mark.parametrize("tip_height", [6.02, 6.2, 8.0])
def test_a_leaf_is_attached_at_its_base_although_its_tip_touches_another(tip_height):
    organs = described(STEM, LOWER, arch(12, 7, tip_height))
    np.testing.assert_allclose(organs.attachments, [[0, 0, 0], [0, 0, 6], [0, 0, 12]], atol=0.8)
    np.testing.assert_allclose(organs.order, [0, 0, 1], atol=0.1)


def test_what_grows_from_a_leaf_is_attached_to_it():
    leaflet = np.linspace([4, 0.1, 6], [4, 3, 6], 40)
    organs = described(STEM, LOWER, leaflet)
    np.testing.assert_allclose(organs.attachments[2], [4, 0.1, 6], atol=0.2)


def test_organs_are_described_in_the_order_of_their_labels():
    cloud, labels = np.concatenate([LOWER, STEM]), np.repeat([7, 3], [len(LOWER), len(STEM)])
    organs = describe_organs(cloud, labels, len(LOWER))
    np.testing.assert_allclose(organs.attachments, [[0, 0, 0], [0, 0, 6]], atol=0.2)
    assert organs.sizes[0] > 2 * organs.sizes[1]


def test_an_organ_that_touches_nothing_is_attached_across_the_gap():
    organs = described(STEM, np.add(LOWER, [3, 0, 0]))
    np.testing.assert_allclose(organs.attachments[1], [3, 0, 6], atol=0.2)
