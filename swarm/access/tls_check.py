"""Whether a server takes a certificate, and has one to be believed, looked at before anything waits for it.

Zenoh would try again for ever, and say nothing.
"""

from __future__ import annotations

import socket
import ssl
from contextlib import suppress
from pathlib import Path

from swarm.access.credentials import AUTHORITY_FILE, CERTIFICATE_FILE, KEY_FILE
from swarm.errors import UserError

CONNECT_WITHIN_S = 2.0
"""A server that is not there yet is waited for by others."""
REFUSED_WITHIN_S = 0.5
"""In TLS 1.3 (RFC 8446) a client is told that its certificate is refused only after the handshake."""


def check_certificates(endpoint: str, folder: Path) -> None:
    """UserError with the reason if both sides would not speak with each other; nothing if nobody is there."""
    host, _, port = endpoint.partition("/")[2].partition("?")[0].rpartition(":")
    context = _context(folder)
    try:
        with (
            socket.create_connection((host.strip("[]"), int(port)), CONNECT_WITHIN_S) as plain,
            context.wrap_socket(plain, server_hostname=host.strip("[]")) as secured,
        ):
            secured.settimeout(REFUSED_WITHIN_S)
            with suppress(TimeoutError):
                secured.recv(1)
    except ssl.SSLCertVerificationError as error:
        raise UserError(
            f"{endpoint}: the server's certificate is not believed ({error.verify_message}): is it the "
            "server of this laboratory, and its host that of the laboratory file?"
        ) from error
    except ssl.SSLError as error:
        raise UserError(
            f"{endpoint}: the server refuses this certificate ({error.reason}): {folder} is not of the "
            "authority that it believes; copy the folder again"
        ) from error
    except OSError:
        return


def _context(folder: Path) -> ssl.SSLContext:
    """UserError if the files are not what their names say."""
    try:
        context = ssl.create_default_context(cafile=str(folder / AUTHORITY_FILE))
        context.load_cert_chain(folder / CERTIFICATE_FILE, folder / KEY_FILE)
    except (ssl.SSLError, OSError) as error:
        raise UserError(
            f"--credentials {folder}: its files cannot be used ({error.strerror or error})"
        ) from error
    return context
