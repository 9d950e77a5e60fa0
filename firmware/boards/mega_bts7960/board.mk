# An Arduino Mega with two BTS7960.
DRIVER := bts7960
include avr/mega_base/mega_base.mk
