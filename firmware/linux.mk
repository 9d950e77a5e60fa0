# One board's program as a process of this computer: make -f linux.mk BOARD=roboclaw, by way of the Makefile.
include sources.mk

OUT := $(BUILD)/linux/$(BOARD)
ELF := $(BUILD)/firmware/$(BOARD)
SYSTEM := eeprom ending line main port watchdog
OBJECTS := $(PROGRAM:%=$(OUT)/program/%.o) $(SYSTEM:%=$(OUT)/system/%.o) $(OUT)/program/start_values.o

FLAGS += -O2 -g -pthread -DBOARD='"$(BOARD)"'

COMPILE = @mkdir -p $(@D) && $(CC) $(FLAGS) -c $< -o $@

$(ELF): $(OBJECTS)
	@mkdir -p $(@D) && $(CC) $(FLAGS) $^ -lrt -o $@
	$(NOTE_SOURCES)
	@echo "$(BOARD) (a process): $$(stat -c %s $@) bytes"

$(OUT)/program/start_values.o: $(START_VALUES) $(MAKEFILE_LIST)
	$(COMPILE)
$(OUT)/system/%.o: linux/%.c $(MAKEFILE_LIST)
	$(COMPILE)
$(OUT)/program/%.o: %.c $(MAKEFILE_LIST)
	$(COMPILE)

.PHONY: check
check:
	$(CHECK) --platform=unix64 -D__unix__ -DBOARD='"$(BOARD)"' common $(FIRMWARE) controller linux

-include $(OBJECTS:.o=.d)
