"""A run in the browser, live from a log; the only importer of viser."""
