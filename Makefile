# The front door. Everything is described in CMakeLists.txt; this only calls it.
BUILD ?= build/release

.PHONY: all test
all:
	cmake -S . -B $(BUILD) -G Ninja && cmake --build $(BUILD)
test: all
	cd $(BUILD) && ctest --output-on-failure
