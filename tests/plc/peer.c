/* A PLC of libmodbus: the whole handshake, as often as told. Usage: peer PORT PARTS. Prints parts, OK, NOK, failures. */
#include <errno.h>
#include <modbus.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { STATUS = STATUS_START, WORDS = STATUS_WORDS }; /* given by the compiler: -D */
enum { READY = 2, TRIGGER_ACK = 4, RESULT_VALID = 32, OK = 64, NOK = 128 };
enum { ENABLE = 1, TRIGGER = 2, RESULT_ACK = 4 };

static modbus_t *plc;
static uint16_t window[WORDS], beat;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

static void control(uint16_t bits) {
    uint16_t words[2] = {bits, ++beat};
    if (modbus_write_registers(plc, 0, 2, words) != 2) {
        fprintf(stderr, "write: %s\n", modbus_strerror(errno));
        exit(2);
    }
}

/* Reads until `bit` of STATUS is `wanted`; 0 after two seconds. */
static int wait_for(uint16_t bit, int wanted, uint16_t held) {
    double start = now(), moved = start;
    while (now() - start < 2.0) {
        if (modbus_read_registers(plc, STATUS, WORDS, window) != WORDS) {
            fprintf(stderr, "read: %s\n", modbus_strerror(errno));
            exit(2);
        }
        if (!!(window[0] & bit) == wanted) return 1;
        if (now() - moved > 0.1) {
            moved = now();
            control(held);
        }
    }
    return 0;
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    int parts = atoi(argv[2]), ok = 0, nok = 0, failed = 0;
    plc = modbus_new_tcp("127.0.0.1", atoi(argv[1]));
    if (!plc || modbus_connect(plc)) {
        fprintf(stderr, "connect: %s\n", modbus_strerror(errno));
        return 2;
    }
    control(ENABLE);
    for (int part = 1; part <= parts; part++) {
        uint16_t serial[16] = {'C' << 8 | '-', (uint16_t)part}, id = (uint16_t)part;
        int good = wait_for(READY, 1, ENABLE);
        good = good && modbus_write_registers(plc, 5, 16, serial) == 16 && modbus_write_register(plc, 2, id) == 1;
        if (good) control(ENABLE | TRIGGER);
        good = good && wait_for(TRIGGER_ACK, 1, ENABLE | TRIGGER);
        control(ENABLE);
        good = good && wait_for(RESULT_VALID, 1, ENABLE);
        good = good && window[4] == id && window[2] == window[75] && (window[5] ^ window[6]) == 0xFFFF && window[22] == serial[0];
        good = good && !(window[0] & OK) != !(window[0] & NOK);
        if (good) (window[0] & OK) && window[5] == 1 ? ok++ : nok++;
        else failed++;
        control(ENABLE | RESULT_ACK);
        if (!wait_for(RESULT_VALID, 0, ENABLE | RESULT_ACK)) failed++;
        control(ENABLE);
    }
    modbus_close(plc);
    modbus_free(plc);
    printf("%d %d %d %d\n", parts, ok, nok, failed);
    return failed != 0;
}
