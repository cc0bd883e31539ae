"""Speed against accuracy: measures methods and other renderers on scenes, and charts error over time."""
