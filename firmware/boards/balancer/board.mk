# The balancing robot's Arduino Mega, which is written through its boot loader.
FIRMWARE := balancer
PROTOCOL := balancer/balancer_protocol.h
MCU := atmega2560
HZ := 16000000UL
REGISTERS := registers
PART := m2560
PROGRAMMER ?= -c wiring -b 115200 -D
