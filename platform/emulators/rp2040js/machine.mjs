// The chip as an emulator that counts: an instruction takes 2^shift ns, so that every run is the same.
//
// rp2040js leaves out what a bus that answers with an error does to the core; here it is a HardFault, and a
// fault within one locks the core up (Armv6-M Architecture Reference Manual, B1.5.14).
const kHardFault = 3;
const kNmi = 2;

export class LockUp extends Error {}

export class Machine {
  constructor(rp2040js, shift) {
    this.chip = new rp2040js.RP2040();
    this.nanosAnInstruction = 2 ** shift;
    this.fault = '';
    // What it only tells of.
    const wrong = (name, message) => {
      if ((name === 'RP2040' && /invalid memory|undefined address|not 32 bit aligned/.test(message)) ||
          (name === 'CortexM0Core' && /not implemented yet/.test(message))) {
        this.fault = message;
      }
    };
    this.chip.logger = { debug() {}, info() {}, warn: wrong, error: wrong };
  }

  // Executes `count` instructions or until `stopped()`.
  run(count, stopped) {
    const { chip, nanosAnInstruction } = this;
    const { core, clock } = chip;
    for (let i = 0; i < count && !stopped(); ++i) {
      if (core.waiting) {
        clock.tick(clock.nanosToNextAlarm);
        if (core.interruptsUpdated && core.checkForInterrupts()) {
          core.waiting = false;
        }
        continue;
      }
      const pc = core.PC;
      core.executeInstruction();
      if (this.fault !== '') {
        this.raise(pc);
      }
      clock.tick(nanosAnInstruction);
    }
  }

  raise(pc) {
    const { core } = this.chip;
    const first = this.fault;
    this.fault = '';
    const wasHandling = core.IPSR === kHardFault || core.IPSR === kNmi;
    if (!wasHandling) {
      core.PC = pc;
      core.exceptionEntry(kHardFault);
    }
    if (wasHandling || this.fault !== '') {
      throw new LockUp(`the core has locked up, instruction 0x${pc.toString(16)}, stack pointer 0x${core.SP.toString(16)} (${first})`);
    }
  }
}
