"""Contexts for Modbus/TCP Security: TLS 1.2 or newer, both sides show a certificate of the same trust."""

import ssl

from station.errors import SettingsError
from station.settings.model import TlsSettings

Tls = ssl.SSLContext | None
"""Context of a connection, or None for plain TCP."""


def server_context(settings: TlsSettings) -> ssl.SSLContext:
    """For the side that listens; peers without a trusted certificate are refused. Raises SettingsError."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.verify_mode = ssl.CERT_REQUIRED
    return _loaded(context, settings)


def client_context(settings: TlsSettings) -> ssl.SSLContext:
    """For the side that connects; the server's certificate must be trusted and name its host. Raises SettingsError."""
    return _loaded(ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT), settings)


def _loaded(context: ssl.SSLContext, settings: TlsSettings) -> ssl.SSLContext:
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    for path in (settings.certificate_path, settings.key_path, settings.ca_path):
        if not path.is_file():
            raise SettingsError(
                f"{path}: no such file; name PEM files under [plc.tls], or make some with weldgate certificates"
            )
    try:
        context.load_cert_chain(settings.certificate_path, settings.key_path)
        context.load_verify_locations(settings.ca_path)
    except (ssl.SSLError, OSError) as error:
        raise SettingsError(
            f"{settings.certificate_path} and the files beside it: no usable certificates ({error})"
        ) from None
    return context
