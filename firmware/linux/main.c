/* A board's program as a process: in front of a motor controller, with a port that a host opens as any board's. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>
#include "controller.h"
#include "hal.h"
#include "linux.h"
#include "process.h"
#include "protocol.h"
#include "system.h"

enum { MS_NS = 1000000, S_NS = 1000 * MS_NS, SLACK_NS = 1000 };

enum option { LINE, PORT, EEPROM, OPTIONS };
static const char *const NAMES[OPTIONS] = { "--line", "--port", "--eeprom" };
static const char *const MEANINGS[OPTIONS] = {
    "the serial port of the motor controller, such as /dev/ttyACM0",
    "the port that base shall open, such as /run/giraff-board/port",
    "the file that keeps an emergency stop, such as /var/lib/giraff-board/eeprom",
};

static const char *values[OPTIONS];

static void let_go(void)
{
    line_stop();
    port_remove();
}

static void on_end(int number)
{
    (void)number;
    let_go();
    _exit(EXIT_SUCCESS);
}

_Noreturn static void refuse(const char *word, const char *why, const char *remedy)
{
    fprintf(stderr, BOARD ": %s%s%s\nusage: " BOARD " --line TTY --port LINK --eeprom FILE\n", word, why, remedy);
    exit(2);
}

static void take_words(int n, char **words)
{
    for (int i = 1; i < n; i += 2) {
        enum option option = LINE;
        while (option < OPTIONS && strcmp(words[i], NAMES[option]) != 0)
            option++;
        if (option == OPTIONS)
            refuse(words[i], " is none of its options", "");
        if (i + 1 == n)
            refuse(words[i], " wants a word after it: ", MEANINGS[option]);
        values[option] = words[i + 1];
    }
    for (enum option option = LINE; option < OPTIONS; option++)
        if (!values[option])
            refuse(NAMES[option], " is missing: it names ", MEANINGS[option]);
}

/* Each once, as soon as it may be said. */
static void tell_news(void)
{
    enum news { NOTHING, SILENT, OTHER, PROVED };
    static enum news said, newest;
    static const char *const TEXTS[] = {
        [SILENT] = "no answer on %s: the board waits for %s",
        [OTHER] = "something answers on %s, but not as %s",
        [PROVED] = "the controller on %s is as it must be: the board is at %s",
    };
    static uint64_t since_ns;
    const uint64_t patience_ns = controller_is_proved() ? 0 : S_NS;
    enum news is = controller_is_proved() ? PROVED : controller_answers() ? OTHER : SILENT;
    if (is != newest)
        since_ns = system_ns();
    newest = is;
    if (is == said || system_ns() - since_ns < patience_ns)
        return;
    linux_say(TEXTS[is], values[LINE], is == PROVED ? values[PORT] : protocol.expects);
    said = is;
}

static void rest(void)
{
    struct pollfd from[] = { { .fd = line_descriptor(), .events = POLLIN }, { .fd = port_descriptor(), .events = POLLIN } };
    uint64_t now_ns = system_ns(), due_ns = process_due_ns();
    const struct timespec most = { 0, due_ns > now_ns ? (long)(due_ns - now_ns) : 0 };
    ppoll(from, sizeof from / sizeof *from, &most, NULL);
}

int main(int n, char **words)
{
    /* What is opened later must not get the number of an output that is closed. */
    for (int opened = 0; opened >= 0 && opened <= STDERR_FILENO;)
        if ((opened = open("/dev/null", O_RDWR | O_CLOEXEC)) > STDERR_FILENO)
            close(opened);
    take_words(n, words);
    linux_begin(words, let_go);
    prctl(PR_SET_NAME, BOARD);  /* exec of a link would leave the link's */
    prctl(PR_SET_TIMERSLACK, (unsigned long)SLACK_NS);
    static const int ENDS[] = { SIGTERM, SIGINT, SIGHUP, SIGQUIT };
    for (size_t i = 0; i < sizeof ENDS / sizeof *ENDS; i++)
        signal(ENDS[i], on_end);
    signal(SIGPIPE, SIG_IGN);
    port_choose(values[PORT]);
    eeprom_open(values[EEPROM]);
    line_open(values[LINE], &protocol);
    process_start(&protocol);
    for (;;) {
        rest();
        struct ending ending = process_turn();
        if (ending.why)
            linux_reset(ending.cause, ending.why);
        tell_news();
    }
}
