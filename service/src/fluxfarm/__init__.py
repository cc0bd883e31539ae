"""Fluxfarm: scene jobs in, OpenEXR images with their error out."""

__version__ = "0.1.0"
