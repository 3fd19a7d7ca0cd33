/// Registers that every Cortex-M has at the same place (Armv7-M Architecture Reference Manual, B3.2 to B3.5).
/// Armv6-M has some of them; the others read as 0 there.
#pragma once

#include <stdint.h>

namespace thimble::cortex_m {

// SysTick.
inline constexpr uintptr_t kSystCsr = 0xE000E010;  ///< control and status
inline constexpr uintptr_t kSystRvr = 0xE000E014;  ///< reload value
inline constexpr uintptr_t kSystCvr = 0xE000E018;  ///< current value, counts down
inline constexpr uint32_t kSystCsrEnable = 1U << 0;
inline constexpr uint32_t kSystCsrInterrupt = 1U << 1;
inline constexpr uint32_t kSystCsrCoreClock = 1U << 2;

// System control block.
inline constexpr uintptr_t kShcsr =
    0xE000ED24;  ///< system handlers: which faults have a handler of their own
inline constexpr uint32_t kShcsrFaults = 7U << 16;
inline constexpr uintptr_t kCfsr = 0xE000ED28;  ///< what the fault was
inline constexpr uint32_t kCfsrMemAddressValid = 1U << 7;
inline constexpr uint32_t kCfsrBusAddressValid = 1U << 15;
inline constexpr uint32_t kCfsrStacking = 1U << 4 | 1U << 12;  ///< the push of an exception failed
inline constexpr uintptr_t kMmfar = 0xE000ED34;                ///< address of a memory management fault
inline constexpr uintptr_t kBfar = 0xE000ED38;                 ///< address of a bus fault

// Memory protection unit.
inline constexpr uintptr_t kMpuType = 0xE000ED90;
inline constexpr uintptr_t kMpuCtrl = 0xE000ED94;
inline constexpr uint32_t kMpuCtrlEnable = 1U << 0;
inline constexpr uint32_t kMpuCtrlDefaultMap = 1U << 2;  ///< what no region covers is as without MPU
inline constexpr uintptr_t kMpuRnr = 0xE000ED98;         ///< region number
inline constexpr uintptr_t kMpuRbar = 0xE000ED9C;        ///< its base address
inline constexpr uintptr_t kMpuRasr = 0xE000EDA0;        ///< its attributes and size

}  // namespace thimble::cortex_m
