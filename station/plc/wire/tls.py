"""TLS contexts for Modbus/TCP Security: TLS 1.2 or newer, each side checks the other's certificate."""

import asyncio
import ssl

from station.errors import LineError, SettingsError
from station.plc.wire.role import role_of
from station.settings.model import TlsSettings

Tls = ssl.SSLContext | None
"""TLS context of a connection, or None for plain TCP."""


class ServerContext(ssl.SSLContext):
    """Context of the server, which knows its own certificate."""

    own: bytes = b""
    """The server's certificate (DER)."""


def server_context(settings: TlsSettings) -> ServerContext:
    """Return the server's context; it refuses peers without a trusted certificate. Raises SettingsError."""
    context = ServerContext(ssl.PROTOCOL_TLS_SERVER)
    context.verify_mode = ssl.CERT_REQUIRED
    _load(context, settings)
    first = settings.certificate_path.read_text().partition(ssl.PEM_FOOTER)[0] + ssl.PEM_FOOTER
    context.own = ssl.PEM_cert_to_DER_cert(first[first.index(ssl.PEM_HEADER) :])
    return context


def client_context(settings: TlsSettings) -> ssl.SSLContext:
    """Return the context for the client. Raises SettingsError.

    The server's certificate must be trusted and name its host.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    _load(context, settings)
    return context


def client_role(transport: asyncio.Transport, context: ssl.SSLContext) -> str | None:
    """Return the role in a client's certificate; None: it has none.

    Raises LineError if the client shows the server's own certificate.
    """
    connection = transport.get_extra_info("ssl_object")
    shown = connection.getpeercert(binary_form=True)
    if isinstance(context, ServerContext) and shown == context.own:
        raise LineError("the client shows the server's own certificate")
    return role_of(shown)


def _load(context: ssl.SSLContext, settings: TlsSettings) -> None:
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    paths = [settings.certificate_path, settings.key_path, settings.ca_path]
    if settings.crl_path is not None:
        paths.append(settings.crl_path)
        context.verify_flags |= ssl.VERIFY_CRL_CHECK_LEAF
    for path in paths:
        if not path.is_file():
            advice = "name PEM files under [plc.tls], or make some with weldgate certificates"
            raise SettingsError(f"{path}: file not found; {advice}")
    try:
        context.load_cert_chain(settings.certificate_path, settings.key_path)
        for path in paths[2:]:
            context.load_verify_locations(path)
    except (ssl.SSLError, OSError) as error:
        raise SettingsError(
            f"{settings.certificate_path}: certificate, key, authority or revocation list cannot be used "
            f"({error}); check the files named under [plc.tls]"
        ) from None
