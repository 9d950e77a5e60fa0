#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "base_on_mega.h"
#include "boards.h"
#include DRIVER

#define HAS_LEVEL_LIMIT 0
#define HAS_TRANSITIONS 0           /* channel B may be at any pin, also where no change has an interrupt */

#endif
