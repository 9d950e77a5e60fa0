"""`giraff view --web`: what it prints, and what it serves."""

import socket
import urllib.request

import pytest

from giraff_cli.view.output import Options, ViewerOutput, browser_addresses
from giraff_tools.network.ports import free_port
from giraff_viewer.scene import stock
from giraff_viewer.window import ViewerError


def test_each_address_leads_to_page_and_data_of_one_machine_and_this_one_is_last() -> None:
    assert browser_addresses({"192.168.1.7", "10.0.0.2"}, 9090) == [
        "http://10.0.0.2:9090/?url=rerun%2Bhttp://10.0.0.2:9091/proxy&theme=dark",
        "http://192.168.1.7:9090/?url=rerun%2Bhttp://192.168.1.7:9091/proxy&theme=dark",
        "http://127.0.0.1:9090/?url=rerun%2Bhttp://127.0.0.1:9091/proxy&theme=dark",
    ]


def test_a_recording_is_served_after_it_was_drawn(capsys: pytest.CaptureFixture[str]) -> None:
    """Whoever opens the address later still gets page and data, and nobody else gets the port."""
    port = free_port()
    options = Options(save=None, picture=None, web=True, port=port, memory="50MB", seconds=None, as_json=False)
    with ViewerOutput(stock("sim"), options, live=False) as output:
        assert output.end(hurried=False) == 0
        for line in capsys.readouterr().err.splitlines():
            assert line.startswith("giraff view: open http://")
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=60.0) as page:
            assert b"rerun" in page.read().lower()
        socket.create_connection(("127.0.0.1", port + 1), timeout=60.0).close()
        with pytest.raises(ViewerError, match=f"port {port}: Address already in use; name another with --port"):
            ViewerOutput(stock("sim"), options, live=False)
        output.show.close()
