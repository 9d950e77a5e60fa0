#include "controller_model.h"
#include <math.h>

void model_hold(struct controller_model *m, double until_us)
{
    double us = fmax(until_us - m->passed_us, 0);
    m->passed_us += us;
    for (int k = 0; k < MODEL_MOTORS; k++) {
        m->duty_us[k] += m->duty[k] * us;
        m->duty_peak[k] = fmax(m->duty_peak[k], fabs(m->duty[k]));
    }
}
