# An Arduino Nano, which is written through its boot loader. An older one of those wants -b 57600.
FIRMWARE := ranger
MCU := atmega328p
HZ := 16000000UL
REGISTERS := registers
PART := m328p
PROGRAMMER ?= -c arduino -b 115200
