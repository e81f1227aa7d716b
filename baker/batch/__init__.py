"""Run bakes of one plant or many, in worker processes or on a cluster, with a cache.

`command` bakes one plant, or the plants that `plants` finds. `bake_all` distributes many plants
over `workers`, which are processes or those of a cluster; each of them runs `plant`.
"""
