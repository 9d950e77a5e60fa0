/* Who may ask what of the robot, and for how long. Only policy: time and identity come in as arguments. */
#ifndef GIRAFF_COMMAND_H
#define GIRAFF_COMMAND_H
#include "balance.h"

void command_start(void);
void command_on_configure(const struct balance_configure *asked, uint32_t boot_id, uint32_t now_ms);
void command_on_drive(const struct balance_drive *asked, uint32_t boot_id, uint32_t now_ms);
void command_on_estop(const struct balance_estop *asked, uint32_t boot_id, uint32_t now_ms);
void command_on_cord(void);     /* it is pulled: as an estop frame that engages off */

/* Once each control period: what is asked of the robot now, which did as `state` says. */
struct balance_order command_order(const struct balance_state *state, uint32_t now_ms);

const struct balance_configure *command_session(void);     /* session 0: none since the boot */
void command_report(struct balance *report);                /* its fields of `balance` */

#endif
