# Ardros's Arduino Mega, which is written through its boot loader.
FIRMWARE := base
MCU := atmega2560
HZ := 16000000UL
REGISTERS := registers motors_off
ENCODERS := gathered
OUTPUTS := servos
PART := m2560
PROGRAMMER ?= -c wiring -b 115200 -D
