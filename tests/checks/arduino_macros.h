// The words that an Arduino core takes from everybody, as macros: those of its Arduino.h and binary.h
// (arduino.sh adds the binary numbers B0 .. B11111111). What they stand for does not matter here, only that
// they are macros, and whether they take arguments: a header that is included after Arduino.h must not use
// them as names.
#pragma once

// Pins, levels, edges, voltages.
#define HIGH 0x1
#define LOW 0x0
#define INPUT 0x0
#define OUTPUT 0x1
#define INPUT_PULLUP 0x2
#define INPUT_PULLDOWN 0x3
#define OUTPUT_OPENDRAIN 0x4
#define CHANGE 1
#define FALLING 2
#define RISING 3
#define DEFAULT 1
#define EXTERNAL 0
#define INTERNAL 3
#define INTERNAL1V1 2
#define INTERNAL2V56 3
#define LSBFIRST 0
#define MSBFIRST 1
#define SERIAL 0x0
#define DISPLAY 0x1
#define LED_BUILTIN 13
#define SDA 18
#define SCL 19
#define SS 10
#define MOSI 11
#define MISO 12
#define SCK 13
#define A0 14
#define A1 15
#define A2 16
#define A3 17
#define A4 18
#define A5 19
#define A6 20
#define A7 21
#define NOT_A_PIN 0
#define NOT_A_PORT 0
#define NOT_AN_INTERRUPT -1
#define NOT_ON_TIMER 0
#define TIMER0A 1
#define TIMER1A 3
#define PA 1
#define PB 2
#define PC 3
#define PD 4
#define PE 5
#define PF 6
#define F_CPU 16000000L

// Numbers.
#define PI 3.1415926535897932384626433832795
#define HALF_PI 1.5707963267948966192313216916398
#define TWO_PI 6.283185307179586476925286766559
#define DEG_TO_RAD 0.017453292519943295769236907684886
#define RAD_TO_DEG 57.295779513082320876798154814105
#define EULER 2.718281828459045235360287471352

// Arithmetic.
#define min(a, b) arduino_min(a, b)
#define max(a, b) arduino_max(a, b)
#define abs(x) arduino_abs(x)
#define constrain(amount, low, high) arduino_constrain(amount, low, high)
#define round(x) arduino_round(x)
#define radians(deg) arduino_radians(deg)
#define degrees(rad) arduino_degrees(rad)
#define sq(x) arduino_sq(x)

// Bits and words.
#define bit(b) arduino_bit(b)
#define bitRead(value, b) arduino_bit_read(value, b)
#define bitSet(value, b) arduino_bit_set(value, b)
#define bitClear(value, b) arduino_bit_clear(value, b)
#define bitToggle(value, b) arduino_bit_toggle(value, b)
#define bitWrite(value, b, to) arduino_bit_write(value, b, to)
#define lowByte(w) arduino_low_byte(w)
#define highByte(w) arduino_high_byte(w)
#define word(...) arduino_word(__VA_ARGS__)
#define _BV(b) arduino_bv(b)
#define cbi(place, b) arduino_cbi(place, b)
#define sbi(place, b) arduino_sbi(place, b)

// The chip, and text in flash.
#define interrupts() arduino_interrupts()
#define noInterrupts() arduino_no_interrupts()
#define sei() arduino_sei()
#define cli() arduino_cli()
#define ISR(vector, ...) arduino_isr(vector)
#define clockCyclesPerMicrosecond() arduino_cycles()
#define clockCyclesToMicroseconds(a) arduino_to_us(a)
#define microsecondsToClockCycles(a) arduino_to_cycles(a)
#define digitalPinToPort(p) arduino_port(p)
#define digitalPinToBitMask(p) arduino_mask(p)
#define digitalPinToTimer(p) arduino_timer(p)
#define digitalPinToInterrupt(p) arduino_interrupt(p)
#define digitalPinHasPWM(p) arduino_has_pwm(p)
#define analogInPinToBit(p) arduino_analog(p)
#define portOutputRegister(p) arduino_output(p)
#define portInputRegister(p) arduino_input(p)
#define portModeRegister(p) arduino_mode(p)
#define PROGMEM
#define PGM_P const char*
#define PSTR(s) arduino_pstr(s)
#define F(text) arduino_flash(text)
#define pgm_read_byte(place) arduino_read_byte(place)
#define pgm_read_word(place) arduino_read_word(place)

// These are types there, not macros.
typedef bool boolean;
typedef unsigned char byte;
