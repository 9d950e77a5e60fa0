/* EEPROM as a file. A thread writes what is latched later, since a memory card may take 100 ms for it. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#include "hal.h"
#include "linux.h"

enum { STACK_BYTES = 65536 };
_Static_assert(sizeof(struct kept) == 8, "boards.py has the size of the file");

static const char *path;
static int file;
static struct kept kept;
static atomic_bool is_writing;
static sem_t due;

static void write_kept(void)
{
    errno = ENOSPC;             /* that is why a file takes less than it is given */
    if (pwrite(file, &kept, sizeof kept, 0) != sizeof kept || fdatasync(file))
        linux_fail("%s cannot be written (%s). It keeps an emergency stop, and nothing drives without it", path, strerror(errno));
}

static void *write_when_due(void *nothing)
{
    for (;;) {
        if (sem_wait(&due))
            continue;
        write_kept();
        is_writing = false;
    }
    return nothing;
}

/* All signals are for the firmware's thread. */
static void start_writer(void)
{
    pthread_t thread;
    pthread_attr_t small;
    sigset_t all, before;
    sigfillset(&all);
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, STACK_BYTES > PTHREAD_STACK_MIN ? STACK_BYTES : (size_t)PTHREAD_STACK_MIN);
    sem_init(&due, 0, 0);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    int error = pthread_create(&thread, &small, write_when_due, NULL);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (error)
        linux_fail("there is no memory for a thread (%s)", strerror(error));
}

/* Nobody knows what a file held that is missing or torn. It is no erased EEPROM: the board is latched, and its boots are
 * counted from anywhere, so that no host takes one for a boot that it has seen. */
void eeprom_open(const char *file_path)
{
    struct stat is;
    path = file_path;
    file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || fstat(file, &is))
        linux_fail("%s cannot be opened (%s). It keeps an emergency stop: name a file that can be written", path, strerror(errno));
    if (flock(file, LOCK_EX | LOCK_NB))
        linux_fail("%s is in use by another board: end that, or name another file", path);
    if (is.st_size > (off_t)sizeof kept)
        linux_fail("%s is some other file, since it is longer than %zu bytes: name another one", path, sizeof kept);
    if (pread(file, &kept, sizeof kept, 0) != sizeof kept) {
        linux_say("nobody knows what %s held: the emergency stop is on until it is reset", path);
        kept = (struct kept){ .latch = { 0, 0 } };
        if (getrandom(&kept.boot_count, sizeof kept.boot_count, 0) != sizeof kept.boot_count)
            linux_fail("the kernel gives no random number (%s)", strerror(errno));
    }
    write_kept();               /* nothing has driven yet */
    start_writer();
}

uint32_t hal_boot_count(void)
{
    return kept.boot_count;
}

void hal_set_boot_count(uint32_t count)
{
    kept.boot_count = count;
    write_kept();
}

uint8_t hal_kept_latch(uint8_t cell)
{
    return kept.latch[cell];
}

bool hal_eeprom_is_ready(void)
{
    return !is_writing;
}

void hal_keep_latch(uint8_t cell, uint8_t value)
{
    kept.latch[cell] = value;
    is_writing = true;
    sem_post(&due);
}
