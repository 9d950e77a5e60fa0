# What the base boards on an Arduino Mega share whose motors an L298N, a TB6612FNG or a BTS7960 drives. A board's folder has
# its pins, and says which DRIVER. The Mega is written through its boot loader.
FIRMWARE := base
MCU := atmega2560
HZ := 16000000UL
FAMILY := mega_base
DEFINES := -DDRIVER='"$(DRIVER).h"'
REGISTERS := registers $(DRIVER) motors_off
ENCODERS := gathered
OUTPUTS := bridges
PART := m2560
PROGRAMMER ?= -c wiring -b 115200 -D
