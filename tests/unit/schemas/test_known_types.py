"""Whoever decodes a first sample finds its type known: that two threads make it known at once ends the process."""

from importlib.util import find_spec, module_from_spec

from giraff_schemas import frames, health, topics


def test_every_type_of_the_wire_is_known_from_the_import_on() -> None:
    spec = find_spec("giraff_schemas.codec")
    assert spec is not None
    assert spec.loader is not None
    codec = module_from_spec(spec)
    spec.loader.exec_module(codec)
    known = codec._decoder.cache_info().misses
    queries = (*topics.QUERIES, *topics.DRIVING_QUERIES, *topics.PARAM_QUERIES)
    types = {topic.schema for topic in topics.TOPICS} | {health.Health, frames.Transform}
    types |= {query.request for query in queries} | {query.answer for query in queries}
    assert len(types) > 20
    for each in types:
        codec._decoder(each)
    assert codec._decoder.cache_info().misses == known
