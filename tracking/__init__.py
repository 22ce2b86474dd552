"""What is remembered: events of a run, and the recorders that keep them.

The noun of this package is the ``Event``. Whoever runs the islands tells a ``Recorder`` what
happens; recorders write it down (``journal``, the source of truth), send it to MLflow
(``mlflow_recorder``) or show it (``progress``). Nothing here knows islands or meshes.
"""
