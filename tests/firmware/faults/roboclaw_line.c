/* What goes wrong between a board and its RoboClaw, byte by byte of what reaches the controller. Both directions of it
 * are in the two-wire registers, which nothing else here looks at: in 0 to 4 what a test asks for, from 16 on what the
 * controller has been asked since the test has set their number to 0. */
#include <string.h>
#include "controller_model.h"
#include "machine.h"

int __real_model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply);
int __wrap_model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply);

enum { FAULT, COMMAND, TIMES, VALUE, PLACE, ASKED = 16, ENTRY = 5, ENTRIES = 40 };
enum {
    LOSES_REPLIES = 1,
    SAYS_OTHERWISE,
    REPLIES_NOISE,
    KEEPS_OTHER_TIMEOUT,
    COUNTS_ANEW,
    HEARS_NOISE,
    DAMAGES_REPLIES
};
enum { ADDRESS = 0x80, SET_TIMEOUT = 14, SET_COUNTER = 22, DUTY = 54, DUTY_BYTES = 16 };

static uint32_t chance = 1;
static uint8_t heard[DUTY_BYTES];               /* the newest bytes */

static uint8_t random_byte(void)
{
    chance = chance * 1664525u + 1013904223u;
    return (uint8_t)(chance >> 24);
}

static void add_crc(uint8_t *to, int n, uint16_t crc)
{
    const uint8_t *from = to - n;
    while (from < to) {
        crc ^= (uint16_t)(*from++ << 8);
        for (int bit = 0; bit < 8; bit++)
            crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    }
    to[0] = (uint8_t)(crc >> 8);
    to[1] = (uint8_t)crc;
}

/* As if somebody else had sent it. */
static void send(struct controller_model *m, double now_us, uint8_t command, uint8_t value, int bytes)
{
    uint8_t packet[8] = { ADDRESS, command, value }, reply[MODEL_REPLY_MAX];
    add_crc(packet + 2 + bytes, 2 + bytes, 0);
    for (int i = 0; i < bytes + 4; i++)
        __real_model_on_byte(m, packet[i], now_us, reply);
}

static void note(uint8_t *registers, uint8_t command)
{
    uint8_t *entry = registers + ASKED + 1 + ENTRY * registers[ASKED];
    if (registers[ASKED] == ENTRIES)
        return;
    registers[ASKED]++;
    memset(entry, 0, ENTRY);
    entry[0] = command;
    if (command == DUTY) {
        memcpy(entry + 1, heard + 2, 2);
        memcpy(entry + 3, heard + 8, 2);
    }
}

static int spoilt(struct controller_model *m, double now_us, uint8_t command, uint8_t *reply, int n)
{
    uint8_t *registers = machine_board->twi_register;
    if (!registers[FAULT] || !registers[TIMES] || (registers[COMMAND] && registers[COMMAND] != command))
        return n;
    registers[TIMES]--;
    switch (registers[FAULT]) {
    case LOSES_REPLIES:
        return 0;
    case SAYS_OTHERWISE: {
        uint8_t whole[2 + MODEL_REPLY_MAX] = { ADDRESS, command };
        reply[registers[PLACE] % MODEL_REPLY_MAX] = registers[VALUE];
        memcpy(whole + 2, reply, (size_t)n);
        add_crc(whole + n, n, 0);
        memcpy(reply, whole + 2, (size_t)n);
        return n;
    }
    case DAMAGES_REPLIES:
        reply[registers[PLACE] % MODEL_REPLY_MAX] ^= registers[VALUE];
        return n;
    case REPLIES_NOISE:
        n = random_byte() % MODEL_REPLY_MAX;
        for (int i = 0; i < n; i++)
            reply[i] = random_byte();
        return n;
    case KEEPS_OTHER_TIMEOUT:
        send(m, now_us, SET_TIMEOUT, registers[VALUE], 1);
        return n;
    case COUNTS_ANEW:
        send(m, now_us, SET_COUNTER, registers[VALUE], 4);
        return n;
    default:
        return n;
    }
}

int __wrap_model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply)
{
    uint8_t *registers = machine_board->twi_register, unheard[MODEL_REPLY_MAX];
    if (registers[FAULT] == HEARS_NOISE && random_byte() < registers[VALUE])
        __real_model_on_byte(m, random_byte(), now_us, unheard);
    memmove(heard, heard + 1, DUTY_BYTES - 1);
    heard[DUTY_BYTES - 1] = byte;
    unsigned packets = m->packets;
    int n = __real_model_on_byte(m, byte, now_us, reply);
    if (m->packets == packets)
        return n;
    /* What has no acknowledgement has no data, and no sum. */
    uint8_t command = n > 1 ? byte : heard[0] == ADDRESS && heard[1] == DUTY ? DUTY : SET_TIMEOUT;
    note(registers, command);
    return spoilt(m, now_us, command, reply, n);
}
