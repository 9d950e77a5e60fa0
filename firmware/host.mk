# One board's program and its machine for this computer: make -f host.mk BOARD=base, by way of the Makefile.
include sources.mk

SANITIZE ?=
HOST_EXTRA ?=
HOST_LINK ?=

OUT := $(BUILD)/host/$(BOARD)
FROM := $(LIKE)/host/$(BOARD)
LIBRARY := $(BUILD)/host/$(BOARD).so
base_PARTS := shafts
balancer_PARTS := shafts
PARTS := microcontroller ticking $(FIRMWARE)_parts $($(FIRMWARE)_PARTS) $(OUTPUTS)
ifneq ($(CONTROLLER),)
# The very model of the simulated world, on a pseudo terminal.
TERMINAL := $(BUILD)/host/$(CONTROLLER)_terminal
PARTS := process system controller_parts controller_model shafts $(CONTROLLER)_model
endif
MACHINE := board_model machine processor $(PARTS)
OBJECTS := $(PROGRAM:%=$(FROM)/program/%.o) $(MACHINE:%=$(FROM)/machine/%.o) $(OUT)/program/start_values.o \
	$(patsubst %,$(OUT)/machine/%.o,$(notdir $(HOST_EXTRA:.c=)))

FLAGS += -O2 -g -fPIC -fvisibility=hidden -Ihost -DBOARD='"$(BOARD)"'
ifneq ($(SANITIZE),)
$(if $(filter-out $(BUILD),$(LIKE)),$(error SANITIZE=1 wants all objects of its own: leave LIKE out))
# Compiled for a single test, it takes less time in all as it is written.
FLAGS += -O0 -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
endif

ifneq ($(HOST_EXTRA),)
vpath %.c $(dir $(HOST_EXTRA))
endif

COMPILE = @mkdir -p $(@D) && $(CC) $(FLAGS) -c $< -o $@

.PHONY: all
all: $(LIBRARY) $(TERMINAL)

$(LIBRARY): $(OBJECTS) host/firmware.ld
	@$(CC) $(FLAGS) -shared $(OBJECTS) -Wl,-T,host/firmware.ld $(HOST_LINK) -lm -o $@
	$(NOTE_SOURCES)

ifneq ($(CONTROLLER),)
$(TERMINAL): $(patsubst %,$(FROM)/machine/%.o,controller_terminal controller_model $(CONTROLLER)_model)
	@$(CC) $(FLAGS) $^ -lm -o $@
endif

$(OUT)/program/start_values.o: $(START_VALUES) $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/program/%.o: %.c $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/machine/%.o: host/%.c $(MAKEFILE_LIST)
	$(COMPILE)
$(OUT)/machine/%.o: %.c $(MAKEFILE_LIST)
	$(COMPILE)

.PHONY: check
check:
	$(CHECK) --platform=unix64 -D__unix__ -DBOARD='"$(BOARD)"' $(MACHINE:%=host/%.c) $(if $(CONTROLLER),host/controller_terminal.c)

-include $(OBJECTS:.o=.d) $(if $(CONTROLLER),$(FROM)/machine/controller_terminal.d)
