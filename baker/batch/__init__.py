"""The command's work around the pipeline: one plant or many, worker processes, clusters, caches.

`command` bakes one plant, or those that `plants` finds: `bake_all` shares these out among the
processes of `parallel` or the workers of `cluster`, and each bakes by `plant`.
"""
