"""Dask's logs, which it sends to handlers of its own when it is imported, in our form: warnings and worse."""

import logging


def send_to_ours() -> None:
    """Let Dask's loggers be as all others."""
    for name in list(logging.Logger.manager.loggerDict):
        if name == "distributed" or name.startswith("distributed."):
            logger = logging.getLogger(name)
            logger.handlers.clear()
            logger.propagate = True
            logger.setLevel(logging.NOTSET)
    logging.getLogger("distributed").setLevel(logging.WARNING)
