"""A log in the browser; the only importer of viser."""
