"""Run bakes of one plant or many, in worker processes or on a cluster, with a cache.

`command` bakes one plant, or the plants that `plants` finds. `bake_all` distributes many plants
over the worker processes of `parallel` or over a `cluster`; each of them runs `plant`.
"""
