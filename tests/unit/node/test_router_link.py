"""A service without its router says so, with what may be the matter."""

from giraff_node.network.router_link import RouterLink


class Router:
    """Its link, as a service sees it."""

    def __init__(self) -> None:
        self.is_there = True
        self.looks = 0

    def linked(self) -> bool:
        self.looks += 1
        return self.is_there


def test_a_router_that_is_away_for_longer_than_a_restart_is_told_of() -> None:
    router = Router()
    link = RouterLink("router.example.org", "home", router.linked)
    assert not link.problem(100.0)
    router.is_there = False
    assert not link.problem(104.0)
    assert not link.problem(105.0)
    problem = link.problem(106.0)
    assert "router.example.org" in str(problem)
    assert "[router] sites there 'home'" in str(problem)
    assert link.problem(107.0) == problem
    router.is_there = True
    assert not link.problem(108.0)


def test_one_that_was_never_there_is_told_of_too() -> None:
    router = Router()
    router.is_there = False
    link = RouterLink("router.example.org", "home", router.linked)
    assert not link.problem(100.0)
    assert link.problem(106.0)


def test_it_is_looked_for_once_a_second() -> None:
    router = Router()
    link = RouterLink("router.example.org", "home", router.linked)
    for turn in range(200):
        link.problem(100.0 + turn * 0.01)
    assert router.looks == 2
