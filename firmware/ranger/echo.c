#include "echo.h"

/* Of the echo pulse's length. 58 us are a centimetre. */
enum {
    SHORTEST_US = 87,           /* 1.5 cm: the sensor begins at 2 */
    LONGEST_US = 23300,         /* 401.7 cm: it ends at 400; with nothing in range the pulse takes 38 ms */
    SLOW_US = 60000,            /* no pulse of a good sensor; clones give up after 180 ms */
    STUCK_US = 250000,

    RISE_US = 10000,            /* from the trigger: 0.5 ms, in clones some more */
    AFTERMATH_US = 870,         /* 15 cm: after a slow one, clones report 4 to 9 cm that are not there */
};

static struct verdict fault(enum range_fault why, uint32_t echo_us)
{
    return (struct verdict){ .what = KNOWN, .state = RANGE_FAULT, .fault = (uint8_t)why, .echo_us = echo_us };
}

static struct verdict pulse(uint32_t us, bool doubtful)
{
    if (doubtful && us < AFTERMATH_US)
        return (struct verdict){ .what = NOT_BELIEVED };
    if (us < SHORTEST_US)
        return fault(RANGE_FAULT_TOO_SHORT, us);
    return (struct verdict){
        .what = KNOWN,
        .state = us <= LONGEST_US ? RANGE_ECHO : RANGE_CLEAR,
        .echo_us = us,
        .next_is_doubtful = us >= SLOW_US,
    };
}

struct verdict echo_judge(const struct echo *echo, bool high, bool doubtful, uint32_t pinged_us, uint32_t now_us)
{
    if (echo->fell)
        return pulse(echo->fell_us - echo->rose_us, doubtful);
    if (echo->rose && now_us - echo->rose_us < STUCK_US)
        return (struct verdict){ .what = PENDING };     /* long is not yet clear: a line that sticks begins so */
    if (!echo->rose && now_us - pinged_us < RISE_US)
        return (struct verdict){ .what = PENDING };
    return fault(high ? RANGE_FAULT_STUCK_HIGH : RANGE_FAULT_NO_ECHO_PULSE, 0);
}
