"""A laboratory's certificate authority: it signs who is who, and nothing else is believed.

X.509 v3 (RFC 5280) with keys on the curve P-256, which a board signs with in milliseconds.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric.ec import (
    SECP256R1,
    EllipticCurvePrivateKey,
    generate_private_key,
)
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from swarm.access.identities import SERVER, Identity

VALID = timedelta(days=3 * 365)
"""Longer than a project between two looks at its keys; who is lost is shut out by the rules at once."""
FROM = datetime(1970, 1, 1, tzinfo=UTC)
"""A board without a battery for its clock wakes in 1970, and must reach the server to learn the time."""
SERIAL_BITS = 64
"""What RFC 5280's readers expect at least of random numbers."""


@dataclass(frozen=True)
class Signed:
    """A certificate and its private key, as PEM."""

    certificate: bytes
    key: bytes


class Authority:
    """Signs certificates for a laboratory's identities."""

    def __init__(self, signed: Signed) -> None:
        key = serialization.load_pem_private_key(signed.key, password=None)
        assert isinstance(key, EllipticCurvePrivateKey)
        self._key = key
        self._certificate = x509.load_pem_x509_certificate(signed.certificate)

    @staticmethod
    def new(laboratory: str, now: datetime) -> Signed:
        """The certificate and key of a new authority."""
        key = generate_private_key(SECP256R1())
        name = _named(f"laboratory {laboratory} {secrets.token_hex(4)}")
        builder = _builder(name, name, key, now).add_extension(x509.BasicConstraints(True, 0), critical=True)
        return _signed(builder, key, key)

    def sign(self, identity: Identity, hosts: Iterable[str], now: datetime) -> Signed:
        """A new certificate with a new key. Its common name is the identity and a number of its own.

        Only the server's may be shown by who is connected to, and only under these hosts.
        """
        key = generate_private_key(SECP256R1())
        number = secrets.token_hex(SERIAL_BITS // 8)
        builder = _builder(_named(f"{identity}.{number}"), self._certificate.subject, key, now)
        builder = builder.add_extension(x509.BasicConstraints(False, None), critical=True)
        uses = [ExtendedKeyUsageOID.CLIENT_AUTH]
        if identity == SERVER:
            uses.append(ExtendedKeyUsageOID.SERVER_AUTH)
            names = x509.SubjectAlternativeName([_host(host) for host in hosts])
            builder = builder.add_extension(names, critical=False)
        builder = builder.add_extension(x509.ExtendedKeyUsage(uses), critical=False)
        return _signed(builder, key, self._key)


def common_name(certificate: bytes) -> str:
    """Whom a certificate is of, with the number that tells it from others of the same."""
    subject = x509.load_pem_x509_certificate(certificate).subject
    return str(subject.get_attributes_for_oid(NameOID.COMMON_NAME)[0].value)


def valid_until(certificate: bytes) -> datetime:
    """When a certificate ends."""
    return x509.load_pem_x509_certificate(certificate).not_valid_after_utc


def hosts_of(certificate: bytes) -> Sequence[str]:
    """The hosts under which a server's certificate may be shown."""
    extensions = x509.load_pem_x509_certificate(certificate).extensions
    names = extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    return [str(name.value) for name in names]


def _builder(
    subject: x509.Name, issuer: x509.Name, key: EllipticCurvePrivateKey, now: datetime
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(FROM)
        .not_valid_after(now + VALID)
    )


def _signed(
    builder: x509.CertificateBuilder, key: EllipticCurvePrivateKey, signing: EllipticCurvePrivateKey
) -> Signed:
    certificate = builder.sign(signing, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)
    private = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    return Signed(certificate, private)


def _named(text: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])


def _host(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ip_address(host))
    except ValueError:
        return x509.DNSName(host)
