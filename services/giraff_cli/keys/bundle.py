"""What `giraff keys` writes beside a host's certificate, for those who cannot read that one."""

from __future__ import annotations

from datetime import datetime

import tomlkit
from cryptography import x509

from giraff_keys.certificates import addresses_of, common_name
from giraff_keys.host_names import without_local


def bundle_text(certificate: x509.Certificate, made: datetime) -> str:
    """What is in the `bundle.toml` of this certificate; giraff_node.network.key_bundle reads it."""
    document = tomlkit.document()
    document.add(tomlkit.comment("Written by `giraff keys`: who uses these keys, and until when. host.pem decides."))
    document["name"] = common_name(certificate)
    document["addresses"] = [str(address) for address in without_local(addresses_of(certificate))]
    document["made"] = made
    document["expires"] = certificate.not_valid_after_utc
    return tomlkit.dumps(document)
