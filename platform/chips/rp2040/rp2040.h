/// Registers of the RP2040 that its boards use (RP2040 Datasheet; the sections are named beside them), and
/// the pins that the carriers with a display share (Waveshare's wiki, Pico-LCD-1.3 and Pico-LCD-2).
#pragma once

#include <stdint.h>

#include "port.h"
#include "thimble/base/memory.h"

namespace thimble::rp2040 {

// Resets, 2.14: a block is held in reset while its bit is set.
inline constexpr uintptr_t kReset = 0x4000C000;
inline constexpr uintptr_t kResetDone = 0x4000C008;
inline constexpr uint32_t kBlockDma = 1U << 2;
inline constexpr uint32_t kBlockI2c0 = 1U << 3;
inline constexpr uint32_t kBlockPins = 1U << 5;
inline constexpr uint32_t kBlockPads = 1U << 8;
inline constexpr uint32_t kBlockPllSys = 1U << 12;
inline constexpr uint32_t kBlockSpi1 = 1U << 17;
inline constexpr uint32_t kBlockUart0 = 1U << 22;

// Power-on state machine, 2.13: what is forced off is in reset.
inline constexpr uintptr_t kPsmForceOff = 0x40010004;
inline constexpr uint32_t kPsmCore1 = 1U << 16;

// Crystal oscillator, 2.16.
inline constexpr uintptr_t kXoscCtrl = 0x40024000;
inline constexpr uint32_t kXoscEnable = 0xFABU << 12 | 0xAA0U;  ///< on, 1 to 15 MHz
inline constexpr uintptr_t kXoscStatus = 0x40024004;
inline constexpr uint32_t kXoscStable = 1U << 31;
inline constexpr uintptr_t kXoscStartup = 0x4002400C;
inline constexpr uint32_t kXoscStartup1Ms = 47;  ///< times 256 cycles of 12 MHz

// System PLL, 2.18: 12 MHz * 133 = 1,596 MHz, within its 750 to 1,600; / 6 / 2 = 133 MHz.
inline constexpr uintptr_t kPllCs = 0x40028000;
inline constexpr uint32_t kPllRefDiv1 = 1;
inline constexpr uint32_t kPllLocked = 1U << 31;
inline constexpr uintptr_t kPllPower = 0x40028004;
inline constexpr uint32_t kPllPowerDown = 1U << 0 | 1U << 5;  ///< the PLL and its VCO
inline constexpr uint32_t kPllPostDown = 1U << 3;
inline constexpr uintptr_t kPllFeedback = 0x40028008;
inline constexpr uint32_t kPllTimes = 133;
inline constexpr uintptr_t kPllPrim = 0x4002800C;
inline constexpr uint32_t kPllBy12 = 6U << 16 | 2U << 12;

// Clocks, 2.15: each `SELECTED` has a bit for the source that is in use.
inline constexpr uintptr_t kClkRefCtrl = 0x40008030;
inline constexpr uint32_t kClkRefXosc = 2;
inline constexpr uintptr_t kClkRefSelected = 0x40008038;
inline constexpr uintptr_t kClkSysCtrl = 0x4000803C;
inline constexpr uint32_t kClkSysRef = 0;
inline constexpr uint32_t kClkSysPll = 1;  ///< SRC: the other one; AUXSRC 0: PLL_SYS
inline constexpr uintptr_t kClkSysSelected = 0x40008044;
inline constexpr uintptr_t kClkPeriCtrl = 0x40008048;
inline constexpr uint32_t kClkPeriSys = 1U << 11;  ///< on, as fast as clk_sys

// Pins, 2.19.
constexpr uintptr_t pin_control(uint32_t pin) {
  return 0x40014004 + 8 * pin;
}
inline constexpr uint32_t kPinSpi = 1;
inline constexpr uint32_t kPinUart = 2;
inline constexpr uint32_t kPinI2c = 3;
inline constexpr uint32_t kPinSio = 5;
constexpr uintptr_t pad(uint32_t pin) {
  return 0x4001C004 + 4 * pin;
}
inline constexpr uint32_t kPadInputPulledUp =
    1U << 6 | 1U << 4 | 1U << 3 | 1U << 1;  ///< 4 mA, Schmitt trigger

// Single-cycle IO, 2.3.1: a bit a pin.
inline constexpr uintptr_t kSioIn = 0xD0000004;
inline constexpr uintptr_t kSioOutSet = 0xD0000014;
inline constexpr uintptr_t kSioOutClear = 0xD0000018;
inline constexpr uintptr_t kSioEnableSet = 0xD0000024;

// What the two cores have for each other, 2.3.1: a FIFO of 8 words each way, and locks.
inline constexpr uintptr_t kSioFifoStatus = 0xD0000050;
inline constexpr uint32_t kSioFifoFilled = 1U << 0;  ///< a word waits to be read
inline constexpr uint32_t kSioFifoRoom = 1U << 1;    ///< a word may be written
inline constexpr uintptr_t kSioFifoWrite = 0xD0000054;
inline constexpr uintptr_t kSioFifoRead = 0xD0000058;
inline constexpr uintptr_t kSioLock = 0xD0000100;  ///< read: 0 when the other core has it; written: free

// SPI1, a PL022, 4.4.
inline constexpr uintptr_t kSpiCr0 = 0x40040000;  ///< format: bits less one
inline constexpr uint32_t kSpi8Bits = 7;
inline constexpr uint32_t kSpi16Bits = 15;
inline constexpr uintptr_t kSpiCr1 = 0x40040004;
inline constexpr uint32_t kSpiEnable = 1U << 1;
inline constexpr uintptr_t kSpiData = 0x40040008;
inline constexpr uintptr_t kSpiStatus = 0x4004000C;
inline constexpr uint32_t kSpiNotFull = 1U << 1;
inline constexpr uint32_t kSpiBusy = 1U << 4;
inline constexpr uintptr_t kSpiPrescale = 0x40040010;  ///< clock divider, even
inline constexpr uintptr_t kSpiDma = 0x40040024;
inline constexpr uint32_t kSpiDmaSends = 1U << 1;

// I2C0, a DW_apb_i2c, 4.3.17.
inline constexpr uintptr_t kI2cControl = 0x40044000;
inline constexpr uint32_t kI2cFastMaster =
    1U << 6 | 1U << 5 | 2U << 1 | 1U << 0;  ///< 7 bits of address, no slave
inline constexpr uintptr_t kI2cTarget = 0x40044004;
inline constexpr uintptr_t kI2cData = 0x40044010;
inline constexpr uint32_t kI2cStop = 1U << 9;  ///< after this byte
inline constexpr uintptr_t kI2cHighCount = 0x4004401C;
inline constexpr uintptr_t kI2cLowCount = 0x40044020;
inline constexpr uintptr_t kI2cEvents = 0x40044034;  ///< raw interrupt status
inline constexpr uint32_t kI2cAborted = 1U << 6;
inline constexpr uint32_t kI2cStopped = 1U << 9;
inline constexpr uintptr_t kI2cClearEvents = 0x40044040;  ///< by reading
inline constexpr uintptr_t kI2cEnable = 0x4004406C;
inline constexpr uintptr_t kI2cStatus = 0x40044070;
inline constexpr uint32_t kI2cNotFull = 1U << 1;
inline constexpr uintptr_t kI2cHoldCount = 0x4004407C;
inline constexpr uintptr_t kI2cSpikeCount = 0x400440A0;

// DMA, 2.5: channel 0.
inline constexpr uintptr_t kDmaRead = 0x50000000;
inline constexpr uintptr_t kDmaWrite = 0x50000004;
inline constexpr uintptr_t kDmaCount = 0x50000008;
inline constexpr uintptr_t kDmaControl = 0x5000000C;
inline constexpr uint32_t kDmaEnable = 1U << 0;
inline constexpr uint32_t kDmaHalfwords = 1U << 2;
inline constexpr uint32_t kDmaReadsOn = 1U << 4;    ///< the address it reads grows
inline constexpr uint32_t kDmaForSpi1 = 18U << 15;  ///< paced by DREQ_SPI1_TX
inline constexpr uint32_t kDmaQuiet = 1U << 21;     ///< no interrupt
inline constexpr uint32_t kDmaBusy = 1U << 24;

// The carriers' pins.
inline constexpr uint32_t kPinUartSends = 0;
inline constexpr uint32_t kPinUartReceives = 1;
inline constexpr uint32_t kPinLcdData = 8;  ///< high: data, low: a command
inline constexpr uint32_t kPinLcdSelect = 9;
inline constexpr uint32_t kPinLcdClock = 10;
inline constexpr uint32_t kPinLcdDin = 11;
inline constexpr uint32_t kPinLcdReset = 12;
inline constexpr uint32_t kPinLcdLight = 13;

/// After the clocks run and the blocks are out of reset: lcd/lcd.cpp, or the board's.
void start_display();

/// Asleep, before the clock of the port is started; at most 126 ms.
void wait_ms(uint32_t ms);

}  // namespace thimble::rp2040
