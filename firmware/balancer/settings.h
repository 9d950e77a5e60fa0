/* What a session says of the robot. */
#ifndef GIRAFF_SETTINGS_H
#define GIRAFF_SETTINGS_H
#include <stdbool.h>
#include "balance.h"

/* Give the settings in SI units. False: no robot has such values. */
bool settings_read(const struct balance_configure *asked, struct balance_settings *settings);

#endif
