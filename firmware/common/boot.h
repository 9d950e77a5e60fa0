/* Which boot this is, and what caused it. */
#ifndef GIRAFF_BOOT_H
#define GIRAFF_BOOT_H
#include <stdint.h>

void boot_start(void);
uint32_t boot_id(void);             /* never 0 */
uint8_t boot_reset_cause(void);     /* enum reset_cause */

#endif
