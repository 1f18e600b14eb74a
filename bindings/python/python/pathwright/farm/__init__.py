"""Slices and compares whole catalogues of models, on this machine or on a cluster of Dask: ``python -m pathwright.farm --help``.

Needs ``pip install pathwright[farm]``. See ``docs/farm.md`` of the project.
"""
