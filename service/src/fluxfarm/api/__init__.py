"""The HTTP face of the service: routes, their documents and their problem replies."""
