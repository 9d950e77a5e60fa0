/* Pins of the ranger board (Arduino Mega, ATmega2560); README.md has them as a table. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

#define TRIGGER_0 0                 /* PA0 = D22; 1 and 2 follow on PA1 = D23 and PA2 = D24 */

#define ECHO_0 4                    /* PE4 = D2 = INT4 */
#define ECHO_1 5                    /* PE5 = D3 = INT5 */
#define ECHO_2 3                    /* PD3 = D18 = INT3 */

#define BUMPER_0 0                  /* PC0 = D37; 1 follows on PC1 = D36 */

#endif
