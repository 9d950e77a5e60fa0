"""What keeps interrupts out of a statement, on a processor that no board has yet."""

from pathlib import Path

from tests.firmware.builds import FIRMWARE
from tests.support.tools import finished

PROGRAM = """
#include "hal.h"
extern volatile int shared;
int take(void);
int take(void)
{
    ATOMICALLY {
        return shared;
    }
    return 0;
}
"""


def test_a_cortex_m_masks_its_interrupts_and_restores_the_mask_on_every_way_out(tmp_path: Path) -> None:
    source = tmp_path / "program.c"
    source.write_text(PROGRAM)
    cortex_m = ["-U__unix__", "-D__ARM_ARCH_PROFILE='M'", f"-I{FIRMWARE / 'common'}"]
    assembly = finished(["cc", "-std=gnu11", "-O2", "-S", *cortex_m, source, "-o", "-"], check=True).stdout
    lines = [line for line in assembly.splitlines() if any(word in line for word in ("primask", "cpsid", "shared"))]
    taken, masked, access, *restored = lines
    assert ("mrs" in taken, "cpsid" in masked, "shared" in access) == (True, True, True)
    assert restored
    assert all("msr" in line for line in restored)
