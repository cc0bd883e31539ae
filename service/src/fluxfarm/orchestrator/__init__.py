"""Turns accepted jobs into leases, and what comes back into revisions."""

from fluxfarm.orchestrator.orchestrator import Orchestrator

__all__ = ["Orchestrator"]
