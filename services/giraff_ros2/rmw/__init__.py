"""The words of rmw_zenoh_cpp on a Zenoh network: keys, tokens, QoS, attachments, and the session."""
