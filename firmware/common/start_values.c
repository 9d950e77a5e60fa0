#include "start_values.h"

const struct start_values start_values = { 0 };
