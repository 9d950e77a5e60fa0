# One board's program for its processor: make -f avr.mk BOARD=base, by way of the Makefile.
include sources.mk

AVR_SIZE ?= avr-size
base_MCU := atmega644
joystick_MCU := atmega328p
ranger_MCU := atmega2560
base_HZ := 18432000UL
joystick_HZ := 16000000UL
ranger_HZ := 16000000UL
MCU := $($(BOARD)_MCU)

REGISTERS := clock main processor uart
base_REGISTERS := base motors_off
joystick_REGISTERS := joystick twi
ranger_REGISTERS := ranger

OUT := $(BUILD)/firmware/$(BOARD)
ELF := $(BUILD)/firmware/$(BOARD).elf
OBJECTS := $(PROGRAM:%=$(OUT)/program/%.o) $(patsubst %,$(OUT)/avr/%.o,$(REGISTERS) $($(BOARD)_REGISTERS))

FLAGS += -mmcu=$(MCU) -DF_CPU=$($(BOARD)_HZ) -Os -g -flto -ffunction-sections -fdata-sections

# Each function's stack comes from compiling: at the link, -fstack-usage would leave its files in /tmp.
COMPILE = @mkdir -p $(@D) && $(AVR_CC) $(FLAGS) -ffat-lto-objects -fstack-usage -c $< -o $@

.PHONY: size
size: $(ELF)
	@echo "$(BOARD) ($(MCU)):" $$($(AVR_SIZE) -C --mcu=$(MCU) $< | grep -E '^(Program|Data)')

$(ELF): $(OBJECTS)
	@$(AVR_CC) $(FLAGS) -Wl,--gc-sections -Wl,--relax $^ -o $@
	$(NOTE_SOURCES)

$(OUT)/program/start_values.o: $(START_VALUES) sources.mk avr.mk
	$(COMPILE)
$(OUT)/program/%.o: %.c sources.mk avr.mk
	$(COMPILE)
$(OUT)/avr/%.o: avr/%.c sources.mk avr.mk
	$(COMPILE)
$(OUT)/avr/%.o: avr/%.S sources.mk avr.mk
	$(COMPILE)

.PHONY: check
check:
	$(CHECK) --platform=avr8 --library=avr -D__AVR__ -DF_CPU=$($(BOARD)_HZ) common $(BOARD) \
		$(patsubst %,avr/%.c,$(REGISTERS) $(filter-out motors_off,$($(BOARD)_REGISTERS)))

-include $(OBJECTS:.o=.d)
