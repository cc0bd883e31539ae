"""Who may join: between machines holders of a certificate of the farm alone, as a Dask worker runs what it is sent."""

import ipaddress
from pathlib import Path
from urllib.parse import urlsplit

from distributed.security import Security

from fluxfarm.errors import BadSetting

FILES = {"ca": "ca.pem", "certificate": "node.pem", "key": "node.key"}


def security(address: str, folder: Path | None) -> Security | None:
    """The security for a scheduler's address; None on the loopback without TLS. Raises BadSetting for anything else
    without TLS, and for certificates that are not there."""
    parts = urlsplit(address)
    if parts.scheme not in ("tcp", "tls") or parts.hostname is None or parts.port is None:
        raise BadSetting(f"FLUXFARM_SCHEDULER = {address!r}: expected tls://HOST:PORT")
    if parts.scheme == "tcp":
        if not _on_loopback(parts.hostname):
            raise BadSetting(
                f"FLUXFARM_SCHEDULER = {address!r}: expected tls://, as whoever joins a farm can run programs on it; "
                "`fluxfarm certificates` makes what is needed"
            )
        return None
    if folder is None:
        raise BadSetting(f"FLUXFARM_SCHEDULER = {address!r}: needs FLUXFARM_CERTIFICATES, a folder of certificates")
    paths = {name: folder / file for name, file in FILES.items()}
    for path in paths.values():
        if not path.is_file():
            raise BadSetting(f"FLUXFARM_CERTIFICATES = {folder}: there is no {path.name}; see `fluxfarm certificates`")
    files = {"tls_ca_file": paths["ca"], "require_encryption": True}
    for role in ("scheduler", "worker", "client"):
        files[f"tls_{role}_cert"], files[f"tls_{role}_key"] = paths["certificate"], paths["key"]
    return Security(**{name: str(value) if isinstance(value, Path) else value for name, value in files.items()})  # type: ignore[no-untyped-call]


def _on_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
