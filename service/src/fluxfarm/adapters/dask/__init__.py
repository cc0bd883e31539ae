"""Workers on other machines, by Dask distributed. Needs the extra `fluxfarm[dask]`."""
