/* What goes wrong between a board and its RoboClaw, byte by byte of what reaches the controller. Both directions of it
 * are in the two-wire registers, which nothing else here looks at: in 0 to 4 what a test asks for, from 16 on what the
 * controller has been asked since the test has set their number to 0. */
#include "machine.h"
#include "roboclaw_model.h"

int __real_roboclaw_on_byte(struct roboclaw *r, uint8_t byte, double now_us, uint8_t *reply);
int __wrap_roboclaw_on_byte(struct roboclaw *r, uint8_t byte, double now_us, uint8_t *reply);

enum { FAULT, COMMAND, TIMES, VALUE, PLACE, ASKED = 16, ENTRY = 5, ENTRIES = 40 };
enum { LOSES_REPLIES = 1, SAYS_OTHERWISE, REPLIES_NOISE, KEEPS_OTHER_TIMEOUT, COUNTS_ANEW, HEARS_NOISE, DAMAGES_REPLIES };

static uint32_t chance = 1;

static uint8_t random_byte(void)
{
    chance = chance * 1664525u + 1013904223u;
    return (uint8_t)(chance >> 24);
}

static uint16_t crc_with(uint16_t crc, uint8_t byte)
{
    crc ^= (uint16_t)(byte << 8);
    for (int bit = 0; bit < 8; bit++)
        crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    return crc;
}

static void say_otherwise(const uint8_t *registers, uint8_t command, uint8_t *reply, int n)
{
    uint16_t crc = crc_with(crc_with(0, 0x80), command);
    reply[registers[PLACE]] = registers[VALUE];
    for (int i = 0; i < n - 2; i++)
        crc = crc_with(crc, reply[i]);
    reply[n - 2] = (uint8_t)(crc >> 8);
    reply[n - 1] = (uint8_t)crc;
}

static void note(uint8_t *registers, uint8_t command, const struct roboclaw *r)
{
    uint8_t *entry = registers + ASKED + 1 + ENTRY * registers[ASKED];
    if (registers[ASKED] == ENTRIES)
        return;
    registers[ASKED]++;
    entry[0] = command;
    for (int k = 0; k < ROBOCLAW_MOTORS; k++) {
        entry[1 + 2 * k] = (uint8_t)((int)r->target[k] >> 8);
        entry[2 + 2 * k] = (uint8_t)(int)r->target[k];
    }
}

static int spoilt(struct roboclaw *r, uint8_t command, uint8_t *reply, int n)
{
    uint8_t *registers = machine_board->twi_register;
    if (!registers[FAULT] || !registers[TIMES] || (registers[COMMAND] && registers[COMMAND] != command))
        return n;
    registers[TIMES]--;
    switch (registers[FAULT]) {
    case LOSES_REPLIES:
        return 0;
    case SAYS_OTHERWISE:
        say_otherwise(registers, command, reply, n);
        return n;
    case DAMAGES_REPLIES:
        reply[registers[PLACE]] ^= registers[VALUE];
        return n;
    case REPLIES_NOISE:
        n = random_byte() % ROBOCLAW_REPLY_MAX;
        for (int i = 0; i < n; i++)
            reply[i] = random_byte();
        return n;
    case KEEPS_OTHER_TIMEOUT:
        r->timeout_tenths = registers[VALUE];
        return n;
    case COUNTS_ANEW:
        r->counts_from[0] += 1 << 24;
        return n;
    default:
        return n;
    }
}

int __wrap_roboclaw_on_byte(struct roboclaw *r, uint8_t byte, double now_us, uint8_t *reply)
{
    uint8_t *registers = machine_board->twi_register, unheard[ROBOCLAW_REPLY_MAX];
    if (registers[FAULT] == HEARS_NOISE && random_byte() < registers[VALUE])
        __real_roboclaw_on_byte(r, random_byte(), now_us, unheard);
    uint8_t command = r->n >= 2 ? r->packet[1] : byte;
    unsigned packets = r->packets;
    int n = __real_roboclaw_on_byte(r, byte, now_us, reply);
    if (r->packets == packets)
        return n;
    note(registers, command, r);
    return spoilt(r, command, reply, n);
}
