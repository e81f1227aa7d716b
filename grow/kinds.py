"""Names of the plants that can be grown."""

KINDS = ("maize", "tomato", "tree", "tree1", "tree2")
