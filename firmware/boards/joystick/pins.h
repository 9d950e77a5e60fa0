/* Pins of the joystick board (Arduino UNO, ATmega328P); README.md has them as a table. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

#define SENSOR_RESET 7              /* PD7 = D7, low resets the BNO055 */
#define BUTTON 4                    /* PD4 = D4, to ground when pressed */

#endif
