/*
 * Runs a program of this folder in simavr, in real time, with its UART on a pseudo-terminal. It replaces a board, and runs
 * on a PC, not on the chip.
 *
 *   uart_on_pty PROGRAM.elf BAUD      prints pty:PATH, and runs until a signal, or until the program at the other end
 *                                     closes the pseudo-terminal
 *
 * The pins selected by the program are recorded (AVR_MCU_VCD_FILE). If this machine is late by more than LAG_US, the
 * simulated time stays late, like the clock of `stepscope serve` after a set-back: it never catches up.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <sim_irq.h>
#include <sim_time.h>

#define LAG_US 50000
/* Bits of a byte on the line, 8N1 */
#define BYTE_BITS 10

static int port;
static avr_irq_t *uart_input;
static avr_cycle_count_t byte_cycles;
static bool is_full, was_open, has_gone;
static volatile sig_atomic_t is_told_to_end;

static void end(int signal)
{
    (void)signal;
    is_told_to_end = 1;
}

static void fail(const char *what)
{
    perror(what);
    exit(1);
}

/* A pseudo-terminal whose other end is raw; reads and writes of this end never block. */
static void open_port(void)
{
    struct termios raw;
    port = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (port < 0 || grantpt(port) || unlockpt(port) || tcgetattr(port, &raw))
        fail("pty");
    cfmakeraw(&raw);
    if (tcsetattr(port, TCSANOW, &raw))
        fail("pty");
    printf("pty:%s\n", ptsname(port));
    fflush(stdout);
}

/* The chip sends a byte. If nobody reads it, it is lost, as on a wire. */
static void chip_sends(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)param;
    uint8_t byte = value;
    if (write(port, &byte, 1) < 0 && errno != EAGAIN && errno != EIO)
        fail("write");
}

static void chip_has_room(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)value, (void)param;
    is_full = false;
}

static void chip_is_full(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)value, (void)param;
    is_full = true;
}

/* The time of a byte has passed: the chip receives the next one. */
static avr_cycle_count_t chip_hears(avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr, (void)param;
    uint8_t byte;
    ssize_t count = is_full ? 0 : read(port, &byte, 1);
    if (count == 1) {
        was_open = true;
        avr_raise_irq(uart_input, byte);
    } else if (count < 0 && errno == EIO) {
        /* No program has the other end open. */
        has_gone = was_open;
    }
    return when + byte_cycles;
}

static void connect(avr_t *avr)
{
    /* Do not print the chip's bytes on the console, and accept frequent reads of its registers. */
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_t *irq = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    uart_input = irq + UART_IRQ_INPUT;
    avr_irq_register_notify(irq + UART_IRQ_OUTPUT, chip_sends, NULL);
    avr_irq_register_notify(irq + UART_IRQ_OUT_XON, chip_has_room, NULL);
    avr_irq_register_notify(irq + UART_IRQ_OUT_XOFF, chip_is_full, NULL);
    avr_cycle_timer_register(avr, byte_cycles, chip_hears, NULL);
}

/* The chip sleeps: `keep_pace` waits. */
static void sleeps(avr_t *avr, avr_cycle_count_t cycles)
{
    (void)avr, (void)cycles;
}

static uint64_t now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000000ull + now.tv_nsec / 1000;
}

/* Waits until real time has reached the chip's time; returns the time of its cycle 0. */
static uint64_t keep_pace(avr_t *avr, uint64_t began_us)
{
    uint64_t due = began_us + avr_cycles_to_usec(avr, avr->cycle), now = now_us();
    if (now > due + LAG_US)
        return began_us + (now - due - LAG_US);
    if (now < due) {
        struct timespec rest = { 0, (due - now) * 1000 };
        nanosleep(&rest, NULL);
    }
    return began_us;
}

int main(int count, char **arguments)
{
    long baud = count == 3 ? strtol(arguments[2], NULL, 10) : 0;
    elf_firmware_t program = { 0 };
    if (baud <= 0) {
        fprintf(stderr, "usage: %s PROGRAM.elf BAUD\n", arguments[0]);
        return 2;
    }
    if (elf_read_firmware(arguments[1], &program)) {
        fprintf(stderr, "%s: no program for an AVR\n", arguments[1]);
        return 1;
    }
    avr_t *avr = avr_make_mcu_by_name(program.mmcu);
    if (!avr) {
        fprintf(stderr, "%s: simavr has no %s\n", arguments[1], program.mmcu);
        return 1;
    }
    avr_init(avr);
    avr_load_firmware(avr, &program);
    avr->sleep = sleeps;
    byte_cycles = (uint64_t)BYTE_BITS * avr->frequency / baud;
    signal(SIGINT, end);
    signal(SIGTERM, end);
    open_port();
    connect(avr);
    /* In steps of half a millisecond. */
    avr_cycle_count_t look = 0, step = avr->frequency / 2000;
    uint64_t began_us = now_us();
    int state = cpu_Running;
    while (!is_told_to_end && !has_gone && state != cpu_Done && state != cpu_Crashed) {
        state = avr_run(avr);
        if (avr->cycle >= look) {
            look = avr->cycle + step;
            began_us = keep_pace(avr, began_us);
        }
    }
    /* Writes the rest of the recording. */
    avr_terminate(avr);
    return state == cpu_Crashed;
}
