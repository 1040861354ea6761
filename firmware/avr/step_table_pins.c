/*
 * The pins of step_table.c that simavr records: a separate section of the program's file, which is not written to a chip.
 */
#include <avr/io.h>
#include <avr_mcu_section.h>

AVR_MCU(F_CPU, "atmega328p");
AVR_MCU_VCD_FILE("step_table.vcd", 1000);
AVR_MCU_VCD_PORT_PIN('B', 0, "STEP0");
AVR_MCU_VCD_PORT_PIN('B', 1, "DIR0");
