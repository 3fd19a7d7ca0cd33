// What a chip's own library does before `main`, and a UART: a program built with a package runs under QEMU, prints,
// and ends with the status of `main`.
#include <stddef.h>
#include <stdint.h>

extern "C" {
extern uint32_t stack_top;
extern uint32_t data_load;
extern uint32_t data_begin;
extern uint32_t data_end;
extern uint32_t bss_begin;
extern uint32_t bss_end;
extern void (*init_begin[])();
extern void (*init_end[])();
int main();
int putchar(int character);
[[noreturn]] void exit(int status);
void __cxa_pure_virtual();
int __aeabi_atexit(void* object, void (*destroy)(void*), void* handle);
int __cxa_atexit(void (*destroy)(void*), void* object, void* handle);
extern void* __dso_handle;
}
void* __dso_handle = nullptr;

#if defined(__arm__)
int putchar(int character) {
  *reinterpret_cast<volatile uint32_t*>(0x4000C000) = static_cast<uint8_t>(character);
  return character;
}
void exit(int status) {
  // Semihosting's SYS_EXIT: the application ended, or an error.
  register uint32_t operation asm("r0") = 0x18;
  register uint32_t reason asm("r1") = status == 0 ? 0x20026 : 0x20023;
  asm volatile("bkpt 0xAB" : : "r"(operation), "r"(reason) : "memory");
  for (;;) {
  }
}
#else
int putchar(int character) {
  *reinterpret_cast<volatile uint8_t*>(0x10000000) = static_cast<uint8_t>(character);
  return character;
}
void exit(int status) {
  *reinterpret_cast<volatile uint32_t*>(0x100000) =
      status == 0 ? 0x5555 : static_cast<uint32_t>(status) << 16 | 0x3333;
  for (;;) {
  }
}
#endif

// A call of a function that nobody wrote, and objects that would be destroyed at the end: there is no end.
void __cxa_pure_virtual() {
  exit(2);
}
int __aeabi_atexit(void*, void (*)(void*), void*) {
  return 0;
}
int __cxa_atexit(void (*)(void*), void*, void*) {
  return 0;
}

extern "C" [[noreturn]] void run() {
  const uint32_t* from = &data_load;
  for (uint32_t* to = &data_begin; to != &data_end; ++to) {
    *to = *from++;
  }
  for (uint32_t* to = &bss_begin; to != &bss_end; ++to) {
    *to = 0;
  }
  for (void (**init)() = init_begin; init != init_end; ++init) {
    (*init)();
  }
  exit(main());
}

#if defined(__arm__)
extern "C" [[noreturn]] void start() {
  run();
}
extern "C" [[noreturn]] void fault() {
  exit(1);
}
using Handler = void (*)();
struct Vectors {
  uint32_t* stack;
  Handler handlers[15];
};
[[gnu::section(".vectors"), gnu::used]] static const Vectors vectors = {
    &stack_top,
    {start, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault,
     fault}};
#else
asm(".section .start,\"ax\"\n.globl start\nstart: la sp, stack_top\n j run\n.text\n");
#endif
