# An Arduino Mega, which is written through its boot loader.
FIRMWARE := ranger
MCU := atmega2560
HZ := 16000000UL
REGISTERS := registers
PART := m2560
PROGRAMMER ?= -c wiring -b 115200 -D
