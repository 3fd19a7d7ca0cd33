/// Where every exception but SysTick ends.
#pragma once

extern "C" void thimble_fault();
