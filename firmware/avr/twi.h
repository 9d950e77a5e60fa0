#ifndef GIRAFF_TWI_H
#define GIRAFF_TWI_H

void twi_start(void);

#endif
