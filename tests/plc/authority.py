"""An authority for tests, which issues certificates as a plant does, and revokes them."""

from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import NameOID

from station.settings.model import TlsSettings


class Authority:
    """Certificates without a use, for 127.0.0.1."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self.folder, self.key = folder, ec.generate_private_key(ec.SECP256R1())
        self.name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "plant")])
        self.path = folder / "ca.pem"
        made = self._builder(self.name, self.key).add_extension(x509.BasicConstraints(True, None), True)
        self.path.write_bytes(made.sign(self.key, hashes.SHA256()).public_bytes(Encoding.PEM))

    def _builder(self, subject: x509.Name, key: ec.EllipticCurvePrivateKey) -> x509.CertificateBuilder:
        now = datetime.now(UTC)
        builder = x509.CertificateBuilder(
            self.name, subject, key.public_key(), x509.random_serial_number()
        ).not_valid_before(now - timedelta(minutes=5))
        return builder.not_valid_after(now + timedelta(days=7))

    def issue(self, name: str) -> TlsSettings:
        """Return settings with a new certificate."""
        key = ec.generate_private_key(ec.SECP256R1())
        subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
        where = x509.SubjectAlternativeName([x509.IPAddress(ip_address("127.0.0.1"))])
        made = self._builder(subject, key).add_extension(where, False).sign(self.key, hashes.SHA256())
        certificate, secret = self.folder / f"{name}.pem", self.folder / f"{name}.key"
        certificate.write_bytes(made.public_bytes(Encoding.PEM))
        secret.write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))
        return TlsSettings(certificate_path=certificate, key_path=secret, ca_path=self.path)

    def revoke(self, *revoked: TlsSettings) -> Path:
        """Return a new revocation list of these certificates."""
        now = datetime.now(UTC)
        builder = x509.CertificateRevocationListBuilder().issuer_name(self.name).last_update(now)
        for settings in revoked:
            serial = x509.load_pem_x509_certificate(settings.certificate_path.read_bytes()).serial_number
            entry = x509.RevokedCertificateBuilder().serial_number(serial).revocation_date(now).build()
            builder = builder.add_revoked_certificate(entry)
        path = self.folder / f"revoked-{len(revoked)}.pem"
        listed = builder.next_update(now + timedelta(days=1)).sign(self.key, hashes.SHA256())
        path.write_bytes(listed.public_bytes(Encoding.PEM))
        return path
