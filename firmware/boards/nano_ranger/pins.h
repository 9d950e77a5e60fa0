/* Pins of the ranger on an Arduino Nano (ATmega328P); README.md has them as a table. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

#define TRIGGER_0 0                 /* PB0 = D8; 1 and 2 follow on PB1 = D9 and PB2 = D10 */

#define ECHO_0 2                    /* PD2 = D2 = PCINT18; 1 and 2 follow on PD3 = D3 and PD4 = D4 */

#define BUMPER_0 3                  /* PB3 = D11; 1 follows on PB4 = D12 */

#endif
