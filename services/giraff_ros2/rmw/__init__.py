"""What rmw_zenoh_cpp says on a Zenoh network: keys, tokens, QoS, attachments, and the session."""
