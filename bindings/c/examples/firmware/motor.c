#include "motor.h"

#define REG_RESULT 0x014U
#define REG_ORDERS 0x060U
#define REG_PUSH 0x070U
#define REG_POSITION 0x080U
#define COMMAND_RIGHT 0x80U
#define RESULT_CODE 0xffU

bool motor_queue(int8_t steps) {
    const uint32_t command = steps < 0 ? (uint32_t)-steps : COMMAND_RIGHT | (uint32_t)steps;
    bus_write(REG_ORDERS, command);
    bus_write(REG_PUSH, 1U);
    return (bus_read(REG_RESULT) & RESULT_CODE) == 0U;
}

int32_t motor_position(void) { return (int32_t)bus_read(REG_POSITION); }
