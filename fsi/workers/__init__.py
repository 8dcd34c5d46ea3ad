"""Who does the runs of a study: processes on this machine, or the workers of a Dask cluster."""
