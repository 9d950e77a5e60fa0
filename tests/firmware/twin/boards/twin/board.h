#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "process_board.h"

#define BOARD_KIND TWIN_BOARD

#endif
