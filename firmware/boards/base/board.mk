# A stock Giraff's base board, which is written through its ISP connector.
FIRMWARE := base
MCU := atmega644
HZ := 18432000UL
REGISTERS := registers motors_off
ENCODERS := encoders transitions
OUTPUTS := bridges
PART := m644
PROGRAMMER ?= -c usbasp
