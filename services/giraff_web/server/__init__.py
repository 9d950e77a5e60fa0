"""The pages' side of the service: an HTTPS port in a thread of its own, which holds no turn up."""
