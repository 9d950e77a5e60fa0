# An Arduino UNO, which is written through its boot loader.
FIRMWARE := joystick
MCU := atmega328p
HZ := 16000000UL
REGISTERS := registers twi
PART := m328p
PROGRAMMER ?= -c arduino -b 115200
