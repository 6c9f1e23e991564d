"""TLS contexts for Modbus/TCP Security: TLS 1.2 or newer, each side checks the other's certificate."""

import ssl

from station.errors import SettingsError
from station.settings.model import TlsSettings

Tls = ssl.SSLContext | None
"""TLS context of a connection, or None for plain TCP."""


def server_context(settings: TlsSettings) -> ssl.SSLContext:
    """Return the server's context; it refuses peers without a trusted certificate. Raises SettingsError."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.verify_mode = ssl.CERT_REQUIRED
    return _loaded(context, settings)


def client_context(settings: TlsSettings) -> ssl.SSLContext:
    """Return the context for the client. Raises SettingsError.

    The server's certificate must be trusted and name its host.
    """
    return _loaded(ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT), settings)


def _loaded(context: ssl.SSLContext, settings: TlsSettings) -> ssl.SSLContext:
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    for path in (settings.certificate_path, settings.key_path, settings.ca_path):
        if not path.is_file():
            advice = "name PEM files under [plc.tls], or make some with weldgate certificates"
            raise SettingsError(f"{path}: file not found; {advice}")
    try:
        context.load_cert_chain(settings.certificate_path, settings.key_path)
        context.load_verify_locations(settings.ca_path)
    except (ssl.SSLError, OSError) as error:
        raise SettingsError(
            f"{settings.certificate_path}: certificate, key or authority cannot be used ({error});"
            " check the files named under [plc.tls]"
        ) from None
    return context
