# An Arduino Mega with an L298N or a TB6612FNG.
DRIVER := l298n
include avr/mega_base/mega_base.mk
