/* What the motors of a base board shall get, for the commands of a motor controller. duty.c implements the motors of
 * hal_base.h by it. */
#ifndef GIRAFF_DUTY_H
#define GIRAFF_DUTY_H
#include <stdbool.h>
#include <stdint.h>
#include "controller.h"

void duty_on_millisecond(void);         /* before the millisecond's new levels */

/* What the next command has to give, of CONTROLLER_FULL. A level has parts that come in turn, millisecond by millisecond:
 * so it is the mean of what was wanted since the last command. Off is off at once. */
void duty_take(int16_t duty[CONTROLLER_MOTORS], bool none);
void duty_forget(void);                 /* nobody knows whether the newest command has come */
bool duty_must_stop(void);              /* a motor is to be off that the newest command may drive */

#endif
