# One board's program for its processor: make -f avr.mk BOARD=base, by way of the Makefile.
include sources.mk

AVR_SIZE ?= avr-size
SHARED := clock main processor uart

OUT := $(BUILD)/firmware/$(BOARD)
FROM := $(LIKE)/firmware/$(BOARD)
ELF := $(BUILD)/firmware/$(BOARD).elf
OBJECTS := $(PROGRAM:%=$(FROM)/program/%.o) $(patsubst %,$(FROM)/registers/%.o,$(SHARED) $(REGISTERS)) \
	$(OUT)/program/start_values.o

FLAGS += -mmcu=$(MCU) -DF_CPU=$(HZ) -Iavr -Os -g -flto -ffunction-sections -fdata-sections

# Each function's stack comes from compiling: at the link, -fstack-usage would leave its files in /tmp.
COMPILE = @mkdir -p $(@D) && $(AVR_CC) $(FLAGS) -ffat-lto-objects -fstack-usage -c $< -o $@

.PHONY: size
size: $(ELF)
	@echo "$(BOARD) ($(MCU)):" $$($(AVR_SIZE) -C --mcu=$(MCU) $< | grep -E '^(Program|Data)')

$(ELF): $(OBJECTS)
	@$(AVR_CC) $(FLAGS) -Wl,--gc-sections -Wl,--relax $^ -lm -o $@
	$(NOTE_SOURCES)

$(OUT)/program/start_values.o: $(START_VALUES) $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/program/%.o: %.c $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/registers/%.o: boards/$(BOARD)/%.c $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/registers/%.o: avr/%.c $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/registers/%.o: boards/$(BOARD)/%.S $(MAKEFILE_LIST)
	$(COMPILE)
ifneq ($(FAMILY),)
$(FROM)/registers/%.o: avr/$(FAMILY)/%.c $(MAKEFILE_LIST)
	$(COMPILE)
$(FROM)/registers/%.o: avr/$(FAMILY)/%.S $(MAKEFILE_LIST)
	$(COMPILE)
endif

.PHONY: check
check:
	$(CHECK) --platform=avr8 --library=avr -D__AVR__ -DF_CPU=$(HZ) common $(FIRMWARE) boards/$(BOARD) \
		$(wildcard $(foreach folder,avr $(FAMILY:%=avr/%),$(patsubst %,$(folder)/%.c,$(SHARED) $(REGISTERS))))

-include $(OBJECTS:.o=.d)
