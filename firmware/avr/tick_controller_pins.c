/*
 * The pins of tick_controller.c that simavr records: a separate section of the program's file, not written to a chip.
 */
#include <avr/io.h>
#include <avr_mcu_section.h>

AVR_MCU(F_CPU, "atmega328p");
AVR_MCU_VCD_FILE("tick_controller.vcd", 1000);
AVR_MCU_VCD_PORT_PIN('B', 0, "STEP0");
AVR_MCU_VCD_PORT_PIN('B', 1, "STEP1");
AVR_MCU_VCD_PORT_PIN('B', 2, "DIR0");
AVR_MCU_VCD_PORT_PIN('B', 3, "DIR1");
AVR_MCU_VCD_PORT_PIN('B', 4, "EN");
