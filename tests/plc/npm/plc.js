// A PLC of modbus-serial: the whole handshake, as often as told, while the same connection polls 21 registers
// singly and all at once, as dashboards do. Usage: plc.js PORT STATUS_START STATUS_WORDS PARTS.
// Prints parts, OK, NOK, failed parts, polls, failed polls.
"use strict";
const Modbus = require("modbus-serial");

const READY = 2, TRIGGER_ACK = 4, RESULT_VALID = 32, OK = 64, NOK = 128;
const ENABLE = 1, TRIGGER = 2, RESULT_ACK = 4;
const SINGLE = 21;
const [port, status, words, parts] = process.argv.slice(2).map(Number);

async function main() {
    const plc = new Modbus();
    await plc.connectTCP("127.0.0.1", { port });
    plc.setID(1);
    plc.setTimeout(60000);
    let beat = 0, ok = 0, nok = 0, failed = 0, polls = 0, failedPolls = 0, polling = true;
    const control = (bits) => plc.writeRegisters(0, [bits, beat = (beat + 1) & 0xffff]);
    const read = async () => (await plc.readHoldingRegisters(status, words)).data;

    async function waitFor(bit, wanted, held) {
        const start = Date.now();
        while (Date.now() - start < 60000) {
            const window = await read();
            if (Boolean(window[0] & bit) === wanted) return window;
            await control(held);
        }
        return null;
    }

    async function poll() {
        while (polling) {
            const asked = Array.from({ length: SINGLE }, (_, at) => plc.readHoldingRegisters(status + 38 + at, 1));
            for (const answer of await Promise.allSettled(asked)) {
                polls += 1;
                if (answer.status !== "fulfilled" || answer.value.data.length !== 1) failedPolls += 1;
            }
            await new Promise((done) => setTimeout(done, 5));
        }
    }

    await control(ENABLE);
    const poller = poll();
    for (let part = 1; part <= parts; part += 1) {
        let window = await waitFor(READY, true, ENABLE);
        await plc.writeRegisters(5, [0x432d, part, ...new Array(14).fill(0)]);
        await plc.writeRegister(2, part);
        await control(ENABLE | TRIGGER);
        window = window && (await waitFor(TRIGGER_ACK, true, ENABLE | TRIGGER));
        await control(ENABLE);
        window = window && (await waitFor(RESULT_VALID, true, ENABLE));
        const whole = window && window[2] === window[words - 1] && window[4] === part
            && (window[5] ^ window[6]) === 0xffff;
        if (!whole) failed += 1;
        else if ((window[0] & (OK | NOK)) === OK && window[5] === 1) ok += 1;
        else if ((window[0] & (OK | NOK)) === NOK && window[5] === 2) nok += 1;
        else failed += 1;
        await control(ENABLE | RESULT_ACK);
        await waitFor(RESULT_VALID, false, ENABLE | RESULT_ACK);
        await control(ENABLE);
    }
    polling = false;
    await poller;
    console.log(parts, ok, nok, failed, polls, failedPolls);
    plc.close(() => process.exit(0));
}

main().catch((error) => {
    console.error(error);
    process.exit(2);
});
