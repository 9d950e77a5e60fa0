# What avr.mk and host.mk share: one board's sources and flags. The board says which firmware it runs, and on what.
include boards/$(BOARD)/board.mk

# However it is spelled: what the compiler notes of headers names each object by its path.
override BUILD := $(abspath $(BUILD))
override LIKE := $(abspath $(or $(LIKE),$(BUILD)))

START_VALUES ?= common/start_values.c

COMMON := boot clock cobs crc frame hello link uart watchdog
balancer_PROGRAM := balance balancer command driver encoders inertial kalman latch posture reference sensors settings \
	torque watch wheel_speed
base_PROGRAM := base drive $(ENCODERS) held latch limit motors speed speedometer turning
joystick_PROGRAM := bno055 bus joystick tick
ranger_PROGRAM := bumpers echo ranger sonars tick
PROGRAM := $(COMMON) $($(FIRMWARE)_PROGRAM)

# A board that is a process in front of a motor controller says by CONTROLLER which protocol that speaks.
CONTROLLER ?=
ifneq ($(CONTROLLER),)
PROGRAM += controller duty process ticks $(CONTROLLER)
endif

# Boards that share registers name their folder of avr/ as FAMILY, and say by DEFINES what differs.
FAMILY ?=
DEFINES ?=

# A board with a wire of its own says which header declares it. Asked for once, and only where something is compiled.
HASH = $(eval HASH := $$(shell $$(PYTHON) generate_codec.py --hash $$(PROTOCOL)))$(or \
	$(HASH),$(error generate_codec.py gave no protocol hash))

FLAGS = -std=gnu11 -Wall -Wextra -Werror -Wstrict-prototypes -Wmissing-prototypes -Wshadow -Wundef \
	-fno-common -MMD -MP -Icommon -I$(FIRMWARE) -Iboards/$(BOARD) $(FAMILY:%=-Iavr/%) $(CONTROLLER:%=-Icontroller -Ilinux) $(DEFINES) \
	-DPROTOCOL_HASH=$(HASH)UL

CHECK = $(CPPCHECK) --quiet --std=c11 --error-exitcode=1 --inline-suppr $(filter -I%,$(FLAGS)) $(DEFINES) -DPROTOCOL_HASH=$(HASH) \
	--enable=warning,style,performance,portability --suppress=missingIncludeSystem

# This folder and the sources in it that a program was built from: the simulator refuses one that is older than they are.
NOTE_SOURCES = @{ realpath --relative-to=$(@D) . && cat $(OBJECTS:.o=.d); } >$(basename $@).sources

vpath %.c common $(FIRMWARE) $(CONTROLLER:%=controller linux)
