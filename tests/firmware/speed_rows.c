/* The speed control alone, a row of inputs at a time: linked into the base board's program in place of its start
 * values it takes the rows from the UART, and into a library for this machine from its caller. */
#include "speed.h"

struct __attribute__((packed)) answer {
    int32_t pwm_q8[WHEELS];
    int32_t um_s[WHEELS];
    uint8_t flags;
    uint8_t is_held;
    uint16_t cycles;        /* of the processor, for the step; UINT16_MAX = more; 0 on this machine */
};

static struct speed_settings settings;
static struct speed_control control;

bool rows_begin(const struct configure *asked);
void rows_step(const struct speed_input *in, struct answer *answer);

/* A session, from rest; whether it can have speeds. */
bool rows_begin(const struct configure *asked)
{
    control = (struct speed_control){ 0 };
    return speed_configure(&settings, asked);
}

#ifdef __AVR__
#include <avr/io.h>

/* Not to be inlined: what is measured is what the program calls. */
typedef bool speed_step_function(struct speed_control *, const struct speed_settings *, const struct speed_input *);
static speed_step_function *volatile step = speed_step;

static bool timed_step(const struct speed_input *in, uint16_t *cycles)
{
    TCCR1B = _BV(CS10);
    TCNT1 = 0;
    TIFR1 = _BV(TOV1);
    bool is_held = step(&control, &settings, in);
    *cycles = TCNT1;
    if (TIFR1 & _BV(TOV1))
        *cycles = UINT16_MAX;
    return is_held;
}
#else
static bool timed_step(const struct speed_input *in, uint16_t *cycles)
{
    *cycles = 0;
    return speed_step(&control, &settings, in);
}
#endif

void rows_step(const struct speed_input *in, struct answer *answer)
{
    uint16_t cycles;
    answer->is_held = timed_step(in, &cycles);
    answer->cycles = cycles;
    answer->flags = control.flags;
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        answer->pwm_q8[wheel] = control.wheel[wheel].pwm_q8;
        answer->um_s[wheel] = control.wheel[wheel].speedometer.um_s;
    }
}

#ifdef __AVR__
#include "start_values.h"

const struct start_values start_values = { 0 };

static void receive(void *to, uint8_t n)
{
    for (uint8_t *byte = to; n; n--) {
        loop_until_bit_is_set(UCSR0A, RXC0);
        *byte++ = UDR0;
    }
}

static void transmit(const void *from, uint8_t n)
{
    for (const uint8_t *byte = from; n; n--) {
        loop_until_bit_is_set(UCSR0A, UDRE0);
        UDR0 = *byte++;
    }
}

/* Before main, and for ever: a byte that says which, then a session or a row; its answer. */
__attribute__((constructor)) static void take_rows(void)
{
    UBRR0 = 0;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
    for (;;) {
        uint8_t is_row;
        receive(&is_row, sizeof is_row);
        if (is_row) {
            struct speed_input in;
            receive(&in, sizeof in);
            struct answer answer;
            rows_step(&in, &answer);
            transmit(&answer, sizeof answer);
        } else {
            struct configure asked;
            receive(&asked, sizeof asked);
            bool can = rows_begin(&asked);
            transmit(&can, sizeof can);
        }
    }
}
#endif
