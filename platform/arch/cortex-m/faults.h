/// @file faults.h
/// Where every exception but SysTick ends.
#ifndef THIMBLE_PLATFORM_ARCH_CORTEX_M_FAULTS_H
#define THIMBLE_PLATFORM_ARCH_CORTEX_M_FAULTS_H

extern "C" void thimble_fault();

#endif
