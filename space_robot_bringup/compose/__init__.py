"""An experiment put together: plants, controllers, references, parameters."""
