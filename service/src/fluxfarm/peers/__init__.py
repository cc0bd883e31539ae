"""Other renderers on scenes of ours. The `_peer` scripts run in Pythons that have those, as processes of their own, and
import nothing of this package; what they and their callers agree on is in `running.py`."""
