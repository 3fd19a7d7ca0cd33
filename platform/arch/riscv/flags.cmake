# -misa-spec=2.2: later versions of the specification have the csr instructions in an extension of their own, and with
# its name this compiler's multilibs do not match.
set(THIMBLE_ARCH_FLAGS -march=${BOARD_CPU} -misa-spec=2.2 -mabi=ilp32 -mcmodel=medany -msmall-data-limit=0)
