"""Calls the addresses by which a robot should be reached, without Zenoh, which would not say why nobody comes."""

import errno
import re
import socket
import ssl
import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

from giraff_cli.doctor.inspection import Machine, Outcome, Probe
from giraff_core.network import NetworkConfig, host_and_port, ports_of, with_port
from giraff_node.network.key_bundle import CA_CERTIFICATE, HOST_CERTIFICATE, HOST_KEY
from giraff_node.network.reach import address_fault
from giraff_tools.network.interfaces import Interface, on_link
from giraff_web.config import WebConfig

_ANSWER_WITHIN: Final = 1.0  # s
_ALERT_WITHIN: Final = 0.3  # s; with TLS 1.3 the other end judges our certificate after we think all is well
_UNREACHABLE: Final = (errno.ENETUNREACH, errno.EHOSTUNREACH, errno.EADDRNOTAVAIL, errno.EACCES, errno.EPERM)


def call_all(network: NetworkConfig, machine: Machine) -> tuple[Probe, ...]:
    """Each address at which a door should be, all at once: one that is silent takes a second."""
    named = (*network.connect, *filter(None, [network.router]))
    if not network.local and (machine.services or (network.mode != "lan" and not named)):
        named = (network.rendezvous, *named)
    return _at_once([partial(call, with_port(each), network, machine.interfaces) for each in dict.fromkeys(named)])


def call_pages(hosts: Sequence[str]) -> tuple[Probe, ...]:
    """The pages of web services on these hosts, which name themselves."""
    plain, pages = NetworkConfig(), [f"{host}:{WebConfig().port}" for host in hosts]
    return _at_once([partial(call, page, plain, ()) for page in pages if not address_fault(page)])


def has_free_port(network: NetworkConfig) -> bool:
    """Whether a hand that starts on this machine finds a port."""
    return any(_is_free(port) for port in ports_of(network, "outside"))


def _is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            tried.bind(("", port))
        except OSError:
            return False
    return True


def call(address: str, network: NetworkConfig, own: tuple[Interface, ...]) -> Probe:
    """What comes back from HOST:PORT."""
    host, port = host_and_port(address)
    outcome, detail = _outcome(host, port, network)
    return Probe(address=address, outcome=outcome, detail=detail, on_link=on_link(host, own))


def _outcome(host: str, port: int, network: NetworkConfig) -> tuple[Outcome, str]:
    try:
        with socket.create_connection((host, port), timeout=_ANSWER_WITHIN) as link:
            return _greet(link, host, Path(network.keys)) if network.mode == "secured" else ("answers", "")
    except TimeoutError:
        return "silent", ""
    except ConnectionRefusedError:
        return "refused", ""
    except socket.gaierror as error:
        return ("no way" if ":" in host else "no name"), error.strerror or str(error)
    except OSError as error:
        return ("no way" if error.errno in _UNREACHABLE else "silent"), error.strerror or str(error)


def _greet(link: socket.socket, host: str, keys: Path) -> tuple[Outcome, str]:
    """Shake hands as this host's services would."""
    try:
        context = ssl.create_default_context(cafile=str(keys / CA_CERTIFICATE))
        context.load_cert_chain(keys / HOST_CERTIFICATE, keys / HOST_KEY)
    except (ssl.SSLError, OSError) as error:
        return "untrusted", f"this host's keys in {keys} cannot be used: {_words(error)}"
    try:
        with context.wrap_socket(link, server_hostname=host) as secured:
            secured.settimeout(_ALERT_WITHIN)
            secured.recv(1)
    except TimeoutError:
        return "answers", ""  # it waits for our first word, so it is content
    except ssl.SSLCertVerificationError as error:
        return "untrusted", f"its certificate is not trusted here: {error.verify_message}"
    except ssl.SSLError as error:
        return "untrusted", f"it does not trust this host's certificate: {_words(error)}"
    except OSError:
        return "answers", ""
    return "answers", ""


def _words(error: Any) -> str:
    """OpenSSL's reason, in small letters."""
    reason = getattr(error, "reason", "") or str(error)
    return re.sub(r"[_ ]+", " ", str(reason)).lower()


def _at_once(works: Sequence[Callable[[], Probe]]) -> tuple[Probe, ...]:
    done: dict[int, Probe] = {}

    def run(number: int, work: Callable[[], Probe]) -> None:
        done[number] = work()

    threads = [threading.Thread(target=run, args=each, daemon=True) for each in enumerate(works)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(3.0 * _ANSWER_WITHIN)
    return tuple(done[number] for number in sorted(done))
