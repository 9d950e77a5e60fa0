/* With the button pressed the two-wire bus stands still: no transaction goes on, none fails by itself. */
#include "machine.h"

void __real_parts_on_event(int part);
void __wrap_parts_on_event(int part);

void __wrap_parts_on_event(int part)
{
    if (!machine_board->button)
        __real_parts_on_event(part);
}
