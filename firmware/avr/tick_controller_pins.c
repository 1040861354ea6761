/*
 * What simavr is to record of tick_controller.c: a section of its own in the program's file, which is not in the chip.
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
