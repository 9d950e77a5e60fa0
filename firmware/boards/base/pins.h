/* Pins of the base board (ATmega644); README.md has them as a table. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

/* Outputs of port D: ENABLE of the four A3959 drivers. The head's two stay low. */
#define MOTOR_A_PWM 6               /* PD6 = OC2B */
#define MOTOR_B_PWM 4               /* PD4 = OC1B */
#define HEAD_1_PWM 7                /* PD7 */
#define HEAD_2_PWM 5                /* PD5 */

#define MOTOR_A_PHASE 6             /* PC6, high = forward */
#define MOTOR_B_PHASE 4             /* PB4, low = forward */

#define ENCODER_0_A 3               /* PD3 = INT1 */
#define ENCODER_0_B 7               /* PC7 */
#define ENCODER_1_A 2               /* PD2 = INT0 */
#define ENCODER_1_B 0               /* PC0 */

#define BATTERY_CHANNEL 0           /* PA0 = ADC0 */

#endif
