/* Making the boards: processor, clock, image, and what is soldered to which pin. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "sim_elf.h"
#include "avr_adc.h"
#include "avr_eeprom.h"
#include "inside.h"

static const struct bridge_wiring BASE_BRIDGES[BOARD_MOTORS] = {
    { a3959_drive, { "D6", "C6" } },
    { a3959_drive_mirrored, { "D4", "B4" } },
};

/* The Mega's D6 to D11, and its D2, D3 with D4, D45, D46 with D44. */
static const struct bridge_wiring L298N_BRIDGES[BOARD_MOTORS] = {
    { l298n_drive, { "H3", "H4", "H5" } },
    { l298n_drive, { "B5", "H6", "B4" } },
};
static const struct bridge_wiring BTS7960_BRIDGES[BOARD_MOTORS] = {
    { bts7960_drive, { "E4", "E5", "G5", "G5" } },
    { bts7960_drive, { "L4", "L3", "L5", "L5" } },
};

static const struct servo_wiring ARDROS_SERVOS[BOARD_MOTORS] = {
    { '3', 'C', "E5" },
    { '3', 'B', "E4" },
};

static const struct ranger_pins {
    struct { const char *trigger, *echo; } sonar[BOARD_SONARS];
    const char *bumper[BOARD_BUMPERS];
} MEGA_RANGER = { { { "A0", "E4" }, { "A1", "E5" }, { "A2", "D3" } }, { "C0", "C1" } },
  NANO_RANGER = { { { "B0", "D2" }, { "B1", "D3" }, { "B2", "D4" } }, { "B3", "B4" } };

static const char JOYSTICK_SLAVE_RESET[] = "D7", JOYSTICK_BUTTON[] = "D4";

static void on_log(avr_t *avr, const int level, const char *format, va_list arguments)
{
    struct board_model *b = avr ? board_of(avr) : NULL;
    if (level > LOG_ERROR || !b)
        return;
    b->errors++;
    vsnprintf(b->message, sizeof b->message, format, arguments);
}

static void on_reset(avr_t *avr)        /* in the middle of avr_reset: only note it */
{
    struct board_model *b = board_of(avr);
    if (b->inside->core_reset)
        b->inside->core_reset(avr);
    b->inside->was_reset = 1;
    b->resets++;
}

static void on_sleep(avr_t *avr, avr_cycle_count_t cycles)
{
    board_of(avr)->inside->slept += cycles + 1;         /* as simavr counts it */
}

/* TRAP: simavr aborts on an image that is too large, and libelf is not asked whether it is one at all. */
static int read_image(const char *path, const avr_t *avr, elf_firmware_t *firmware, char *message)
{
    enum { HEADER = 20, MACHINE = 18, EM_AVR = 83 };
    unsigned char header[HEADER] = { 0 };
    FILE *file = fopen(path, "rb");
    if (!file) {
        snprintf(message, MESSAGE_SIZE, "cannot read %s: %m", path);
        return -1;
    }
    size_t n = fread(header, 1, sizeof header, file);
    fclose(file);
    if (n < sizeof header || memcmp(header, "\177ELF", 4) || header[MACHINE] != EM_AVR) {
        snprintf(message, MESSAGE_SIZE, "%s is no AVR ELF file", path);
        return -1;
    }
    memset(firmware, 0, sizeof *firmware);
    if (elf_read_firmware(path, firmware) || !firmware->flash) {
        snprintf(message, MESSAGE_SIZE, "%s holds no code", path);
        return -1;
    }
    if (firmware->flashbase + firmware->flashsize > avr->flashend + 1) {
        snprintf(message, MESSAGE_SIZE, "%s is larger than the %s", path, avr->mmcu);
        return -1;
    }
    return 0;
}

static void free_image(elf_firmware_t *firmware)
{
    for (uint32_t k = 0; k < firmware->symbolcount; k++)
        free(firmware->symbol[k]);
    free(firmware->symbol);
    free(firmware->flash);
    free(firmware->eeprom);
}

static struct analog adc_channel(avr_t *avr, int channel)
{
    return (struct analog){ .input = avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, channel) };
}

static int wire_base(struct board_model *b)
{
    bridge_wire(b, 0, &BASE_BRIDGES[0]);
    bridge_wire(b, 1, &BASE_BRIDGES[1]);
    encoder_wire(b, 0, "D3", "C7", 0);
    encoder_wire(b, 1, "D2", "C0", 1);
    b->inside->battery = adc_channel(b->inside->avr, ADC_IRQ_ADC0);
    return 0;
}

static int wire_mega(struct board_model *b, const struct bridge_wiring *bridges, const char *enable_0,
                     const char *enable_1)
{
    bridge_wire(b, 0, &bridges[0]);
    bridge_wire(b, 1, &bridges[1]);
    b->inside->enable[0] = pin_named(b->inside->avr, enable_0);
    b->inside->enable[1] = pin_named(b->inside->avr, enable_1);
    encoder_wire(b, 0, "D3", "H1", 0);          /* D18, D16 */
    encoder_wire(b, 1, "D2", "H0", 1);          /* D19, D17 */
    b->inside->battery = adc_channel(b->inside->avr, ADC_IRQ_ADC0);
    return 0;
}

static int wire_mega_l298n(struct board_model *b)
{
    return wire_mega(b, L298N_BRIDGES, "A0", "A0");     /* D22 */
}

static int wire_mega_bts7960(struct board_model *b)
{
    return wire_mega(b, BTS7960_BRIDGES, "G5", "L5");
}

static int wire_ardros(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        if (servo_wire(b, k, &ARDROS_SERVOS[k]))
            return -1;
    encoder_wire(b, 0, "D2", "A3", 0);
    encoder_wire(b, 1, "D3", "A2", 1);
    /* TRAP: simavr keeps 8 channels; it reads the next one from the memory behind them, the temperature sensor's. */
    b->inside->battery = adc_channel(b->inside->avr, ADC_IRQ_TEMP);
    b->inside->limit = adc_channel(b->inside->avr, ADC_IRQ_ADC0);
    return 0;
}

static int wire_joystick(struct board_model *b)
{
    b->inside->slave_reset = pin_named(b->inside->avr, JOYSTICK_SLAVE_RESET);
    b->inside->button = pin_named(b->inside->avr, JOYSTICK_BUTTON);
    return twi_wire(b);
}

static int wire_ranger_pins(struct board_model *b, const struct ranger_pins *pins)
{
    for (int k = 0; k < BOARD_SONARS; k++)
        sonar_wire(b, k, pins->sonar[k].trigger, pins->sonar[k].echo);
    for (int k = 0; k < BOARD_BUMPERS; k++)
        b->inside->bumper[k] = pin_named(b->inside->avr, pins->bumper[k]);
    return 0;
}

static int wire_ranger(struct board_model *b)
{
    return wire_ranger_pins(b, &MEGA_RANGER);
}

static int wire_nano_ranger(struct board_model *b)
{
    return wire_ranger_pins(b, &NANO_RANGER);
}

static int wire_balancer(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_SENSORS; k++)
        b->inside->sensor[k] = adc_channel(avr, ADC_IRQ_ADC0 + k);
    b->inside->battery = adc_channel(avr, ADC_IRQ_ADC4);
    /* TRAP: simavr counts whole millivolts, a third of a count here: told tenths, it neither knows nor minds. It has 1023
     * counts at AREF, which is 3.3 V; so it hears of less. */
    b->inside->parts_per_volt = 10000;
    avr->aref = 33000 * 1023 / 1024;
    encoder_wire(b, 0, "B0", "B1", 0);
    encoder_wire(b, 1, "B2", "B3", 0);
    b->inside->cord = pin_named(avr, "A0");
    return driver_line_wire(b, '3');
}

static const struct board {
    const char *name, *mcu;
    uint32_t hz;
    int (*wire)(struct board_model *);      /* what is soldered to it beside the UART; 0, or -1 */
} BOARDS[] = {
    { "base", "atmega644", 18432000, wire_base },
    { "ardros", "atmega2560", 16000000, wire_ardros },
    { "mega_l298n", "atmega2560", 16000000, wire_mega_l298n },
    { "mega_bts7960", "atmega2560", 16000000, wire_mega_bts7960 },
    { "joystick", "atmega328p", 16000000, wire_joystick },
    { "ranger", "atmega2560", 16000000, wire_ranger },
    { "nano_ranger", "atmega328p", 16000000, wire_nano_ranger },
    { "balancer", "atmega2560", 16000000, wire_balancer },
};

static const struct board *board_named(const char *name)
{
    for (size_t k = 0; k < sizeof BOARDS / sizeof *BOARDS; k++)
        if (!strcmp(BOARDS[k].name, name))
            return &BOARDS[k];
    return NULL;
}

struct board_model *board_open(const char *image, const char *name, char *message)
{
    const struct board *board = board_named(name);
    if (!board) {
        snprintf(message, MESSAGE_SIZE, "there is no board %s", name);
        return NULL;
    }
    avr_global_logger_set(on_log);      /* the only state simavr shares between cores */
    avr_t *avr = avr_make_mcu_by_name(board->mcu);
    if (!avr) {
        snprintf(message, MESSAGE_SIZE, "this simavr has no %s", board->mcu);
        return NULL;
    }
    elf_firmware_t firmware;
    if (read_image(image, avr, &firmware, message)) {
        free(avr);
        return NULL;
    }
    struct board_model *b = calloc(1, sizeof *b);
    b->inside = calloc(1, sizeof *b->inside);
    b->inside->avr = avr;
    b->inside->parts_per_volt = 1000;
    b->limit_volts = 5;
    b->driver_timeout_ms = SERVO_TIMEOUT_MS;
    avr->custom.data = b;
    avr_init(avr);
    avr_load_firmware(avr, &firmware);
    free_image(&firmware);
    avr->frequency = board->hz;
    avr->vcc = avr->avcc = avr->aref = 5000;
    avr->log = LOG_ERROR;
    avr->sleep = on_sleep;
    b->inside->core_reset = avr->reset;
    avr->reset = on_reset;
    b->inside->was_reset = 1;
    if (uart_wire(b) || board->wire(b)) {
        snprintf(message, MESSAGE_SIZE, "this simavr's %s lacks a part the board needs", board->mcu);
        board_close(b);
        return NULL;
    }
    board_reset(b, RESET_POWER_ON);
    b->resets = 0;
    return b;
}

void board_close(struct board_model *b)
{
    if (!b)
        return;
    avr_terminate(b->inside->avr);
    free(b->inside->avr);
    free(b->inside);
    free(b);
}

int board_eeprom(struct board_model *b, uint8_t *bytes, int n, int write)
{
    enum { TOO_LARGE = -2 };        /* TRAP: success is -1 */
    avr_eeprom_desc_t part = { .ee = bytes, .offset = 0, .size = (uint32_t)n };
    uint32_t what = write ? AVR_IOCTL_EEPROM_SET : AVR_IOCTL_EEPROM_GET;
    return avr_ioctl(b->inside->avr, what, &part) == TOO_LARGE ? -1 : 0;
}
