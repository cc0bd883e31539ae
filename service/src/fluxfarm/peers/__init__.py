"""Other renderers on scenes of ours. The `_peer` scripts run in Pythons that have those, as processes of their own, and
import nothing of this package; what they and their callers agree on is in `running.py`."""

# Each peer is measured where a variable of the environment names a Python that has it.
PYTHONS = {"mitsuba": "PEER_PYTHON", "cycles": "CYCLES_PYTHON", "luxcore": "LUXCORE_PYTHON"}
