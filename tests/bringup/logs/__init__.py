"""What a log says about itself."""
