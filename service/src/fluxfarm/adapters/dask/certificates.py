"""Makes the certificates of a farm: an authority of its own, and one certificate for every machine that joins."""

import datetime
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from fluxfarm.adapters.dask.security import FILES
from fluxfarm.adapters.data_folder import write_secret
from fluxfarm.errors import BadSetting

YEARS = 10
AUTHORITY_KEY = "ca.key"


def make_certificates(folder: Path) -> list[Path]:
    """Write an authority and a certificate with its key, unless they are there; returns the files that are new.

    Whoever has the node's files may join the farm; the authority's key makes more of them and is not needed to run.
    Raises BadSetting where only some are there: new ones would not fit those of other machines."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / name for name in (FILES["ca"], AUTHORITY_KEY, FILES["certificate"], FILES["key"])]
    here = [path.name for path in files if path.exists()]
    if {*here, AUTHORITY_KEY} == {path.name for path in files}:
        return []
    if here:
        raise BadSetting(
            f"{folder}: has {', '.join(here)} and not the rest; take an empty folder, or copy the others here"
        )
    authority_key, node_key = ec.generate_private_key(ec.SECP256R1()), ec.generate_private_key(ec.SECP256R1())
    authority = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "Fluxfarm authority")])
    node = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "Fluxfarm node")])
    ca = _builder(authority, authority, authority_key.public_key())
    ca = ca.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    names = x509.SubjectAlternativeName([x509.DNSName("localhost"), x509.DNSName("fluxfarm")])
    certificate = _builder(node, authority, node_key.public_key()).add_extension(names, critical=False)
    contents = [
        ca.sign(authority_key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM),
        _pem(authority_key),
        certificate.sign(authority_key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM),
        _pem(node_key),
    ]
    for path, content in zip(files, contents, strict=True):
        write_secret(path, content.decode())
    return files


def _builder(subject: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePublicKey) -> x509.CertificateBuilder:
    now = datetime.datetime.now(datetime.UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - datetime.timedelta(days=1))
        .not_valid_after(now + datetime.timedelta(days=365 * YEARS))
    )


def _pem(key: ec.EllipticCurvePrivateKey) -> bytes:
    return key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
