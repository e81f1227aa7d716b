"""The commands' work around the pipeline: one plant or many, worker processes, clusters, caches.

`command` chooses: `plant` bakes one plant and writes what is wanted. `plants` finds many, `job`
bakes one of them in a worker, `bake_all` shares them out among the processes of `parallel` or the
workers of `cluster`.
"""
