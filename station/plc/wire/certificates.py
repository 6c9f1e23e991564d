"""Certificates for trials of Modbus/TCP Security; the only file that imports cryptography.

An authority signs a certificate for the server and one for the client; a plant uses its own authority.
The client's certificate carries its role (Modbus/TCP Security, 8.4).
"""

import os
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path

from station.errors import SettingsError
from station.plc.wire.role import ROLE_OID

ROLE = "Operator"
"""Role in the client's certificate."""


def make_certificates(folder: Path, host: str, days: int) -> list[Path]:
    """Write certificates and keys as PEM files and return their paths. Raises SettingsError.

    `host`: name or address of the server; `days`: validity. Existing files are never overwritten.
    """
    try:
        from cryptography import x509
        from cryptography.hazmat.primitives import hashes, serialization
        from cryptography.hazmat.primitives.asymmetric import ec
        from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID
    except ImportError:
        raise SettingsError(
            "making certificates needs the package cryptography: pip install 'weldgate[tls]'"
        ) from None
    if not 1 <= days <= 3650:
        raise SettingsError(f"--days is {days}; use 1 to 3650")
    paths = [folder / name for name in ("ca.pem", "server.pem", "server.key", "client.pem", "client.key")]
    existing = [path for path in paths if path.exists()]
    if existing:
        raise SettingsError(f"{existing[0]}: file exists already; name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    now = datetime.now(UTC)

    def name(text: str) -> x509.Name:
        return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])

    def certificate(
        subject: str,
        key: ec.EllipticCurvePrivateKey,
        signer: ec.EllipticCurvePrivateKey,
        extensions: list[x509.ExtensionType],
    ) -> bytes:
        builder = x509.CertificateBuilder(
            name("weldgate trial authority"), name(subject), key.public_key(), x509.random_serial_number()
        )
        builder = builder.not_valid_before(now - timedelta(minutes=5)).not_valid_after(
            now + timedelta(days=days)
        )
        for extension in (*extensions, x509.SubjectKeyIdentifier.from_public_key(key.public_key())):
            builder = builder.add_extension(extension, critical=isinstance(extension, x509.BasicConstraints))
        builder = builder.add_extension(
            x509.AuthorityKeyIdentifier.from_issuer_public_key(signer.public_key()), critical=False
        )
        return builder.sign(signer, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)

    authority, server, client = (ec.generate_private_key(ec.SECP256R1()) for _ in range(3))
    try:
        where: x509.GeneralName = x509.IPAddress(ip_address(host))
    except ValueError:
        where = x509.DNSName(host)
    named = x509.SubjectAlternativeName([where])
    role = x509.UnrecognizedExtension(
        x509.ObjectIdentifier(ROLE_OID), bytes([0x0C, len(ROLE)]) + ROLE.encode()
    )
    no_authority = x509.BasicConstraints(ca=False, path_length=None)
    serves, asks = (
        x509.ExtendedKeyUsage([use])
        for use in (ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH)
    )
    issued = [
        certificate(
            "weldgate trial authority", authority, authority, [x509.BasicConstraints(ca=True, path_length=0)]
        ),
        certificate(
            "weldgate station",
            server,
            authority,
            [no_authority, serves, named],
        ),
        certificate("weldgate PLC", client, authority, [no_authority, asks, role]),
    ]
    secrets = [
        key.private_bytes(
            serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
        )
        for key in (server, client)
    ]
    for path, data in zip(paths, (issued[0], issued[1], secrets[0], issued[2], secrets[1]), strict=True):
        mode = 0o600 if path.suffix == ".key" else 0o644
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
            file.write(data)
    return paths
