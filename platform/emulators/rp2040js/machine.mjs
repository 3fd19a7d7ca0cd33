// The chip as an emulator that counts: an instruction takes 2^shift ns, so that every run is the same.
//
// rp2040js leaves out what a bus that answers with an error does to the core; here it is a HardFault, and a
// fault within one locks the core up (Armv6-M Architecture Reference Manual, B1.5.14).
const kHardFault = 3;
const kNmi = 2;

export class LockUp extends Error {}

// The second core, which rp2040js leaves out: another one of its cores on the same bus, an instruction of each by turns, with
// what the two have for each other (RP2040 Datasheet, 2.3.1: CPUID and the FIFOs; the locks are rp2040js'). Until it is
// launched, and after a reset, the boot ROM has it, and does no more than repeat the words that launch it (2.8.2). No
// peripheral interrupts it.
const kCpuId = 0x000;
const kFifoStatus = 0x050;
const kFifoWrite = 0x054;
const kFifoRead = 0x058;
const kFifoWords = 8;
// So often in a row the second core looks for a word that is not there before it is left alone until there is one: what it
// would do meanwhile is look again.
const kLooks = 3;
// The power-on state machine (2.13): what is forced off is in reset.
const kPsm = 0x40010;
const kPsmOff = 0x004;
const kPsmCore1 = 1 << 16;
class SecondCore {
  constructor(chip) {
    this.chip = chip;
    this.first = chip.core;
    this.core = undefined; // once it was launched
    this.launch = []; // the words so far
    this.inboxes = [[], []]; // of each core
    this.looks = 0; // of the second core, in vain
    const { sio } = chip;
    const psm = chip.peripherals[kPsm];
    const force = psm.writeUint32.bind(psm);
    psm.writeUint32 = (offset, value) => {
      const wasOff = (psm.readUint32(kPsmOff) & kPsmCore1) !== 0;
      force(offset, value);
      const isOff = (psm.readUint32(kPsmOff) & kPsmCore1) !== 0;
      if (isOff) {
        this.core = undefined;
        this.launch = [];
        this.inboxes[1] = [];
        this.looks = 0;
      } else if (wasOff) {
        this.inboxes[0].push(0); // the ROM's first word
      }
    };
    const read = sio.readUint32.bind(sio);
    const write = sio.writeUint32.bind(sio);
    sio.readUint32 = (offset) => {
      const number = this.number();
      const inbox = this.inboxes[number];
      if (offset === kCpuId) {
        return number;
      }
      if (offset === kFifoStatus) {
        const status = (inbox.length > 0 ? 1 : 0) | (this.inboxes[1 - number].length < kFifoWords ? 2 : 0);
        if (number === 1) {
          this.looks = status === 2 ? this.looks + 1 : 0;
        }
        return status;
      }
      if (offset === kFifoRead) {
        return inbox.length > 0 ? inbox.shift() : 0;
      }
      return read(offset);
    };
    sio.writeUint32 = (offset, value) => {
      if (offset !== kFifoWrite) {
        write(offset, value);
        return;
      }
      const number = this.number();
      this.looks = 0;
      if (number === 0 && this.core === undefined) {
        this.repeat(value >>> 0);
      } else if (this.inboxes[1 - number].length < kFifoWords) {
        this.inboxes[1 - number].push(value >>> 0);
      }
    };
  }

  // Whether the second core has something to do.
  isAwake() {
    return this.core !== undefined && (this.looks < kLooks || this.inboxes[1].length > 0);
  }

  // Of the core that runs now.
  number() {
    return this.chip.core === this.first ? 0 : 1;
  }

  // 0, 0, 1, vector table, stack pointer, entry; from the beginning after anything else.
  repeat(word) {
    this.inboxes[0].push(word);
    const wanted = [0, 0, 1][this.launch.length];
    if (wanted !== undefined && word !== wanted) {
      this.launch = word === 0 ? [0] : [];
      return;
    }
    this.launch.push(word);
    if (this.launch.length === 6) {
      const [, , , vectors, stack, entry] = this.launch;
      this.core = new this.first.constructor(this.chip);
      this.core.VTOR = vectors;
      this.core.SP = stack;
      this.core.PC = entry & ~1;
    }
  }
}

export class Machine {
  constructor(rp2040js, shift) {
    this.chip = new rp2040js.RP2040();
    this.nanosAnInstruction = 2 ** shift;
    this.second = new SecondCore(this.chip);
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
    const { second } = this;
    for (let i = 0; i < count && !stopped(); ++i) {
      if (core.waiting) {
        clock.tick(clock.nanosToNextAlarm);
        if (core.interruptsUpdated && core.checkForInterrupts()) {
          core.waiting = false;
        }
        continue;
      }
      this.step(core);
      if (second.isAwake() && !stopped()) {
        chip.core = second.core;
        this.step(second.core);
        chip.core = core;
      }
      clock.tick(nanosAnInstruction);
    }
  }

  step(core) {
    const pc = core.PC;
    core.executeInstruction();
    if (this.fault !== '') {
      this.raise(core, pc);
    }
  }

  raise(core, pc) {
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
