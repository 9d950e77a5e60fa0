"""`giraff estop engage` by its plan: stop first, complain after."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from giraff_cli.estop import client
from giraff_cli.estop.plan import plan_stop
from giraff_cli.network.command import UNUSABLE, UnopenedError, print_error, visit
from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.user import user_at_host
from giraff_cli.terminal.output import discard_stdout
from giraff_node.network.consent import NoRobotError
from giraff_node.network.reach import address_fault
from giraff_schemas.text import printable_lines


def engage_by_plan(robot: str | None, connect: Sequence[str], reason: str, timeout: float) -> int:
    """Stop the robot, or every robot that is heard, wherever it can be reached; the exit code."""
    # A robot that is reached another way is stopped, whatever is wrong with the address that was typed.
    faults = {address: fault for address in connect if (fault := address_fault(address))}
    try:
        plan = plan_stop(robot, [address for address in connect if address not in faults])
    except NoRobotError as error:
        return print_error(f"NOTHING IS STOPPED: {error}")

    def stop(connection: RobotConnection) -> int:
        if connection.robot and len(connection.network.connect) < 2:
            result = client.engage(connection, user_at_host(), reason, timeout, doubt=plan.doubt)
            for address, fault in faults.items():
                print_error(f"--connect {address} is left out: {fault}")
            code = tell(result)
            if code == client.UNKNOWN and (hint := client.hint_of_others(connection)):
                print_error(hint)
            return code
        return client.engage_all(
            connection, user_at_host(), reason, timeout, connect, tell, doubt=plan.doubt, only=connection.robot
        )

    code = UNUSABLE
    if plan.target is not None:
        try:
            code = visit(plan.target, stop, patience=timeout)
        except UnopenedError as error:
            print_error(f"NOTHING IS STOPPED: use the battery switch; {error}")
    if plan.complaint:
        print_error(plan.complaint)
    return code


def tell(result: client.Result) -> int:
    """Print how it ended; the exit code. A closed output ends no stop of another robot."""
    out = sys.stderr if result.code >= UNUSABLE else sys.stdout
    try:
        print(printable_lines(result.text), file=out, flush=True)
    except OSError:
        if out is sys.stdout:
            discard_stdout()
    return result.code
